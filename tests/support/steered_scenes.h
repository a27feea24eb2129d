#ifndef FASCICLE_TESTS_SUPPORT_STEERED_SCENES_H_
#define FASCICLE_TESTS_SUPPORT_STEERED_SCENES_H_

#include <string>
#include <vector>

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "fascicle/v1/scene.pb.h"

// Small scenes with everything that can be steered, which run until they are cancelled.
namespace fascicle::service_test {

inline v1::Scene SceneFromText(const std::string& text) {
  v1::Scene scene;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &scene)) << text;
  return scene;
}

// A block along x with the regions `origin`, which is fixed, and `insertion`, which is pulled and, if `moves`, moved
// to and fro; `method` and `material` in the text format of messages.
inline v1::Scene SteeredBlock(const std::string& method, const std::string& material, bool moves = true) {
  const std::string motion = R"(constraints { region: "insertion" motion { translation { axis: AXIS_X
    curve { times: [0, 500] values: [0.0005, 0.001] } } } })";
  return SceneFromText(R"(
    name: "steered block" duration: 900 output { frame_interval: 0.01 } gravity { acceleration: [0, 0, -9.81] } )" +
                       method + R"(
    bodies {
      name: "muscle" unit: LENGTH_UNIT_CM
      mesh { box { size: [8, 6, 6] divisions: [4, 2, 2] } } )" +
                       material + R"(
      damping { mass_proportional: 20 }
      regions { name: "origin" box { min: [0, 0, 0] max: [1, 6, 6] } }
      regions { name: "insertion" plane { point: [8, 0, 0] normal: [1, 0, 0] } }
      regions { name: "side" side { direction: [0, 0, 1] } }
      constraints { region: "origin" } )" +
                       (moves ? motion : "") + R"(
      loads { region: "side" traction { vector: [0, 0, 50] } }
    })");
}

inline constexpr const char* kSoftMuscle = R"(
  material { muscle { c1: 4000 c2: 0 bulk_modulus: 1e5 peak_stress: 1e5 } } fibres { constant { direction: [1, 0, 0] } })";
inline constexpr const char* kSoftTissue = "material { linear_elastic { young_modulus: 2e4 poisson_ratio: 0.3 } }";

struct SteeredScene {
  std::string name;
  v1::Scene scene;
};

// One for each method and kind of stepping.
inline std::vector<SteeredScene> SteeredScenes() {
  return {{"explicit", SteeredBlock("tet {}", kSoftMuscle)},
          {"newmark", SteeredBlock("tet { stepping: STEPPING_NEWMARK }", kSoftMuscle)},
          {"quasi-static", SteeredBlock("tet { stepping: STEPPING_QUASI_STATIC }", kSoftMuscle)},
          {"static voxels", SteeredBlock("voxel {}", kSoftTissue)},
          {"dynamic voxels", SteeredBlock("voxel { stepping: VOXEL_STEPPING_DYNAMIC time_step: 0.002 }", kSoftTissue)},
          {"eulerian", SteeredBlock("eulerian { cell_size: 0.015 margin: 0.5 }", kSoftMuscle, /*moves=*/false)}};
}

}  // namespace fascicle::service_test

#endif  // FASCICLE_TESTS_SUPPORT_STEERED_SCENES_H_
