#ifndef FASCICLE_TESTS_BAD_INPUT_CASES_H_
#define FASCICLE_TESTS_BAD_INPUT_CASES_H_

#include <filesystem>
#include <iosfwd>
#include <set>
#include <string>
#include <vector>

namespace fascicle {

// An expected problem: its field path, and a part of its message or hint.
struct Expectation {
  std::string path;
  std::string text;
};

// A folder of tests/bad_input/cases: scene.json, the files it refers to, and expect.txt with a line `path | text` for
// each problem that must be reported.
struct BadCase {
  std::string name;
  std::filesystem::path folder;
  std::vector<Expectation> expected;

  std::filesystem::path scene() const { return folder / "scene.json"; }
};
void PrintTo(const BadCase& bad, std::ostream* out);

// All cases, by name.
std::vector<BadCase> AllCases();

// All files and folders below `folder`.
std::set<std::filesystem::path> Listing(const std::filesystem::path& folder);

}  // namespace fascicle

#endif  // FASCICLE_TESTS_BAD_INPUT_CASES_H_
