# A quasi-static muscle at growing sizes.
fascicle_bench(quasistatic_bench SOURCES quasistatic_bench.cc DEPS fascicle_tet_scenes)
