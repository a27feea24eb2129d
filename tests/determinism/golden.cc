#include "tests/determinism/golden.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "core/base/digest.h"
#include "tests/support/child_process.h"
#include "tests/support/paths.h"

namespace fascicle::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kExplanation =
    R"(# Digests of the scenes of client/examples: SHA-256 of the digests of all frames, one a line. Rewritten by
# deploy/golden; the commit that changes a line gives the reason. Slow scenes are checked by golden_slow_test,
# all others by golden_test.
#
# They hold for x86-64 processors with AVX2 and FMA and OpenBLAS's kernels named Haswell (OPENBLAS_CORETYPE=Haswell).
)";
constexpr const char* kBlasKernels = "Haswell";

Finished RunFascicle(std::vector<std::string> command) {
  command.insert(command.begin(), Program("fascicle"));
  return RunProgram(command, {{"OPENBLAS_CORETYPE", kBlasKernels}});
}

// All values of the key "path" in a scene.
void FindPaths(const json& value, std::vector<std::string>& paths) {
  if (value.is_object() && value.contains("path") && value["path"].is_string()) paths.push_back(value["path"]);
  if (!value.is_structured()) return;
  for (const json& inner : value) FindPaths(inner, paths);
}

std::optional<fs::path> FindData(const std::string& name) {
  std::error_code error;
  for (fs::recursive_directory_iterator at(DataFolder(), error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename() == name) return at->path();
  }
  return std::nullopt;
}

// Copies the files of a scene that are not part of the project; returns the first one missing on this machine.
std::string AddData(const fs::path& scene) {
  std::vector<std::string> paths;
  FindPaths(json::parse(ReadFile(scene), nullptr, true, true), paths);
  for (const std::string& path : paths) {
    const fs::path wanted = scene.parent_path() / path;
    if (fs::exists(wanted)) continue;
    const std::optional<fs::path> found = FindData(path);
    if (!found) return path;
    fs::copy_file(*found, wanted);
  }
  return "";
}

std::string DigestOfFrames(const std::string& output) {
  std::string digests;
  std::istringstream in(output);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("frame ")) digests += line.substr(line.rfind(' ') + 1) + '\n';
  }
  return digests.empty() ? "" : Hex(Sha256Of(digests));
}

}  // namespace

fs::path GoldenFile() { return ProjectRoot() / "tests/determinism/golden_digests.txt"; }

std::vector<GoldenScene> ReadGolden() {
  std::vector<GoldenScene> scenes;
  std::ifstream in(GoldenFile());
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.starts_with("#")) continue;
    GoldenScene scene;
    std::string speed;
    std::istringstream words(line);
    if (!(words >> scene.name >> speed >> scene.digest) || (speed != "quick" && speed != "slow")) {
      throw std::runtime_error(GoldenFile().string() + ": " + line);
    }
    scene.is_slow = speed == "slow";
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

std::string GoldenText(const std::vector<GoldenScene>& scenes) {
  std::string text = kExplanation;
  for (const GoldenScene& scene : scenes) {
    text += scene.name + (scene.is_slow ? " slow " : " quick ") + scene.digest + '\n';
  }
  return text;
}

std::vector<std::string> ExampleNames() {
  std::vector<std::string> names;
  std::istringstream list(RunFascicle({"examples", "--json"}).out);
  for (std::string line; std::getline(list, line);) names.push_back(json::parse(line)["example"]);
  std::sort(names.begin(), names.end());
  return names;
}

GoldenRun RunGolden(const std::string& name) {
  TemporaryFolder folder;
  const Finished written = RunFascicle({"examples", "write", name, "--out", folder.path().string()});
  if (written.exit_code != 0) return {.digest = "", .missing = "", .problem = written.err};
  const std::string scene = folder / (name + ".json");
  if (const std::string missing = AddData(scene); !missing.empty())
    return {.digest = "", .missing = missing, .problem = ""};
  const Finished run = RunFascicle({"run", scene, "--digests", "--threads", "1"});
  if (run.exit_code != 0) return {.digest = "", .missing = "", .problem = run.out + run.err};
  return {.digest = DigestOfFrames(run.out), .missing = "", .problem = ""};
}

std::string WhyNotComparable() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? "" : "the processor has no AVX2 with FMA";
#else
  return "golden digests are those of x86-64 processors";
#endif
}

}  // namespace fascicle::testing
