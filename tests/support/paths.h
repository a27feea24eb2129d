#ifndef FASCICLE_TESTS_SUPPORT_PATHS_H_
#define FASCICLE_TESTS_SUPPORT_PATHS_H_

#include <filesystem>
#include <string>

// Folders that tests read, and programs that they start. Thread-safe.
namespace fascicle::testing {

// The clone that the tests were built from.
std::filesystem::path ProjectRoot();
// A program of this build: "fascicle", "fascicled" or one of a test's own.
std::string Program(const std::string& name);
// Real anatomy: $FASCICLE_DATA, or ../shared/data beside the project. If it is absent, tests that need it are skipped.
std::filesystem::path DataFolder();
// Results of other solvers: $FASCICLE_REFERENCE, or ../shared/reference beside the project. May be absent likewise.
std::filesystem::path ReferenceFolder();
std::filesystem::path CasesFolder();  // $FASCICLE_CASES, or ../shared/cases beside the project

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_PATHS_H_
