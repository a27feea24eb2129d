#ifndef FASCICLE_TESTS_CLIENT_CLI_FASCICLE_FIXTURE_H_
#define FASCICLE_TESTS_CLIENT_CLI_FASCICLE_FIXTURE_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace fascicle::testing {

// `fascicle` as users see it, with a folder for its files.
class FascicleTest : public ::testing::Test {
 protected:
  // Runs it without a display; the only server it knows is the given one.
  Finished Fascicle(std::vector<std::string> arguments, const std::string& server = "") {
    arguments.insert(arguments.begin(), Program("fascicle"));
    return RunProgram(arguments, {{"FASCICLE_SERVER", server}, {"DISPLAY", ""}, {"TMPDIR", Temporary()}});
  }
  std::string File(const std::string& name) const { return folder_ / name; }
  // Writes a file, and returns its path.
  std::string File(const std::string& name, const std::string& text) const { return folder_.Write(name, text); }
  // The names of all files in the folder and below.
  std::set<std::string> Files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
      if (!entry.is_directory()) names.insert(entry.path().filename().string());
    }
    return names;
  }
  bool HasFile(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
  // Where the program puts temporary files.
  std::string Temporary() const {
    std::filesystem::create_directories(folder_.path() / "tmp");
    return folder_ / "tmp";
  }

  TemporaryFolder folder_;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CLIENT_CLI_FASCICLE_FIXTURE_H_
