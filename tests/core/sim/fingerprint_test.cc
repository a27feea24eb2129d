// The fingerprint of a scene sees each of its fields: scenes are changed in one place at a time.
#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/sim/fingerprint.h"
#include "tests/support/full_scenes.h"

namespace fascicle {
namespace {

// Visits all places of a scene where something can be changed, and changes one of them.
class Change {
 public:
  explicit Change(std::size_t place) : place_(place) {}

  // The path of the change; empty if there are fewer places.
  const std::string& path() const { return path_; }

  template <HasFields Struct>
  void Visit(Struct& s, const std::string& path) {
    VisitFields(s, [&](const char* name, auto& member) { Visit(member, path + "/" + name); });
  }

  template <class Number>
  requires std::is_arithmetic_v<Number>
  void Visit(Number& number, const std::string& path) {
    if (IsPlace(path)) number = std::is_same_v<Number, bool> ? !number : static_cast<Number>(number + 1);
  }

  template <class Enum>
  requires std::is_enum_v<Enum>
  void Visit(Enum& value, const std::string& path) {
    if (IsPlace(path)) value = static_cast<Enum>(static_cast<int>(value) + 1);
  }

  // A kind without any value.
  template <class Empty>
  requires std::is_empty_v<Empty>
  void Visit(Empty&, const std::string&) {}

  void Visit(std::string& text, const std::string& path) {
    if (IsPlace(path)) text += "x";
  }

  void Visit(Material& material, const std::string& path) {
    if (IsPlace(path)) material = MooneyRivlin(std::array{2e3, 1e3, 2e4});
  }

  template <class Scalar, int kRows, int kColumns>
  void Visit(Eigen::Matrix<Scalar, kRows, kColumns>& matrix, const std::string& path) {
    for (Eigen::Index k = 0; k < matrix.size(); ++k) Visit(matrix.data()[k], path + "/" + std::to_string(k));
  }

  template <class Value>
  void Visit(std::optional<Value>& value, const std::string& path) {
    if (!IsPlace(path)) {
      if (value) Visit(*value, path);
    } else if (value) {
      value.reset();
    } else {
      value.emplace();
    }
  }

  template <class... Kinds>
  void Visit(std::variant<Kinds...>& value, const std::string& path) {
    if (IsPlace(path)) return Replace(value);
    std::visit([&](auto& kind) { Visit(kind, path); }, value);
  }

  template <class Value>
  void Visit(std::vector<Value>& list, const std::string& path) {
    ASSERT_FALSE(list.empty()) << path << ": every list of these scenes has entries";
    if (IsPlace(path)) list.push_back(list.front());
    VisitEntries(list, path);
  }

  template <class Value, std::size_t kCount>
  void Visit(std::array<Value, kCount>& list, const std::string& path) {
    VisitEntries(list, path);
  }

 private:
  template <class List>
  void VisitEntries(List& list, const std::string& path) {
    for (std::size_t k = 0; k < list.size() && k < 10; ++k) Visit(list[k], path + "/" + std::to_string(k));
  }

  template <class First, class... Others>
  static void Replace(std::variant<First, Others...>& value) {
    if (value.index() == 0) {
      value.template emplace<1>();
    } else {
      value.template emplace<0>();
    }
  }

  bool IsPlace(const std::string& path) {
    if (next_++ != place_) return false;
    path_ = path;
    return true;
  }

  std::size_t place_;
  std::size_t next_ = 0;
  std::string path_;
};

TEST(FingerprintTest, SeesEachField) {
  for (const Scene& scene : testing::FullScenes()) {
    std::set<Digest> seen = {FingerprintOf(scene)};
    std::size_t place = 0;
    for (;; ++place) {
      Scene changed = scene;
      Change change(place);
      change.Visit(changed, "");
      if (change.path().empty()) break;
      EXPECT_TRUE(seen.insert(FingerprintOf(changed)).second) << change.path();
    }
    EXPECT_GT(place, 200u);
  }
}

TEST(FingerprintTest, IsThatOfTheFieldsAlone) {
  for (const Scene& scene : testing::FullScenes()) {
    const Scene copy = scene;
    EXPECT_EQ(FingerprintOf(copy), FingerprintOf(scene));
  }
}

TEST(FingerprintTest, SeesTheParametersOfLaws) {
  Scene scene = testing::FullScenes()[0];
  const Digest before = FingerprintOf(scene);
  scene.bodies[0].material = NeoHookean(std::array{1.0000001e4, 0.3});
  EXPECT_NE(FingerprintOf(scene), before);
}

}  // namespace
}  // namespace fascicle
