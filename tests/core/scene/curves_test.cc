// Every curve of a scene is found and checked, and counts for the time after which all curves are constant.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "core/scene/curves.h"
#include "tests/support/full_scenes.h"

namespace fascicle {
namespace {

std::map<std::string, Curve*> CurvesOf(Scene& scene) {
  std::map<std::string, Curve*> curves;
  // The curves of a non-const scene are not const.
  VisitCurves(scene, [&](const Curve& curve, const std::string& path) { curves[path] = const_cast<Curve*>(&curve); });
  return curves;
}

TEST(CurvesTest, AllAreVisitedWithTheirPaths) {
  Scene scene = testing::FullScene(Method::kTet, testing::FullTetShape());
  std::vector<std::string> paths;
  for (const auto& [path, curve] : CurvesOf(scene)) paths.push_back(path);
  EXPECT_THAT(paths,
              ::testing::UnorderedElementsAre(
                  "bodies[0].activation", "bodies[0].region_activations[0]",
                  "bodies[0].constraints[0].motion.translation[0]", "bodies[0].constraints[0].motion.translation[1]",
                  "bodies[0].constraints[0].motion.translation[2]", "bodies[0].constraints[0].motion.rotation.angle",
                  "bodies[0].loads[0].scale", "bodies[0].loads[1].scale", "gravity.scale", "squeezes[0].scale"));
}

TEST(CurvesTest, EachIsChecked) {
  for (Scene& scene : testing::FullScenes()) {
    for (const auto& [path, curve] : CurvesOf(scene)) {
      const Curve good = *curve;
      curve->times.push_back(1);
      Problems problems;
      CheckScene(scene, problems);
      EXPECT_TRUE(std::any_of(problems.kept().begin(), problems.kept().end(),
                              [&](const Problem& problem) {
                                return problem.path == path + ".values" && problem.message == "1 values for 2 times";
                              }))
          << path << " in " << problems.ToString();
      *curve = good;
    }
  }
}

TEST(CurvesTest, TheLastToChangeEndsThem) {
  for (Scene& scene : testing::FullScenes()) {
    EXPECT_EQ(CurvesEnd(scene), 0);
    double end = 1;
    for (const auto& [path, curve] : CurvesOf(scene)) {
      *curve = {{0, end}, {0, 1}, Curve::Interpolation::kLinear};
      EXPECT_EQ(CurvesEnd(scene), end) << path;
      end += 1;
    }
  }
}

// A curve of one point is constant for all times, wherever the point is.
TEST(CurvesTest, AConstantNeverChanges) {
  Scene scene = testing::FullScene(Method::kTet, testing::FullTetShape());
  scene.gravity.scale.times = {5};
  EXPECT_EQ(CurvesEnd(scene), 0);
}

}  // namespace
}  // namespace fascicle
