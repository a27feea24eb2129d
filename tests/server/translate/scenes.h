#ifndef FASCICLE_TESTS_SERVER_TRANSLATE_SCENES_H_
#define FASCICLE_TESTS_SERVER_TRANSLATE_SCENES_H_

#include <map>
#include <memory>
#include <optional>
#include <string>

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "core/base/digest.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// Two tetrahedra with a common face, 10 units long, with tags 1 (a triangle) and 7 (the tetrahedra).
inline const char kTwoTets[] = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
5
1 0 0 0
2 10 0 0
3 0 10 0
4 0 0 10
5 10 10 10
$EndNodes
$Elements
3
1 2 2 1 1 1 2 3
2 4 2 7 7 1 2 3 4
3 4 2 7 7 2 3 4 5
$EndElements
)";

// Files by digest, as a store would have them.
class Files {
 public:
  // Returns `assets/{digest}`.
  std::string Add(const std::string& bytes) {
    const std::string digest = Hex(Sha256Of(bytes));
    files_[digest] = bytes;
    return "assets/" + digest;
  }
  AssetReader reader() const {
    return [this](const std::string& digest) -> std::optional<std::string> {
      const auto found = files_.find(digest);
      if (found == files_.end()) return std::nullopt;
      return found->second;
    };
  }

 private:
  std::map<std::string, std::string> files_;
};

inline v1::Scene ParseText(const std::string& text) {
  v1::Scene scene;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &scene)) << text;
  return scene;
}

// A box of soft tissue, fixed at its lower end.
inline v1::Scene BoxScene() {
  return ParseText(R"(
    name: "box" duration: 1 tet {} output { frame_interval: 0.1 }
    bodies {
      name: "box" unit: LENGTH_UNIT_CM
      mesh { box { size: [2, 3, 4] divisions: [2, 3, 4] } }
      material { neo_hookean { young_modulus: 1e4 } }
      regions { name: "bottom" plane { point: [0, 0, 0] normal: [0, 0, -1] } }
      regions { name: "top" plane { point: [0, 0, 4] normal: [0, 0, 1] } }
      constraints { region: "bottom" }
    })");
}

// Translates a valid scene.
inline std::shared_ptr<const Scene> Translate(const v1::Scene& scene, const Files& files = {}) {
  Problems problems;
  auto translated = TranslateScene(scene, files.reader(), problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  return translated;
}

// The problems of a scene.
inline Problems ProblemsOf(const v1::Scene& scene, const Files& files = {}, const TranslateLimits& limits = {}) {
  Problems problems;
  const auto translated = TranslateScene(scene, files.reader(), problems, limits);
  EXPECT_EQ(translated == nullptr, !problems.empty());
  return problems;
}

// The text `message (hint)` of each problem at `path`, joined.
inline std::string At(const Problems& problems, const std::string& path) {
  std::string text;
  for (const Problem& problem : problems.kept()) {
    if (problem.path == path) text += problem.message + " (" + problem.hint + ")";
  }
  return text.empty() ? "nothing at " + path + " in\n" + problems.ToString() : text;
}

}  // namespace fascicle::server

#endif  // FASCICLE_TESTS_SERVER_TRANSLATE_SCENES_H_
