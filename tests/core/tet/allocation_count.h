#ifndef FASCICLE_TESTS_CORE_TET_ALLOCATION_COUNT_H_
#define FASCICLE_TESTS_CORE_TET_ALLOCATION_COUNT_H_

namespace fascicle::testing {

// Blocks of memory that all threads of this program have asked for so far. See CMakeLists.txt for what must be linked.
long AllocationCount();

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CORE_TET_ALLOCATION_COUNT_H_
