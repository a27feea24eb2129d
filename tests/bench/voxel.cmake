# Bricks: the operator against an assembled matrix, static solutions against a factorization.
set(voxel_rooms core/voxel core/geometry core/linalg core/base)
fascicle_bench(voxel_operator_bench SOURCES voxel_operator_bench.cc DEPS ${voxel_rooms})
fascicle_bench(voxel_dynamic_bench SOURCES voxel_dynamic_bench.cc DEPS ${voxel_rooms})

find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
if(CHOLMOD_INCLUDE_DIR AND CHOLMOD_LIBRARY)
  fascicle_bench(voxel_static_bench SOURCES voxel_static_bench.cc DEPS core/imaging ${voxel_rooms})
  # CHOLMOD's supernodal module is GPL: nothing but benchmarks links it.
  target_include_directories(voxel_static_bench SYSTEM PRIVATE ${CHOLMOD_INCLUDE_DIR})
  target_link_libraries(voxel_static_bench PRIVATE ${CHOLMOD_LIBRARY})
else()
  fascicle_bench(voxel_static_bench SOURCES left_out.cc DEPS core/base)
  target_compile_definitions(voxel_static_bench PRIVATE
    "LEFT_OUT=\"voxel_static_vs_cholmod (install libsuitesparse-dev and build again)\"")
endif()
