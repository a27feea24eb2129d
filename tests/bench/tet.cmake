# Forces and whole steps of the tet method.
fascicle_bench(tet_bench SOURCES tet_bench.cc DEPS fascicle_tet_scenes)
fascicle_bench(motion_bench SOURCES motion_bench.cc DEPS fascicle_tet_scenes)

# Programs of others are compared with where they are installed (deploy/setup bench).
fascicle_bench(tet_force_bench SOURCES tet_force_bench.cc DEPS fascicle_tet_scenes)
pkg_check_modules(BULLET QUIET IMPORTED_TARGET bullet)
if(BULLET_FOUND)
  target_sources(tet_force_bench PRIVATE bullet_box.cc)
  target_compile_definitions(tet_force_bench PRIVATE FASCICLE_WITH_BULLET)
  target_link_libraries(tet_force_bench PRIVATE PkgConfig::BULLET)
endif()

fascicle_bench(tet_tangent_bench SOURCES tet_tangent_bench.cc DEPS fascicle_tet_scenes)
find_path(GETFEM_INCLUDE_DIR getfem/getfem_models.h)
find_library(GETFEM_LIBRARY getfem)
if(GETFEM_INCLUDE_DIR AND GETFEM_LIBRARY)
  target_sources(tet_tangent_bench PRIVATE getfem_box.cc)
  target_compile_definitions(tet_tangent_bench PRIVATE FASCICLE_WITH_GETFEM GMM_USES_BLAS GMM_USES_LAPACK)
  target_link_libraries(tet_tangent_bench PRIVATE ${GETFEM_LIBRARY} superlu openblas)
endif()

find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
if(CHOLMOD_INCLUDE_DIR AND CHOLMOD_LIBRARY)
  fascicle_bench(tet_solve_bench SOURCES tet_solve_bench.cc cholmod_solver.cc condensed_matrix.cc plain_newton.cc
                 DEPS fascicle_tet_scenes)
  # CHOLMOD's supernodal module is GPL: nothing but this program links it.
  target_include_directories(tet_solve_bench SYSTEM PRIVATE ${CHOLMOD_INCLUDE_DIR})
  target_link_libraries(tet_solve_bench PRIVATE ${CHOLMOD_LIBRARY})
else()
  fascicle_bench(tet_solve_bench SOURCES left_out.cc DEPS core/base)
  target_compile_definitions(tet_solve_bench PRIVATE
    "LEFT_OUT=\"tet_implicit_vs_cholmod, tet_quasistatic_vs_newton_cholmod (install libsuitesparse-dev and build again)\"")
endif()
