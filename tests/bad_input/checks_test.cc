// Wrong scene files, checked in process: by the client's reader, then by the server's translation.
#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases.h"
#include "client/lib/scene_file.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"
#include "tests/support/scene_loader.h"

namespace fascicle {
namespace {

// All problems reported for a scene file.
Problems ProblemsOf(const std::filesystem::path& file) {
  Problems problems;
  EXPECT_EQ(testing::ReadScene(file, problems), nullptr);
  return problems;
}

bool IsReported(const Problems& problems, const Expectation& expected) {
  return std::any_of(problems.kept().begin(), problems.kept().end(), [&](const Problem& problem) {
    return problem.path == expected.path &&
           (problem.message + " " + problem.hint).find(expected.text) != std::string::npos;
  });
}

class BadInput : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadInput, IsReportedInFull) {
  const auto before = Listing(GetParam().folder);
  const Problems problems = ProblemsOf(GetParam().scene());
  EXPECT_FALSE(problems.empty());
  for (const Expectation& expected : GetParam().expected) {
    EXPECT_TRUE(IsReported(problems, expected)) << expected.path << " | " << expected.text << "\nis missing in\n"
                                                << problems.ToString();
  }
  for (const Problem& problem : problems.kept()) {
    EXPECT_FALSE(problem.message.empty()) << problem.path;
    EXPECT_EQ(std::count(problems.kept().begin(), problems.kept().end(), problem), 1)
        << problem.path << " is said twice";
  }
  EXPECT_EQ(Listing(GetParam().folder), before) << "something was left behind";
}

INSTANTIATE_TEST_SUITE_P(Cases, BadInput, ::testing::ValuesIn(AllCases()),
                         [](const auto& bad) { return bad.param.name; });

TEST(BadInputCases, AreMany) { EXPECT_GE(AllCases().size(), 40u); }

TEST(BadInputFiles, ASceneThatIsNotThereOrIsAFolder) {
  Problems problems;
  EXPECT_FALSE(client::LoadScene(testing::ProjectRoot() / "tests/bad_input/cases/none.json", problems).has_value());
  EXPECT_FALSE(client::LoadScene(testing::ProjectRoot() / "tests/bad_input/cases", problems).has_value());
  EXPECT_EQ(problems.count(), 2u);
}

// Links and sparse files cannot be stored in a repository on every system.
class GeneratedFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "scene");
    std::filesystem::copy_file(testing::ProjectRoot() / "tests/bad_input/cases/mesh_nan/scene.json",
                               folder_ / "scene/scene.json");
  }

  const testing::TemporaryFolder folder_;
};

TEST_F(GeneratedFiles, ALinkOutOfTheFolder) {
  std::ofstream(folder_ / "mesh.msh") << "outside";
  std::filesystem::create_symlink(folder_ / "mesh.msh", folder_ / "scene/mesh.msh");
  EXPECT_TRUE(IsReported(ProblemsOf(folder_ / "scene/scene.json"), {"bodies[0].mesh.file.path", "leads out"}));
}

TEST_F(GeneratedFiles, AFileOf5Gigabytes) {
  std::ofstream(folder_ / "scene/mesh.msh") << "";
  std::filesystem::resize_file(folder_ / "scene/mesh.msh", std::uintmax_t{5} << 30);  // sparse: needs no disk space
  EXPECT_TRUE(IsReported(ProblemsOf(folder_ / "scene/scene.json"), {"bodies[0].mesh.file.path", "4 GiB"}));
}

TEST_F(GeneratedFiles, ASceneOf17Megabytes) {
  std::filesystem::resize_file(folder_ / "scene/scene.json", std::uintmax_t{17} << 20);
  EXPECT_TRUE(IsReported(ProblemsOf(folder_ / "scene/scene.json"), {"", "16 MiB"}));
}

}  // namespace
}  // namespace fascicle
