#ifndef FASCICLE_TESTS_CORE_TET_MIXED_SCENE_H_
#define FASCICLE_TESTS_CORE_TET_MIXED_SCENE_H_

#include "core/tet/forces.h"
#include "tests/support/tet_scenes.h"

// Elements of all kinds and a state, for tests of the loops over elements.
namespace fascicle::testing {

// Every law of the list, and the muscle with a force-velocity curve.
inline std::vector<Material> LawsOfKernels() {
  std::vector<Material> laws = EveryLaw();
  laws.push_back(Muscle(std::array{5e2, 5e2, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4, 5.0, 0.25, 1.4}));
  return laws;
}
inline constexpr int kLawsOfKernels = kLaws + 1;

// Two bodies with several chunks and incomplete blocks; fibres, activation and its scale vary from element to element.
inline Scene MixedScene(const Material& law, ElementOrder element, VolumeForm volume, int divisions) {
  Scene scene;
  for (int b = 0; b < 2; ++b) {
    Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {divisions + b, divisions, divisions}, law, CellsOf(element));
    body.name += static_cast<char>('a' + b);
    const NodalVector directions = RandomVectors(ElementCount(body.tet().mesh), 21 + b);
    for (const Vec3& direction : directions) body.tet().fibres.push_back((direction + Vec3(2, 0, 0)).normalized());
    for (std::size_t t = 0; t < directions.size(); ++t) {
      body.tet().activations.of.push_back(static_cast<std::int32_t>(t % 2));
      body.tet().activation_scale.push_back(0.5 + 0.4 * directions[t].x());
    }
    body.tet().activations.more = {Curve::Constant(0.2)};
    body.damping.viscosity = 12;
    body.damping.stiffness_proportional = b == 0 ? 1e-3 : 0;
    scene.bodies.push_back(std::move(body));
  }
  scene.tet.element = element;
  scene.tet.volume = volume;
  scene.duration = 1;
  return scene;
}

struct Setting {
  Setting(const Material& law, ElementOrder element, VolumeForm volume, int divisions)
      : scene(MixedScene(law, element, volume, divisions)), model(scene) {
    const double size = 0.02 / divisions;
    x = Shaken(model.rest_positions(), 0.12 * size * (element == ElementOrder::kLinear ? 1 : 0.5), 7);
    for (Vec3& position : x) position += 0.1 * Vec3(position.x(), position.z(), 0.3 * position.y());
    previous = x;
    for (Vec3& position : previous) position.x() *= 0.995;
    v = RandomVectors(x.size(), 5);
    drive = {activation, &previous, 100.0};
  }

  const Scene scene;
  const TetModel model;
  NodalVector x, previous, v;
  std::array<double, 4> activation = {0.6, 0.3, 0.9, 0.1};
  FibreDrive drive;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CORE_TET_MIXED_SCENE_H_
