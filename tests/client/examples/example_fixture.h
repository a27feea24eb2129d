#ifndef FASCICLE_TESTS_CLIENT_EXAMPLES_EXAMPLE_FIXTURE_H_
#define FASCICLE_TESTS_CLIENT_EXAMPLES_EXAMPLE_FIXTURE_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace fascicle::testing {

using nlohmann::json;

class ExampleTest : public ::testing::Test {
 protected:
  // The summary of `fascicle run` of an example.
  json RunExample(const std::string& name, const std::vector<std::string>& more = {}) {
    const Finished written =
        RunProgram({Program("fascicle"), "examples", "write", name, "--out", folder_.path().string()});
    EXPECT_EQ(written.exit_code, 0) << written.err;
    return Run(folder_ / (name + ".json"), more);
  }
  // The same with different fibres in the first body.
  json RunWithFibres(const std::string& name, const std::function<void(json&)>& change) {
    json scene = json::parse(RunProgram({Program("fascicle"), "examples", "show", name}).out, nullptr, true, true);
    change(scene["bodies"][0]["fibres"]);
    WriteFile(folder_ / "changed.json", scene.dump());
    return Run(folder_ / "changed.json", {});
  }
  static json Run(const std::string& scene, const std::vector<std::string>& more) {
    std::vector<std::string> command = {Program("fascicle"), "run", scene, "--json", "--threads", "2"};
    command.insert(command.end(), more.begin(), more.end());
    const Finished finished = RunProgram(command);
    EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
    json summary = json::parse(finished.out);
    EXPECT_EQ(summary["state"], "succeeded");
    return summary;
  }
  static double Final(const json& summary, const std::string& series) { return summary["series"].at(series)["final"]; }

  // Nominal stress [Pa] of a law at a stretch, from `fascicle materials curve`.
  static double NominalStress(const std::string& law, const std::vector<std::string>& settings, double stretch) {
    std::vector<std::string> command = {Program("fascicle"), "materials", "curve",     law, "--json",
                                        "--points",          "2",         "--stretch", "1", std::to_string(stretch)};
    for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
    return json::parse(RunProgram(command).out)["nominal_stress"][1];
  }

  TemporaryFolder folder_;
};

// All values of a series, frame by frame.
inline std::vector<double> SeriesOf(const std::filesystem::path& csv, const std::string& name) {
  std::ifstream in(csv);
  std::string line;
  std::size_t column = 0;
  bool found = false;
  std::getline(in, line);
  std::istringstream header(line);
  for (std::string cell; std::getline(header, cell, ',') && !found;) {
    found = cell.find(name) != std::string::npos;
    if (!found) ++column;
  }
  EXPECT_TRUE(found) << name << " in " << line;
  std::vector<double> values;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    std::string cell;
    for (std::size_t c = 0; c <= column; ++c) std::getline(row, cell, ',');
    values.push_back(std::stod(cell));
  }
  return values;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CLIENT_EXAMPLES_EXAMPLE_FIXTURE_H_
