#include "client/lib/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "core/base/digest.h"
#include "tests/support/files.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;
using ::fascicle::testing::TemporaryFolder;
using ::fascicle::testing::WriteFile;
using ::testing::HasSubstr;

TEST(ParseScene, ReadsEveryKindOfField) {
  Problems problems;
  const auto scene = ParseScene(R"({
    // a comment
    "name": "Überblick",  /* another */
    "bodies": [{
      "name": "a", "unit": "mm",
      "mesh": {"box": {"size": [1, 2.5, 3e-1], "divisions": [1, 2, 3]}},
      "density": 1000,
      "material": {"muscle": {"c1": 5}},
      "fibres": {"harmonic": {"origin": "o", "insertion": "i"}},
      "regions": [{"name": "o", "physical_tag": 3}],
      "constraints": [{"region": "o", "axes": ["x", "AXIS_Z"]}]
    }],
    "duration": 1,
    "output": {"frame_interval": 0.1, "fields": ["velocity", "FIELD_PRESSURE"]},
    "tet": {"stepping": "mixed"}
  })",
                                problems);
  ASSERT_TRUE(scene) << problems.ToString();
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(scene->name(), "Überblick");
  const v1::Body& body = scene->bodies(0);
  EXPECT_EQ(body.unit(), v1::LENGTH_UNIT_MM);
  EXPECT_THAT(body.mesh().box().size(), ::testing::ElementsAre(1, 2.5, 0.3));
  EXPECT_THAT(body.mesh().box().divisions(), ::testing::ElementsAre(1, 2, 3));
  EXPECT_EQ(body.density(), 1000);
  EXPECT_TRUE(body.material().muscle().has_c1());
  EXPECT_FALSE(body.material().muscle().has_c2());
  EXPECT_EQ(body.regions(0).physical_tag(), 3);
  EXPECT_THAT(body.constraints(0).axes(), ::testing::ElementsAre(v1::AXIS_X, v1::AXIS_Z));
  EXPECT_THAT(scene->output().fields(), ::testing::ElementsAre(v1::FIELD_VELOCITY, v1::FIELD_PRESSURE));
  EXPECT_EQ(scene->tet().stepping(), v1::STEPPING_MIXED);
}

struct BadScene {
  const char* what;
  std::string json;
  const char* path;     // of the problem
  const char* message;  // part of it
  const char* hint;     // part of it
};

// Name of the test.
void PrintTo(const BadScene& bad, std::ostream* out) { *out << bad.what; }

class MalformedScene : public ::testing::TestWithParam<BadScene> {};

TEST_P(MalformedScene, IsRefusedWithPlaceAndReason) {
  Problems problems;
  EXPECT_FALSE(ParseScene(GetParam().json, problems));
  ASSERT_FALSE(problems.empty());
  const Problem& problem = problems.kept().front();
  EXPECT_EQ(problem.path, GetParam().path);
  EXPECT_THAT(problem.message, HasSubstr(GetParam().message));
  EXPECT_THAT(problem.hint, HasSubstr(GetParam().hint));
  EXPECT_EQ(problems.count(), 1u) << problems.ToString();
}

