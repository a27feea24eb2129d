# A solid on its grid.
fascicle_bench(eulerian_bench SOURCES eulerian_bench.cc DEPS core/eulerian core/geometry core/base)
