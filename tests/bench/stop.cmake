# From a stop request to the end of a run.
fascicle_bench(stop_bench SOURCES stop_bench.cc DEPS fascicle_tet_scenes core/eulerian core/voxel)