INSTANTIATE_TEST_SUITE_P(
    All, MalformedScene,
    ::testing::Values(
        BadScene{"Empty", "", "", "line 1, column 1", ""},
        BadScene{"Truncated", "{\n  \"name\": \"x\",\n  \"bodies\": [", "", "line 3, column 13", ""},
        BadScene{"TrailingComma", "{\n\"name\": \"x\",\n}", "", "line 3, column 1", ""},
        BadScene{"SingleQuotes", "{'name': 1}", "", "line 1, column 2", ""},
        BadScene{"NaN", "{\"duration\": NaN}", "", "line 1, column 14", ""},
        BadScene{"TwoValues", "{} {}", "", "line 1, column 4", ""},
        BadScene{"UnclosedComment", "{} /* never", "", "JSON syntax error", ""},
        BadScene{"NumberTooLarge", "{\"duration\": 1e999}", "", "number overflow", ""},
        BadScene{"InvalidUtf8", "{\"name\": \"\xff\xfe\"}", "", "ill-formed UTF-8", ""},
        BadScene{"NotAnObject", "[]", "", "expects an object", "{ ... }"},
        BadScene{"JustANumber", "3", "", "expects an object", ""},
        BadScene{"UnknownField", "{\"duratoin\": 1}", "duratoin", "unknown field", "did you mean duration?"},
        BadScene{"UnknownFieldFarOff", "{\"qqqqqq\": 1}", "qqqqqq", "unknown field", "known: name"},
        BadScene{"UnknownNested", R"({"bodies": [{"mesh": {"sphere": {"radios": 1}}}]})",
                 "bodies[0].mesh.sphere.radios", "unknown field", "radius"},
        BadScene{"CamelCase", R"({"output": {"frameInterval": 1}})", "output.frameInterval", "unknown field",
                 "frame_interval"},
        BadScene{"TextForNumber", "{\"duration\": \"1\"}", "duration", "expects a number, got the text \"1\"", ""},
        BadScene{"NumberForText", "{\"name\": 7}", "name", "expects text in quotes, got the number 7", ""},
        BadScene{"BooleanForNumber", "{\"duration\": true}", "duration", "expects a number, got true", ""},
        BadScene{"Null", "{\"duration\": null}", "duration", "is null", "omit the field"},
        BadScene{"ObjectForList", "{\"bodies\": {}}", "bodies", "expects a list, got an object", "[ ... ]"},
        BadScene{"NumberForList", R"({"bodies": [{"mesh": {"box": {"size": 1}}}]})", "bodies[0].mesh.box.size",
                 "expects a list, got the number 1", ""},
        BadScene{"ListForObject", "{\"output\": []}", "output", "expects an object", ""},
        BadScene{"TextInList", R"({"bodies": [{"mesh": {"box": {"size": [1, "2", 3]}}}]})",
                 "bodies[0].mesh.box.size[1]", "expects a number", ""},
        BadScene{"FractionForInteger", R"({"bodies": [{"mesh": {"sphere": {"divisions": 2.5}}}]})",
                 "bodies[0].mesh.sphere.divisions", "expects a whole number, got the number 2.5", ""},
        BadScene{"IntegerTooLarge", R"({"bodies": [{"mesh": {"sphere": {"divisions": 3000000000}}}]})",
                 "bodies[0].mesh.sphere.divisions", "3000000000 is out of range", "-2147483648"},
        BadScene{"UnknownChoice", "{\"tet\": {\"stepping\": \"mixd\"}}", "tet.stepping", "unknown value \"mixd\"",
                 "did you mean mixed?"},
        BadScene{"UnspecifiedChoice", R"({"bodies": [{"unit": "unspecified"}]})", "bodies[0].unit", "unknown value",
                 "known: m, cm, mm"},
        BadScene{"NumberForChoice", R"({"bodies": [{"unit": 3}]})", "bodies[0].unit", "expects a name in quotes", ""},
        BadScene{"TwoShapes", R"({"bodies": [{"mesh": {"box": {}, "sphere": {}}}]})", "bodies[0].mesh.sphere",
                 "only one of file, box, fusiform, torus, sphere", "keep one"},
        BadScene{"KeyTwice", "{\"name\": \"a\", \"name\": \"b\"}", "name", "is given twice", "keep one"},
        BadScene{"KeyTwiceDeep", R"({"bodies": [{}, {"regions": [{"name": "a", "name": "b"}]}]})",
                 "bodies[1].regions[0].name", "is given twice", ""},
        BadScene{"TooDeep", std::string(5000, '[') + std::string(5000, ']'), "", "nested deeper than 64", ""},
        BadScene{"TooLarge", "{\"name\": \"" + std::string(17u << 20, 'x') + "\"}", "", "larger than 16 MiB", ""}),
    [](const auto& test) { return test.param.what; });

