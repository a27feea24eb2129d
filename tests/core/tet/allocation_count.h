#ifndef FASCICLE_TESTS_CORE_TET_ALLOCATION_COUNT_H_
#define FASCICLE_TESTS_CORE_TET_ALLOCATION_COUNT_H_

namespace fascicle::testing {

// Number of allocations by all threads of this program so far. CMakeLists.txt shows the linker options it needs.
long AllocationCount();

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CORE_TET_ALLOCATION_COUNT_H_
