// OpenSim models and motions: what becomes of them, and mistakes with their lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "client/import/osim_import.h"
#include "client/import/osim_reader.h"
#include "client/lib/scene_json.h"
#include "core/skeleton/motion_table.h"
#include "proto/rules/field_rules.h"
#include "tests/support/sample_osim.h"

namespace fascicle::client {
namespace {

using ::testing::HasSubstr;
using testing::kSmallMotion;
using testing::kSmallOsim;

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

OsimOptions WithMotion() {
  OsimOptions options;
  options.name = "arm.osim";
  options.surface = [](const std::string& file) {
    return file == "upper.obj" ? std::optional<std::string>(kTriangle) : std::nullopt;
  };
  options.motion = ImportedFile{"flexion.mot", kSmallMotion};
  return options;
}

TEST(OsimImport, MakesASceneThatObeysTheRules) {
  Problems problems;
  const auto imported = ImportOsim(kSmallOsim, WithMotion(), problems);
  ASSERT_TRUE(imported) << problems.ToString();
  const v1::Skeleton& skeleton = imported->scene.skeleton();
  EXPECT_EQ(skeleton.bones(0).name(), "upper_arm");
  EXPECT_EQ(skeleton.bones(0).shapes(0).file().path(), "upper.obj");
  EXPECT_EQ(skeleton.bones(0).shapes(0).scale(2), 2);
  EXPECT_EQ(skeleton.joints(1).rotations_size(), 1);
  EXPECT_EQ(skeleton.joints(1).translations_size(), 2);
  EXPECT_EQ(skeleton.joints(1).translations(0).function().x_size(), 4);
  EXPECT_EQ(skeleton.wrap_surfaces(0).side(), v1::WRAP_SIDE_PLUS_X);
  EXPECT_EQ(skeleton.muscles(1).points(1).moved_size(), 3);
  EXPECT_EQ(skeleton.muscles(1).points(0).bone(), "");
  EXPECT_EQ(imported->scene.gravity().acceleration(1), -9.81);
  EXPECT_NEAR(imported->scene.duration(), 0.4, 1e-15);
  ASSERT_EQ(imported->files.size(), 2u);
  EXPECT_EQ(imported->files[1].name, "flexion.mot");
  CheckRules(imported->scene, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  // The scene file reads back.
  v1::Scene read;
  ReadMessage(ParseJson(JsonText(imported->scene), problems), read, "", problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  EXPECT_EQ(read.SerializeAsString(), imported->scene.SerializeAsString());
}

TEST(OsimImport, TellsOfSurfacesAndNames) {
  OsimOptions options = WithMotion();
  options.surface = nullptr;
  Problems problems;
  const auto imported = ImportOsim(kSmallOsim, options, problems);
  ASSERT_TRUE(imported) << problems.ToString();
  std::string told;
  for (const Notice& notice : imported->notices) told += notice.message + "\n";
  EXPECT_THAT(told, HasSubstr("upper.obj is not drawn"));
  EXPECT_THAT(told, HasSubstr("`upper arm` is called `upper_arm`"));
  EXPECT_EQ(imported->scene.skeleton().bones(0).shapes_size(), 0);
}

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

int LineOf(const std::string& text, const std::string& piece) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(text.find(piece)), '\n'));
}

struct OsimMistake {
  std::string name, what, by, message;
  std::string at = {};  // a piece of the line of the problem; the replacement when empty
};

class OsimMistakes : public ::testing::TestWithParam<OsimMistake> {};

TEST_P(OsimMistakes, AreReportedWithTheirLine) {
  const OsimMistake& mistake = GetParam();
  const std::string text = Replaced(kSmallOsim, mistake.what, mistake.by);
  Problems problems;
  EXPECT_FALSE(ImportOsim(text, WithMotion(), problems));
  const std::string line = "arm.osim:" + std::to_string(LineOf(text, mistake.at.empty() ? mistake.by : mistake.at));
  bool found = false;
  for (const Problem& problem : problems.kept()) {
    found |= (problem.path == line || problem.path.starts_with(line + ":")) &&
             problem.message.find(mistake.message) != std::string::npos;
  }
  EXPECT_TRUE(found) << "expected `" << mistake.message << "` at " << line << " in\n" << problems.ToString();
}

INSTANTIATE_TEST_SUITE_P(
    Model, OsimMistakes,
    ::testing::Values(
        OsimMistake{"MissingBody", "<socket_child_frame>/bodyset/forearm", "<socket_child_frame>/bodyset/hand",
                    "no body \"hand\""},
        OsimMistake{"Cycle", "<socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>",
                    "<socket_parent_frame>/bodyset/forearm</socket_parent_frame><socket_child_frame>",
                    "no joints connect", "<Model name"},
        OsimMistake{"NotANumber", "<mass>1.5</mass>", "<mass>NaN</mass>", "NaN"},
        OsimMistake{"Infinite", "<radius>0.02</radius>", "<radius>1e999</radius>", "1e999"},
        OsimMistake{"NegativeMass", "<mass>2</mass>", "<mass>-2</mass>", "negative"},
        OsimMistake{"ZeroAxis", "<axis>0 0 1</axis>\n<function><LinearFunction>",
                    "<axis>0 0 0</axis>\n<function><LinearFunction>", "is zero"},
        OsimMistake{"MissingCoordinate", "<coordinates>elbow</coordinates><axis>1",
                    "<coordinates>knee</coordinates><axis>1", "no coordinate \"knee\""},
        OsimMistake{"MissingSurface", "<wrap_object>elbow", "<wrap_object>knee", "no wrap object \"knee\""},
        OsimMistake{"TwoBodiesOfOneName", "<Body name=\"forearm\">", "<Body name=\"upper arm\"> ", "given twice"}),
    [](const auto& test) { return test.param.name; });

TEST(OsimImport, JointsOfOtherKindsAreReportedWithTheirLine) {
  const std::string text =
      Replaced(Replaced(kSmallOsim, "<PinJoint name", "<ScrewJoint name"), "</PinJoint>", "</ScrewJoint>");
  Problems problems;
  EXPECT_FALSE(ImportOsim(text, WithMotion(), problems));
  ASSERT_FALSE(problems.empty());
  const std::string line = "arm.osim:" + std::to_string(LineOf(text, "<ScrewJoint"));
  EXPECT_TRUE(problems.kept()[0].path.starts_with(line)) << problems.ToString();
  EXPECT_THAT(problems.kept()[0].message, HasSubstr("of this kind"));
}

// Columns of a motion are found by the names of the scene.
TEST(OsimImport, ACoordinateThatMustBeRenamedIsRefusedWithAMotionOfIt) {
  std::string text = kSmallOsim;
  text = Replaced(text, "<Coordinate name=\"shoulder\">", "<Coordinate name=\"shoulder(r)\">");
  OsimOptions options = WithMotion();
  EXPECT_TRUE(ImportOsim(text, options, *std::make_unique<Problems>()));
  options.motion->bytes = Replaced(kSmallMotion, "elbow", "shoulder(r)");
  Problems problems;
  EXPECT_FALSE(ImportOsim(text, options, problems));
  ASSERT_EQ(problems.kept().size(), 1u) << problems.ToString();
  EXPECT_EQ(problems.kept()[0].path, "flexion.mot");
  EXPECT_THAT(problems.kept()[0].message, HasSubstr("`shoulder(r)`"));
}

// Entities are never expanded: a bomb is no larger than its text.
TEST(OsimImport, EntityBombsAreHarmless) {
  std::string bomb = "<?xml version=\"1.0\"?>\n<!DOCTYPE b [<!ENTITY a0 \"lol\">";
  for (int k = 1; k < 20; ++k) {
    const std::string before = "&a" + std::to_string(k - 1) + ";";
    bomb += "<!ENTITY a" + std::to_string(k) + " \"";
    for (int n = 0; n < 10; ++n) bomb += before;
    bomb += "\">";
  }
  bomb += "]>\n" + Replaced(std::string(kSmallOsim).substr(39), "<mass>2</mass>", "<mass>&a19;</mass>");
  Problems problems;
  EXPECT_FALSE(ImportOsim(bomb, WithMotion(), problems));
  EXPECT_LT(problems.ToString().size(), 10'000u);
}

TEST(OsimImport, TruncatedModelsAreRefused) {
  const std::string text = kSmallOsim;
  for (std::size_t size = 0; size + 20 < text.size(); size += 97) {
    Problems problems;
    EXPECT_FALSE(ImportOsim(text.substr(0, size), WithMotion(), problems)) << size;
    EXPECT_FALSE(problems.empty());
  }
}

Problems ProblemsOfMotion(const std::string& text) {
  Problems problems;
  const auto table = ReadMotionTable(text, "a.mot", problems);
  EXPECT_EQ(table.has_value(), problems.empty());
  return problems;
}

TEST(MotionTables, MistakesAreReportedWithTheirLine) {
  const std::string text = kSmallMotion;
  struct Wrong {
    std::string what, by, path, message;
  };
  for (const Wrong& wrong :
       std::vector<Wrong>{{"0.2\t40", "0.05\t40", "a.mot:9", "does not advance"},
                          {"0.2\t40", "0.2\tnan", "a.mot:9", "finite"},
                          {"0.2\t40", "0.2", "a.mot:9", "2 finite numbers"},
                          {"nRows=5", "nRows=1000000000", "a.mot:11", "claims 1000000000 rows, but there are 5"},
                          {"nRows=5", "nRows=-1", "a.mot:2", "number of rows"},
                          {"inDegrees=yes", "inDegrees=maybe", "a.mot:4", "yes or no"},
                          {"time\telbow", "time\telbow\telbow", "a.mot:6", "given twice"},
                          {"time\t", "t\t", "a.mot:6", "`time`"},
                          {"endheader", "end", "a.mot:11", "endheader"}}) {
    const Problems problems = ProblemsOfMotion(Replaced(text, wrong.what, wrong.by));
    bool found = false;
    for (const Problem& problem : problems.kept()) {
      found |= problem.path == wrong.path && problem.message.find(wrong.message) != std::string::npos;
    }
    EXPECT_TRUE(found) << wrong.by << ": " << problems.ToString();
  }
}

TEST(MotionTables, TooManyRowsAreRefused) {
  std::string text = "a\nendheader\ntime x\n";
  for (int k = 0; k <= 100'000; ++k) text += std::to_string(k) + " 0\n";
  EXPECT_THAT(ProblemsOfMotion(text).ToString(), HasSubstr("100,000 rows"));
}

}  // namespace
}  // namespace fascicle::client