TEST(ParseScene, TellsAllProblemsAtOnce) {
  Problems problems;
  EXPECT_FALSE(ParseScene(R"({"duration": "x", "bodies": [{"unit": "inch", "densty": 3}, 7], "tet": {"safety": []}})",
                          problems));
  const std::string text = problems.ToString();
  for (const char* path : {"duration: ", "bodies[0].unit: ", "bodies[0].densty: ", "bodies[1]: ", "tet.safety: "}) {
    EXPECT_THAT(text, HasSubstr(path));
  }
  EXPECT_EQ(problems.count(), 5u) << text;
}

class LoadSceneTest : public ::testing::Test {
 protected:
  std::string WriteScene(const std::string& mesh_path, const std::string& folder = "scenes") {
    fs::create_directories(scratch_.path() / folder);
    const std::string path = scratch_ / (folder + "/scene.json");
    // Everything a scene needs, so that only its file can be wrong.
    WriteFile(path, R"({"bodies": [{"name": "a", "unit": "mm", "mesh": {"file": {"path": ")" + mesh_path + R"("}},
      "material": {"neo_hookean": {"young_modulus": 1e4}}}],
      "duration": 1, "output": {"frame_interval": 0.1}, "tet": {}})");
    return path;
  }

  // The only problem of a scene that refers to this mesh.
  Problem ProblemOf(const std::string& mesh_path) {
    Problems problems;
    EXPECT_FALSE(LoadScene(WriteScene(mesh_path), problems));
    EXPECT_EQ(problems.count(), 1u) << problems.ToString();
    return problems.empty() ? Problem{} : problems.kept().front();
  }

  TemporaryFolder scratch_;
};

TEST_F(LoadSceneTest, ReadsFilesAndSetsTheirDigests) {
  const std::string scene = WriteScene("meshes/a.msh");
  fs::create_directories(scratch_.path() / "scenes/meshes");
  WriteFile(scratch_ / "scenes/meshes/a.msh", std::string("bytes\0with zero", 15));
  Problems problems;
  const auto package = LoadScene(scene, problems);
  ASSERT_TRUE(package) << problems.ToString();
  ASSERT_EQ(package->assets.size(), 1u);
  EXPECT_EQ(package->assets[0].bytes.size(), 15u);
  EXPECT_EQ(package->assets[0].sha256_hex, Hex(Sha256Of(package->assets[0].bytes)));
  EXPECT_EQ(package->scene.bodies(0).mesh().file().asset(), "assets/" + package->assets[0].sha256_hex);
}

TEST_F(LoadSceneTest, FindsTheElementsOfATetGenMeshAndPacksEqualFilesOnce) {
  const std::string scene = WriteScene("a.node");
  WriteFile(scratch_ / "scenes/a.node", "same");
  WriteFile(scratch_ / "scenes/a.ele", "same");
  Problems problems;
  const auto package = LoadScene(scene, problems);
  ASSERT_TRUE(package) << problems.ToString();
  EXPECT_EQ(package->scene.bodies(0).mesh().elements().path(), "a.ele");
  EXPECT_EQ(package->scene.bodies(0).mesh().elements().asset(), package->scene.bodies(0).mesh().file().asset());
  EXPECT_EQ(package->assets.size(), 1u);
}

TEST_F(LoadSceneTest, SaysThatTheElementFileIsMissing) {
  fs::create_directories(scratch_.path() / "scenes");
  WriteFile(scratch_ / "scenes/a.node", "x");
  const Problem problem = ProblemOf("a.node");
  EXPECT_EQ(problem.path, "bodies[0].mesh.elements.path");
  EXPECT_THAT(problem.message, HasSubstr("a.ele"));
}

