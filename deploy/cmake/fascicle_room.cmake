# A room is a folder with its own library. Headers are included by their path from the project's root. A target finds
# only the headers of rooms that it links: each room exports a folder that contains nothing but a link to the room.
#
#   fascicle_room(core/geometry SOURCES a.cc b.cc DEPS core/base Eigen3::Eigen PRIVATE_DEPS ZLIB::ZLIB)
#
# makes the target fascicle_core_geometry. A DEPS entry that is a folder of the project stands for that room's target.
# Everything that a room includes is in its own DEPS: tests/architecture compares both.
function(fascicle_room room)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  string(REPLACE "/" "_" suffix ${room})
  set(target fascicle_${suffix})
  set(exported ${CMAKE_BINARY_DIR}/rooms/${suffix})
  get_filename_component(parent ${room} DIRECTORY)
  file(MAKE_DIRECTORY ${exported}/${parent})
  file(CREATE_LINK ${CMAKE_SOURCE_DIR}/${room} ${exported}/${room} SYMBOLIC)
  if(ARG_SOURCES)
    add_library(${target} STATIC ${ARG_SOURCES})
    set(visibility PUBLIC)
    set(private PRIVATE)
    target_link_libraries(${target} PRIVATE fascicle_settings)
    if(room MATCHES "^core/|^server/(store|jobs)$|^client/(exodus|image)$")
      target_precompile_headers(${target} REUSE_FROM fascicle_precompiled_core)
    elseif(room MATCHES "^server/|^client/")
      target_precompile_headers(${target} REUSE_FROM fascicle_precompiled_wire)
    endif()
  else()
    add_library(${target} INTERFACE)
    set(visibility INTERFACE)
    set(private INTERFACE)
  endif()
  target_include_directories(${target} ${visibility} ${exported})
  fascicle_link(${target} ${visibility} ${ARG_DEPS})
  fascicle_link(${target} ${private} ${ARG_PRIVATE_DEPS})
  set_property(GLOBAL APPEND PROPERTY FASCICLE_ROOMS ${room})
  fascicle_arrows(${room} ${ARG_DEPS} ${ARG_PRIVATE_DEPS})
endfunction()

# Notes what a room links, for tests/architecture.
function(fascicle_arrows room)
  list(JOIN ARGN "\", \"" deps)
  set_property(GLOBAL APPEND_STRING PROPERTY FASCICLE_ARROWS "{\"${room}\", {\"${deps}\"}},\n")
endfunction()

# The loops over elements of a room, compiled once for each instruction set; the choice is made at run time. Sets
# `sources` to kernels_baseline.cc, kernels_avx2.cc and so on. Without fused operations, all sets give the same bits.
# Eigen is not used in these files and must not adapt its types to the set.
function(fascicle_kernels sources)
  set(files kernels_baseline.cc)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT FASCICLE_SANITIZE STREQUAL "thread")
    list(APPEND files kernels_avx2.cc kernels_avx512.cc)
    set_source_files_properties(kernels_avx2.cc PROPERTIES COMPILE_OPTIONS "-mavx2")
    set_source_files_properties(kernels_avx512.cc PROPERTIES
      COMPILE_OPTIONS "-mavx512f;-mavx512dq;-mavx512vl;-mavx512bw;-mprefer-vector-width=512;-Wno-uninitialized")
  endif()
  set_property(SOURCE ${files} APPEND PROPERTY COMPILE_OPTIONS "-Wno-psabi")
  set_source_files_properties(${files} PROPERTIES
    COMPILE_DEFINITIONS EIGEN_DONT_VECTORIZE SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
  set(${sources} ${files} PARENT_SCOPE)
endfunction()

# Links rooms (given as folders) and other libraries to a target.
function(fascicle_link target visibility)
  foreach(dep ${ARGN})
    if(IS_DIRECTORY ${CMAKE_SOURCE_DIR}/${dep} AND dep MATCHES "/|^proto$")
      string(REPLACE "/" "_" suffix ${dep})
      set(dep fascicle_${suffix})
    endif()
    target_link_libraries(${target} ${visibility} ${dep})
  endforeach()
endfunction()

# A program of Google tests over rooms:
#
#   fascicle_test(geometry_test SOURCES mesh_io_test.cc DEPS core/geometry [LABELS slow] [TIMEOUT 60]
#                 [THREADED TetrahedralizeTest.*])
#
# THREADED names the tests in which threads meet; the thread sanitizer runs only these. The default is all. Programs with
# the label slow are built by the target slow_tests and run whole.
# Tests find the project's root and anatomical data by tests/support/paths.h.
function(fascicle_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;DEPS;LABELS;THREADED" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE fascicle_settings GTest::gtest_main GTest::gmock)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests/bin)
  fascicle_link(${name} PRIVATE tests/support ${ARG_DEPS})
  if("${ARG_DEPS}" MATCHES "proto|server/(translate|rpc)|client/(lib|cli|export|import|render)|service")
    target_precompile_headers(${name} REUSE_FROM fascicle_precompiled_wire_test)
  else()
    target_precompile_headers(${name} REUSE_FROM fascicle_precompiled_core_test)
  endif()
  if(slow IN_LIST ARG_LABELS)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    add_dependencies(slow_tests ${name})
  else()
    add_dependencies(tests ${name})
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(FASCICLE_SANITIZE)
    # Sanitized programs start slowly: each runs once, with all of its tests.
    set(filter "*")
    if(FASCICLE_SANITIZE STREQUAL "thread" AND ARG_THREADED)
      list(JOIN ARG_THREADED ":" filter)
    endif()
    add_test(NAME ${name} COMMAND ${name} --gtest_filter=${filter})
    set_tests_properties(${name} PROPERTIES TIMEOUT 900 LABELS "${ARG_LABELS}")
  elseif(slow IN_LIST ARG_LABELS)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT 7200 LABELS "${ARG_LABELS}")
  else()
    gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
  endif()
endfunction()

# A benchmark that deploy/bench builds and finds; `benchmark` is Google's library:
#
#   fascicle_bench(tet_bench SOURCES tet_bench.cc DEPS core/tet)
function(fascicle_bench name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE fascicle_settings benchmark::benchmark)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bench)
  fascicle_link(${name} PRIVATE tests/support ${ARG_DEPS})
  add_dependencies(benchmarks ${name})
endfunction()
