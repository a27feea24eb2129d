# Forces and whole steps of the tet method.
fascicle_bench(tet_bench SOURCES tet_bench.cc
               DEPS core/tet core/scene core/muscle core/geometry core/materials core/linalg core/base)
