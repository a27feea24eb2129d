// Every stepping with each element through a real server: the digests are those of `run`, also if the server is killed
// during the job; and jobs can be cancelled during a run.
#include <gtest/gtest.h>

#include <tuple>

#include "digest_job.h"

namespace fascicle::testing {
namespace {

// A spindle that contracts and vibrates, with damping: `frames` frames of 2 ms.
std::string SteppingSceneText(const std::string& stepping, const std::string& element, int frames) {
  return R"({"bodies": [{"name": "muscle", "unit": "cm",
    "mesh": {"fusiform": {"length": 6, "belly_radius": 1, "end_radius": 0.6, "divisions_across": 2, "divisions_along": 6}},
    "material": {"muscle": {"bulk_modulus": 1e5}},
    "fibres": {"constant": {"direction": [0, 0, 1]}},
    "regions": [{"name": "origin", "plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}},
                {"name": "insertion", "plane": {"point": [0, 0, 6], "normal": [0, 0, 1]}}],
    "constraints": [{"region": "origin"}, {"region": "insertion", "axes": ["x", "y"]}],
    "activation": {"times": [0, 0.05], "values": [0, 0.3], "interpolation": "smooth"},
    "damping": {"mass_proportional": 20, "viscosity": 1},
    "loads": [{"region": "insertion", "nodal_force": {"total": [0, 0, 1]}}]}],
    "duration": )" +
         std::to_string(0.002 * frames) +
         R"(, "output": {"frame_interval": 0.002, "fields": ["fibre_stretch"]}, "tet": {"stepping": ")" + stepping +
         R"(", "element": ")" + element + R"("}})";
}

class SteppingsTest : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  static std::string Scene(int frames) {
    const auto& [stepping, element] = GetParam();
    return SteppingSceneText(stepping, element, frames);
  }

  DigestJob job_;
};

TEST_P(SteppingsTest, SameDigestsAsRunAlsoWhenKilled) { job_.ExpectSameDigestsAsRunAlsoWhenKilled(Scene(25), 25); }

TEST_P(SteppingsTest, CanBeCancelled) { job_.ExpectCanBeCancelled(Scene(50000)); }

INSTANTIATE_TEST_SUITE_P(Every, SteppingsTest,
                         ::testing::Combine(::testing::Values("explicit", "mixed", "backward_euler", "newmark", "bdf2",
                                                              "quasi_static"),
                                            ::testing::Values("linear", "quadratic")),
                         [](const auto& test) { return std::get<0>(test.param) + "_" + std::get<1>(test.param); });

}  // namespace
}  // namespace fascicle::testing
