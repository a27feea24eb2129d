add_executable(tet_bench tet_bench.cc)
target_link_libraries(tet_bench PRIVATE fascicle_settings benchmark::benchmark)
fascicle_link(tet_bench PRIVATE core/tet core/scene core/muscle core/geometry core/materials core/linalg core/base)
