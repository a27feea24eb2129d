# Error of both elements against the time they take.
fascicle_bench(element_bench SOURCES element_bench.cc DEPS fascicle_tet_scenes)
