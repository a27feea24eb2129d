// Every curve of a scene is found and checked.
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
                  "bodies[0].activation", "bodies[0].excitation.curve", "bodies[0].region_activations[0]",
                  "bodies[0].constraints[0].motion.translation[0]", "bodies[0].constraints[0].motion.translation[1]",
                  "bodies[0].constraints[0].motion.translation[2]", "bodies[0].constraints[0].motion.rotation.angle",
                  "bodies[0].loads[0].scale", "bodies[0].loads[1].scale", "bodies[0].loads[2].scale",
                  "bodies[0].loads[2].stern.angle", "bodies[0].loads[2].stern.activation", "bodies[0].loads[3].scale",
                  "bodies[0].loads[4].scale", "bodies[0].loads[5].scale", "bodies[0].loads[6].scale", "gravity.scale",
                  "rigid_bodies[0].motion.translation[0]", "rigid_bodies[0].motion.translation[1]",
                  "rigid_bodies[0].motion.translation[2]", "rigid_bodies[0].motion.rotation.angle", "skeleton.drive[0]",
                  "squeezes[0].scale"));
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

}  // namespace
}  // namespace fascicle
