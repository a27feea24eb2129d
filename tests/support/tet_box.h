#ifndef FASCICLE_TESTS_SUPPORT_TET_BOX_H_
#define FASCICLE_TESTS_SUPPORT_TET_BOX_H_

#include <array>
#include <utility>

#include "core/tet/forces.h"
#include "tests/support/tet_scenes.h"

// The boxes of linear tetrahedra for measurements of speed and memory, in several sizes.
namespace fascicle::testing {

struct BoxSize {
  int divisions;
  // The suffix of the row's name; empty for the standard size.
  const char* suffix;
};
inline constexpr std::array<BoxSize, 3> kBoxSizes = {{{12, "_10k"}, {26, ""}, {55, "_1M"}}};  // 6 n^3 tetrahedra

// 500 Pa, 500 Pa, K = 10 MPa, 0.3 MPa, optimal stretch 1.2, passive curve of Blemker.
inline constexpr std::array<double, 8> kMuscle = {5e2, 5e2, 1e7, 3e5, 1.2, 0.05, 6.6, 1.4};
inline constexpr std::array<double, 2> kNeoHookean = {1e4, 0.3};
inline constexpr double kActivation = 0.5;

// A cube of 0.1 m with oblique fibres, ready for stepping.
struct TetBox {
  TetBox(int divisions, const Material& material, VolumeForm volume, Precision precision = Precision::kDouble)
      : scene(MakeScene(divisions, material, volume, precision)) {}

  static Scene MakeScene(int divisions, const Material& material, VolumeForm volume,
                         Precision precision = Precision::kDouble) {
    Body body;
    body.name = "box";
    body.tet().mesh = MakeBox(Vec3::Zero(), Vec3::Constant(0.1), {divisions, divisions, divisions});
    body.material = material;
    body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3(1, 0.2, 0.1));
    body.activation = Curve::Constant(kActivation);
    Scene scene;
    scene.bodies.push_back(std::move(body));
    scene.tet.volume = volume;
    scene.tet.precision = precision;
    scene.duration = 1;
    scene.output.frame_interval = 1;
    return scene;
  }

  // Stretched along x by 1 at one end to 1.3 at the other, narrower and sheared: fibre stretches from 0.85 to 1.08 of
  // the optimal one, so that all branches of the curves except the outermost are evaluated.
  NodalVector Bent() const {
    NodalVector x = model.rest_positions();
    for (Vec3& p : x) p = Vec3(p[0] + 1.5 * p[0] * p[0], 0.95 * p[1] + 0.05 * p[0], 0.93 * p[2]);
    return x;
  }

  double Megatets() const { return 1e-6 * static_cast<double>(model.elements()); }

  const Scene scene;
  const TetModel model{scene};
};

// A neo-Hookean box fixed at one side that falls under its weight, in backward Euler steps of 10 ms to a residual force
// of 1e-4.
inline Scene FallingBox(int divisions) {
  Body body = BoxBody(Vec3::Constant(0.1), {divisions, divisions, divisions}, NeoHookean(kNeoHookean));
  body.constraints = {Fix(kX0)};
  Scene scene = OneBody(std::move(body));
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.tet.stepping = Stepping::kBackwardEuler;
  scene.tet.newton_tolerance = 1e-4;
  scene.tet.time_step = 0.01;
  return scene;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_TET_BOX_H_
