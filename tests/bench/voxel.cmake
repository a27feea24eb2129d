# Bricks: the operator against an assembled matrix, static solutions against a factorization.
set(voxel_rooms core/voxel core/geometry core/linalg core/base)
fascicle_bench(voxel_operator_bench SOURCES voxel_operator_bench.cc DEPS ${voxel_rooms})
