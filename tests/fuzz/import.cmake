fascicle_fuzz(import_fuzz SOURCES import_fuzz.cc DEPS client/import core/geometry proto/rules)
# Writes the models of the importer's tests as a first corpus. Its words are in import.dict.
add_executable(import_fuzz_corpus import_fuzz_corpus.cc)
target_link_libraries(import_fuzz_corpus PRIVATE fascicle_settings)
fascicle_link(import_fuzz_corpus PRIVATE tests/support)
set_target_properties(import_fuzz_corpus PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz)
