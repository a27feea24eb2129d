fascicle_fuzz(mesh_fuzz SOURCES mesh_fuzz.cc DEPS core/geometry)
# Writes one file of each format as a first corpus.
add_executable(mesh_fuzz_corpus mesh_fuzz_corpus.cc)
target_link_libraries(mesh_fuzz_corpus PRIVATE fascicle_settings)
fascicle_link(mesh_fuzz_corpus PRIVATE tests/support core/geometry)
set_target_properties(mesh_fuzz_corpus PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz)