TEST_F(LoadSceneTest, RefusesFilesOutsideTheFolder) {
  WriteFile(scratch_ / "secret.msh", "x");
  EXPECT_THAT(ProblemOf("../secret.msh").message, HasSubstr("leads out of the scene's folder"));
  EXPECT_THAT(ProblemOf("sub/../../secret.msh").message, HasSubstr("leads out of the scene's folder"));
  EXPECT_THAT(ProblemOf(scratch_ / "secret.msh").message, HasSubstr("leads out of the scene's folder"));
  EXPECT_EQ(ProblemOf("/etc/passwd").path, "bodies[0].mesh.file.path");
  fs::create_symlink(scratch_.path() / "secret.msh", scratch_.path() / "scenes/link.msh");
  EXPECT_THAT(ProblemOf("link.msh").message, HasSubstr("link that leads out"));
  fs::create_directory_symlink(scratch_.path(), scratch_.path() / "scenes/up");
  EXPECT_THAT(ProblemOf("up/secret.msh").message, HasSubstr("link that leads out"));
  // A folder whose name begins with that of the scene's folder.
  fs::create_directories(scratch_.path() / "scenes2");
  WriteFile(scratch_ / "scenes2/a.msh", "x");
  fs::create_symlink(scratch_.path() / "scenes2/a.msh", scratch_.path() / "scenes/near.msh");
  EXPECT_THAT(ProblemOf("near.msh").message, HasSubstr("link that leads out"));
}

TEST_F(LoadSceneTest, FollowsLinksThatStayInside) {
  const std::string scene = WriteScene("link.msh");
  WriteFile(scratch_ / "scenes/real.msh", "x");
  fs::create_symlink("real.msh", scratch_.path() / "scenes/link.msh");
  Problems problems;
  EXPECT_TRUE(LoadScene(scene, problems)) << problems.ToString();
}

TEST_F(LoadSceneTest, RefusesWhatIsNoUsableFile) {
  EXPECT_THAT(ProblemOf("none.msh").message, HasSubstr("there is no file \"none.msh\""));
  EXPECT_THAT(ProblemOf("").message, HasSubstr("names no file"));
  fs::create_directories(scratch_.path() / "scenes/folder.msh");
  EXPECT_THAT(ProblemOf("folder.msh").message, HasSubstr("not a regular file"));
  // A device or pipe would never end.
  fs::create_symlink("/dev/zero", scratch_.path() / "scenes/zero.msh");
  EXPECT_THAT(ProblemOf("zero.msh").message, HasSubstr("leads out"));
  // Sparse: takes no space.
  WriteFile(scratch_ / "scenes/huge.msh", "");
  fs::resize_file(scratch_ / "scenes/huge.msh", (std::uintmax_t{4} << 30) + 1);
  EXPECT_THAT(ProblemOf("huge.msh").message, HasSubstr("larger than 4 GiB"));
}

TEST_F(LoadSceneTest, TellsProblemsOfSceneAndFilesTogether) {
  fs::create_directories(scratch_.path() / "scenes");
  const std::string path = scratch_ / "scenes/scene.json";
  WriteFile(path, R"({"duration": "long", "bodies": [{"mesh": {"file": {"path": "none.msh"}}, "unti": "mm"}]})");
  Problems problems;
  EXPECT_FALSE(LoadScene(path, problems));
  for (const char* field : {"duration: ", "bodies[0].mesh.file.path: ", "bodies[0].unti: "}) {
    EXPECT_THAT(problems.ToString(), HasSubstr(field));
  }
}

TEST_F(LoadSceneTest, RefusesWhatIsNoSceneFile) {
  Problems problems;
  EXPECT_FALSE(LoadScene(scratch_ / "none.json", problems));
  EXPECT_FALSE(LoadScene(scratch_.path().string(), problems));
  WriteFile(scratch_ / "huge.json", "");
  fs::resize_file(scratch_ / "huge.json", (16u << 20) + 1);
  EXPECT_FALSE(LoadScene(scratch_ / "huge.json", problems));
  EXPECT_EQ(problems.count(), 3u) << problems.ToString();
}

}  // namespace
}  // namespace fascicle::client
