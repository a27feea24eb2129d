#ifndef FASCICLE_TESTS_BAD_INPUT_CASES_H_
#define FASCICLE_TESTS_BAD_INPUT_CASES_H_

#include <filesystem>
#include <iosfwd>
#include <set>
#include <string>
#include <vector>

namespace fascicle {

// What must be reported: a field path, and a part of its message or hint.
struct Expectation {
  std::string path;
  std::string text;
};

// A folder of tests/bad_input/cases: scene.json, the files it names, and expect.txt with a line `path | text` for each
// problem that must be among those reported.
struct BadCase {
  std::string name;
  std::filesystem::path folder;
  std::vector<Expectation> expected;

  std::filesystem::path scene() const { return folder / "scene.json"; }
};
void PrintTo(const BadCase& bad, std::ostream* out);

// All cases, by name.
std::vector<BadCase> AllCases();

// Files and folders below `folder`, to any depth.
std::set<std::filesystem::path> Listing(const std::filesystem::path& folder);

}  // namespace fascicle

#endif  // FASCICLE_TESTS_BAD_INPUT_CASES_H_
