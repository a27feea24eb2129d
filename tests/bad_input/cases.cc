#include "cases.h"

#include <algorithm>
#include <fstream>
#include <ostream>
#include <stdexcept>

#include "tests/support/paths.h"

namespace fascicle {
namespace {

namespace fs = std::filesystem;

std::vector<Expectation> ReadExpectations(const fs::path& file) {
  std::ifstream in(file);
  std::vector<Expectation> expected;
  for (std::string line; std::getline(in, line);) {
    const auto bar = line.find(" | ");
    if (bar == std::string::npos) throw std::runtime_error(file.string() + ": not `path | text`: " + line);
    expected.push_back({line.substr(0, bar), line.substr(bar + 3)});
  }
  if (expected.empty()) throw std::runtime_error(file.string() + " expects nothing");
  return expected;
}

}  // namespace

void PrintTo(const BadCase& bad, std::ostream* out) { *out << bad.name; }

std::vector<BadCase> AllCases() {
  std::vector<BadCase> cases;
  for (const auto& entry : fs::directory_iterator(testing::ProjectRoot() / "tests/bad_input/cases")) {
    cases.push_back({entry.path().filename().string(), entry.path(), ReadExpectations(entry.path() / "expect.txt")});
  }
  std::sort(cases.begin(), cases.end(), [](const BadCase& a, const BadCase& b) { return a.name < b.name; });
  return cases;
}

std::set<fs::path> Listing(const fs::path& folder) {
  std::set<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) paths.insert(entry.path());
  return paths;
}

}  // namespace fascicle
