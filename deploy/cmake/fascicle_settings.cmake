# Compiler settings of every target.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_DEPEND=1
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${CCACHE_PROGRAM})
endif()

add_library(fascicle_settings INTERFACE)
# No contraction: a fused multiply-add in some places only would change bits between machines and builds.
target_compile_options(fascicle_settings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Werror -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # False alarms of gcc 12 in Eigen and the standard library at -O3.
  target_compile_options(fascicle_settings INTERFACE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow
                         -Wno-stringop-overread -Wno-restrict)
endif()
# The presets compile files of a target together, up to 40 at a time (CMAKE_UNITY_BUILD): most of the time goes into headers
# and templates that the files share. So names must differ within a target, in anonymous namespaces, too.
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # A source is not the main file then, and the warning takes it for a header.
  target_compile_options(fascicle_settings INTERFACE -Wno-subobject-linkage)
  # Collects the compiler's garbage less often: a tenth of its time.
  target_compile_options(fascicle_settings INTERFACE --param=ggc-min-expand=300 --param=ggc-min-heapsize=400000)
endif()
if(FASCICLE_SANITIZE)
  add_compile_definitions(FASCICLE_SANITIZED)
  add_compile_options(-fsanitize=${FASCICLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all -g1)
  add_link_options(-fsanitize=${FASCICLE_SANITIZE})
endif()
if(FASCICLE_SANITIZE STREQUAL "thread")
  # Threads meet in the same way in every instruction set, and each takes a minute to compile.
  add_compile_definitions(FASCICLE_BASELINE_KERNELS)
endif()
if(FASCICLE_SANITIZE MATCHES "address" AND NOT FASCICLE_FUZZ)
  target_sources(fascicle_settings INTERFACE
    $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${CMAKE_CURRENT_LIST_DIR}/sanitized_program.cc>)
endif()

# Precompiled headers: parsing Eigen, gRPC and Google Test would otherwise take most of a build. Headers are still
# self-contained: tests/architecture compiles each without precompiled headers.
#   core       the standard library and Eigen            core_test   and Google Test
#   wire       and the generated messages and gRPC       wire_test   and Google Test
function(fascicle_precompiled kind)
  set(target fascicle_precompiled_${kind})
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled/${kind}.cc CONTENT "")
  add_library(${target} OBJECT ${CMAKE_BINARY_DIR}/precompiled/${kind}.cc)
  target_link_libraries(${target} PRIVATE fascicle_settings ${ARGN})
  set(headers ${CMAKE_SOURCE_DIR}/deploy/cmake/precompiled_core.h)
  if(kind MATCHES "wire")
    list(APPEND headers ${CMAKE_SOURCE_DIR}/deploy/cmake/precompiled_wire.h)
  endif()
  if(kind MATCHES "test")
    list(APPEND headers <gmock/gmock.h> <gtest/gtest.h>)
  endif()
  target_precompile_headers(${target} PRIVATE ${headers})
endfunction()
