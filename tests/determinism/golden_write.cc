// Runs all or the given examples and rewrites golden_digests.txt; used by deploy/golden. Scenes whose data are missing
// on this machine keep their lines.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>

#include "tests/determinism/golden.h"
#include "tests/support/files.h"

namespace fascicle::testing {
namespace {

// New examples that take longer than this are slow [s].
constexpr double kQuick = 3;

GoldenScene Renewed(const std::string& name, const GoldenScene* old) {
  const auto start = std::chrono::steady_clock::now();
  const GoldenRun run = RunGolden(name);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  if (!run.missing.empty() && old != nullptr) {
    std::printf("%-26s kept: %s is not here\n", name.c_str(), run.missing.c_str());
    return *old;
  }
  if (run.digest.empty()) throw std::runtime_error(name + ": " + run.missing + run.problem);
  const char* const change = old == nullptr ? "new" : old->digest == run.digest ? "same" : "CHANGED";
  std::printf("%-26s %-7s %6.1f s\n", name.c_str(), change, seconds.count());
  std::fflush(stdout);
  return {name, old != nullptr ? old->is_slow : seconds.count() > kQuick, run.digest};
}

void Write(const std::vector<std::string>& wanted) {
  const std::vector<GoldenScene> old = ReadGolden();
  std::vector<GoldenScene> scenes;
  for (const std::string& name : ExampleNames()) {
    const auto found = std::find_if(old.begin(), old.end(), [&](const GoldenScene& s) { return s.name == name; });
    const GoldenScene* const line = found == old.end() ? nullptr : &*found;
    const bool is_wanted = wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
    if (is_wanted) {
      scenes.push_back(Renewed(name, line));
    } else if (line != nullptr) {
      scenes.push_back(*line);
    }
  }
  WriteFile(GoldenFile(), GoldenText(scenes));
}

}  // namespace
}  // namespace fascicle::testing

int main(int count, char** arguments) try {
  using namespace fascicle::testing;
  if (const std::string why = WhyNotComparable(); !why.empty()) throw std::runtime_error(why);
  Write({arguments + 1, arguments + count});
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
