#ifndef FASCICLE_TESTS_DETERMINISM_SMALL_SCENES_H_
#define FASCICLE_TESTS_DETERMINISM_SMALL_SCENES_H_

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/brick_bodies.h"
#include "tests/support/eulerian_scenes.h"
#include "tests/support/tet_scenes.h"

// A small scene of nine frames for each stepping of each method, large enough that every thread has work.
namespace fascicle::testing {

// A contracting muscle beside a bar that is bent, twisted and loaded, with every feature of a step; `across`
// hexahedra.
inline Scene BusyScene(Stepping stepping, ElementOrder element, int across) {
  Body muscle = MakeBody("muscle",
                         MakeFusiform({.length = 0.1,
                                       .belly_radius = 0.012,
                                       .end_radius = 0.006,
                                       .divisions_across = across,
                                       .divisions_along = 16},
                                      CellsOf(element)),
                         Muscle(std::array{5e2, 5e2, 2e5, 3e4, 1.4, 0.05, 6.6, 1.4}));
  muscle.tet().fibres = ConstantFibres(muscle.tet().mesh, Vec3::UnitZ());
  muscle.constraints = {Fix(kZ0), Fix(kZ1)};
  muscle.activation = {{0, 0.005}, {0, 1}, Curve::Interpolation::kSmooth};
  muscle.damping = {.mass_proportional = 10, .viscosity = 2};
  Body bar =
      BoxBody(Vec3(0.06, 0.02, 0.02), {12, across, across}, CorotatedLinear(std::array{1e4, 0.3}), CellsOf(element));
  Constraint turn = Fix(kX1);
  turn.motion.rotation = Rotation{Vec3(0, 0.01, 0.01), Vec3::UnitX(), Curve{{0, 0.01}, {0, 0.2}}};
  bar.constraints = {Fix(kX0), turn};
  bar.loads.push_back({kY1, Traction{Vec3(0, 100, 0)}, Curve{{0, 0.003}, {0, 1}}, {}});
  bar.damping = {.mass_proportional = 5, .stiffness_proportional = 1e-4};
  Scene scene;
  scene.bodies = {muscle, bar};
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.tet.stepping = stepping;
  scene.tet.element = element;
  scene.duration = 0.006;
  scene.output.frame_interval = 0.0008;
  scene.output.fields = {OutputField::kVelocity, OutputField::kCauchyStress, OutputField::kFibreStretch};
  scene.output.probes = {{"bar", 1, 100}};
  return scene;
}

// A block that is pressed and sheared, and a bone that moves into it.
inline Scene ContactScene(Stepping stepping, ElementOrder element, int across) {
  Body block =
      BoxBody(Vec3(0.02, 0.02, 0.01), {across, across, across}, NeoHookean(std::array{2e4, 0.4}), CellsOf(element));
  Constraint press = Fix(kZ1);
  press.motion.translation[2] = Curve{{0, 0.01}, {0, -0.001}};
  press.motion.translation[0] = Curve{{0, 0.01}, {0, 0.001}};
  block.constraints = {Fix(kZ0), press};
  block.damping.mass_proportional = 5;
  Scene scene;
  scene.bodies = {block};
  RigidBody bone{"bone", Cylinder{0.003, 0.03}, {Vec3(-0.00301, 0.01, 0.006), {1, 0, 0, 0}}, Motion(), {}, "", 0, {}};
  bone.pose.quaternion = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  bone.motion->translation[0] = Curve{{0, 0.01}, {0, 0.002}};
  scene.rigid_bodies = {bone};
  scene.tet.stepping = stepping;
  scene.tet.element = element;
  scene.duration = 0.006;
  scene.output.frame_interval = 0.0008;
  scene.output.fields = {OutputField::kVelocity, OutputField::kCauchyStress};
  return scene;
}

// Bricks that are bent by an increasing load, and twisted; large enough for a hierarchy of grids.
inline Scene BentBricks(VoxelStepping stepping, Material law) {
  Body body = VoxelBox(Vec3(0.05, 0.03, 0.03), {15, 9, 9}, std::move(law));
  Constraint turn = {1, {true, false, false}, {}};
  turn.motion.rotation = Rotation{Vec3(0, 0.015, 0.015), Vec3::UnitX(), Curve{{0, 0.01}, {0, 0.2}}};
  body.constraints = {{0, {true, true, true}, {}}, turn};
  body.loads.push_back({1, NodalForce{Vec3(0, 0.1, 0.2)}, Curve{{0, 0.004}, {0, 1}}, {}});
  body.damping.mass_proportional = 10;
  Scene scene = VoxelScene(std::move(body));
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.voxel.stepping = stepping;
  scene.duration = 0.008;
  scene.output.frame_interval = 0.001;
  scene.output.fields = {OutputField::kCauchyStress, OutputField::kVolumeRatio};
  return scene;
}

// Two cubes in plane force fields: one neo-Hookean, the other with fibres and plasticity.
inline Scene PressedCubes() {
  Body cube = EulerianCube();
  cube.constraints = {{0, {true, true, true}, {}}};
  cube.loads.push_back({1, Traction{Vec3(0, 0, -100)}, Curve{{0, 0.01}, {0, 1}}, {}});
  Body muscle = EulerianCube("muscle");
  muscle.material = Muscle(std::array{1e3, 0.0, 1e5, 1e4, 1.0, 0.05, 6.6, 1.4, 0.0, 0.25, 1.4});
  muscle.surface().fibres = {Vec3::UnitX()};
  muscle.surface().plasticity = Plasticity{50, 0};
  muscle.activation = Curve{{0, 0.02}, {0, 0.5}};
  muscle.constraints = {{0, {true, true, true}, {}}};
  Scene scene = EulerianScene({std::move(cube), std::move(muscle)});
  scene.gravity.acceleration = Vec3(5, 0, 0);
  scene.squeezes.push_back({Vec3::Constant(0.03), Vec3::UnitX(), 1e4, 0.01, Curve::Constant(1)});
  scene.output.frame_interval = 0.0025;
  scene.output.fields = {OutputField::kVelocity, OutputField::kCauchyStress};
  return scene;
}

struct NamedScene {
  std::string name;
  Scene scene;
};

inline NamedScene TetScene(const std::string& name, Stepping stepping, ElementOrder element) {
  // Implicit and quadratic steps take longer: they get fewer elements, and the longest ones a shorter time.
  const bool is_explicit = stepping == Stepping::kExplicit || stepping == Stepping::kMixed;
  const bool is_quadratic = element == ElementOrder::kQuadratic || element == ElementOrder::kHexahedralQuadratic;
  NamedScene named = {"tet_" + name + "_" + ElementNameOf(element),
                      BusyScene(stepping, element, is_explicit && !is_quadratic ? 8 : 2)};
  if (is_quadratic && (is_explicit || element == ElementOrder::kHexahedralQuadratic)) {
    named.scene.duration /= 4;
    named.scene.output.frame_interval /= 4;
  }
  return named;
}

// The same with viscoelastic bodies.
inline NamedScene ViscoelasticScene(const std::string& name, Stepping stepping, ElementOrder element) {
  NamedScene named = TetScene(name, stepping, element);
  named.name += "_viscoelastic";
  named.scene.bodies[0].viscoelasticity = {{{0.4, 1e-3}}};
  named.scene.bodies[1].viscoelasticity = {{{0.3, 5e-4}, {0.5, 0.01}}};
  return named;
}

inline NamedScene ControlledScene(const std::string& name, Stepping stepping, ElementOrder element) {
  NamedScene named = TetScene(name, stepping, element);
  named.name += "_step_error";
  named.scene.tet.step_error = 1e-5;
  return named;
}

inline NamedScene VoxelSceneOf(const std::string& name, VoxelStepping stepping, Material law) {
  return {"voxel_" + name, BentBricks(stepping, std::move(law))};
}

inline NamedScene EulerianSceneOf(const std::string& name, VolumeTreatment volume, bool implicit_elasticity) {
  NamedScene named = {"eulerian_" + name, PressedCubes()};
  named.scene.eulerian.volume = volume;
  named.scene.eulerian.implicit_elasticity = implicit_elasticity;
  return named;
}

inline std::vector<NamedScene> SmallScenes() {
  std::vector<NamedScene> scenes;
  for (const ElementOrder element : kEveryElement) {
    scenes.push_back(TetScene("explicit", Stepping::kExplicit, element));
    scenes.push_back(TetScene("mixed", Stepping::kMixed, element));
    scenes.push_back(TetScene("backward_euler", Stepping::kBackwardEuler, element));
    scenes.push_back(TetScene("newmark", Stepping::kNewmark, element));
    scenes.push_back(TetScene("bdf2", Stepping::kBdf2, element));
    scenes.push_back(TetScene("quasi_static", Stepping::kQuasiStatic, element));
  }
  scenes.push_back(ViscoelasticScene("explicit", Stepping::kExplicit, ElementOrder::kLinear));
  scenes.push_back(ViscoelasticScene("newmark", Stepping::kNewmark, ElementOrder::kLinear));
  scenes.push_back(ViscoelasticScene("quasi_static", Stepping::kQuasiStatic, ElementOrder::kQuadratic));
  for (const auto& [name, stepping] :
       {std::pair("explicit", Stepping::kExplicit), std::pair("mixed", Stepping::kMixed),
        std::pair("backward_euler", Stepping::kBackwardEuler), std::pair("newmark", Stepping::kNewmark),
        std::pair("bdf2", Stepping::kBdf2), std::pair("quasi_static", Stepping::kQuasiStatic)}) {
    const bool is_explicit = stepping == Stepping::kExplicit || stepping == Stepping::kMixed;
    scenes.push_back(
        {"tet_contact_" + std::string(name), ContactScene(stepping, ElementOrder::kLinear, is_explicit ? 6 : 3)});
  }
  scenes.push_back({"tet_contact_quadratic", ContactScene(Stepping::kQuasiStatic, ElementOrder::kQuadratic, 2)});
  const Material linear = LinearElastic(std::array{1e5, 0.3}), corotated = CorotatedLinear(std::array{1e5, 0.3});
  scenes.push_back(ControlledScene("bdf2", Stepping::kBdf2, ElementOrder::kLinear));
  scenes.push_back(VoxelSceneOf("static", VoxelStepping::kStatic, linear));
  scenes.push_back(VoxelSceneOf("dynamic", VoxelStepping::kDynamic, linear));
  scenes.push_back(VoxelSceneOf("corotated_static", VoxelStepping::kStatic, corotated));
  scenes.push_back(VoxelSceneOf("corotated_dynamic", VoxelStepping::kDynamic, corotated));
  scenes.push_back(EulerianSceneOf("explicit", VolumeTreatment::kNone, false));
  scenes.push_back(EulerianSceneOf("preserved", VolumeTreatment::kPreserved, false));
  scenes.push_back(EulerianSceneOf("implicit", VolumeTreatment::kPreserved, true));
  return scenes;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_DETERMINISM_SMALL_SCENES_H_
