#ifndef FASCICLE_TESTS_SUPPORT_FULL_SCENES_H_
#define FASCICLE_TESTS_SUPPORT_FULL_SCENES_H_

#include <vector>

#include "core/geometry/shapes.h"
#include "core/scene/scene.h"

// Scenes in which every optional field is set and every list has entries, one for each shape. Not to be run.
namespace fascicle::testing {

inline Motion FullMotion() {
  Motion motion;
  motion.translation = {Curve::Constant(0), Curve::Constant(0), Curve::Constant(0)};
  motion.rotation = Rotation{Vec3::Zero(), Vec3::UnitX(), Curve::Constant(0)};
  return motion;
}

inline ScalarFunction FullFunction() { return ScalarFunction::PiecewiseLinear({0, 1}, {2, 3}); }

inline DrivenSkeleton FullSkeleton() {
  DrivenSkeleton driven;
  Skeleton& skeleton = driven.skeleton;
  skeleton.name = "arm";
  skeleton.bones = {{"bone", 1, Vec3::Ones(), Mat3::Identity(), {{"bone.stl", Vec3::Ones(), Pose()}}}};
  skeleton.coordinates = {{"hinge", true, 0.1, 0.2, {-1, 1}, false}};
  Joint joint;
  joint.name = "hinge";
  for (auto* axes : {&joint.rotations, &joint.translations}) {
    for (MotionAxis& axis : *axes) axis = {Vec3::UnitX(), 0, FullFunction()};
  }
  skeleton.joints = {joint};
  skeleton.surfaces = {{"cylinder", 0, Pose(), WrapSurface::Kind::kCylinder, 0.1, 0.2, Vec3::Ones(), 1, 1}};
  LineMuscle muscle;
  muscle.name = "muscle";
  muscle.points = {{0, Vec3::Ones(), 0, {0, 1}, {0, 0, 0}, {FullFunction(), FullFunction(), FullFunction()}}};
  muscle.wraps = {{0, 0, 1}};
  skeleton.muscles = {muscle};
  driven.shapes = {{{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()}, {{0, 1, 2}}}};
  driven.motion.coordinates = {{FullFunction(), 0, 1}};
  driven.activations = {Curve::Constant(0.5)};
  driven.notes = {"note"};
  return driven;
}

inline Region FullRegion() {
  return {"region",
          {0, 1, 2},
          {{0, 1, 2}},
          {0},
          {{0, 1, 3, 2}},
          {{0, 1, 3, 2}},
          {TagSelector{1}, PlaneSelector{Vec3::Zero(), Vec3::UnitX()}, BoxSelector{Vec3::Zero(), Vec3::Ones()},
           SphereSelector{Vec3::Zero(), 1}, SideSelector{Vec3::UnitX(), 0.1, 0.2}}};
}

inline TetShape FullTetShape() {
  TetShape shape;
  shape.mesh = MakeBox(Vec3::Zero(), Vec3::Ones(), {1, 1, 1}, Cells::kHexahedra);
  shape.mesh.tetrahedron_tags = {1, 1, 1, 1, 1, 1};
  shape.mesh.tagged_triangles = {{0, 1, 2}};
  shape.mesh.triangle_tags = {1};
  shape.mesh.tagged_nodes = {0};
  shape.mesh.node_tags = {1};
  shape.mesh.curved_edges = {{{0, 1}, Vec3(0.5, 0, 0.1)}};
  shape.mesh.further_tags = {{0, 2}};
  shape.fibres.assign(6, Vec3::UnitX());
  shape.prestretch.assign(6, 1.1);
  shape.materials = {{LinearElastic(std::array{1e4, 0.3})}, {0, 0, 0, 1, 1, 1}};
  shape.viscoelasticity = {{{{0.5, 0.1}}}};
  shape.activations = {{Curve::Constant(0.5)}, {0, 0, 0, 1, 1, 1}};
  shape.activation_scale.assign(6, 0.5);
  shape.initial_displacement.assign(8, Vec3(0, 0, 1e-3));
  shape.initial_velocity.assign(8, Vec3(0, 1e-3, 0));
  return shape;
}

inline VoxelShape FullVoxelShape() {
  VoxelGrid grid = MakeVoxelGrid({2, 1, 1}, Vec3::Ones());
  grid.material = {1, 2};
  grid.stiffness = {1, 2};
  return {MakeBrickMesh(std::move(grid)), {{LinearElastic(std::array{1e4, 0.3})}, {0, 1}}};
}

inline SurfaceShape FullSurfaceShape() {
  const TetMesh filling = FullTetShape().mesh;
  return {{filling.nodes, BoundaryTriangles(filling)}, filling, FibreField(6, Vec3::UnitX()), Plasticity{1e3, 0.1}};
}

// Its rigid bodies contradict each other.
inline Scene FullScene(Method method, Shape shape) {
  Body body;
  body.name = "body";
  body.shape = std::move(shape);
  body.viscoelasticity = {{{0.2, 0.01}, {0.3, 1}}};
  body.regions = {FullRegion()};
  body.constraints = {{0, {true, true, true}, FullMotion()}};
  body.loads = {{0, Traction{Vec3(0, 0, 1)}, Curve::Constant(1), {}},
                {0, NodalForce{Vec3(0, 0, 1)}, Curve::Constant(1), {}},
                {0, NodalForce{Vec3(0, 0, 1)}, Curve::Constant(1), SternPull{{0.3, 0.03, 100, 1.5}, {}}}};
  if (method == Method::kTet) {
    body.loads.push_back({0, Pressure{1}, Curve::Constant(1), {}});
    body.loads.push_back({0, BodyForce{Vec3(0, 0, 1)}, Curve::Constant(1), {}});
    body.loads.push_back({0, Springs{Vec3(1, 1, 1)}, Curve::Constant(1), {}});
    body.loads.push_back({0, LineSpring{0, 0, 1, 0.1, false}, Curve::Constant(1), {}});
  }
  body.excitation = Excitation{};
  body.notes = {"a note"};
  Scene scene;
  scene.name = "full";
  scene.bodies = {std::move(body)};
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.floors = {{"ground", Vec3(0, 0, -10), Vec3::UnitZ()}};
  Motion slow = FullMotion();
  scene.rigid_bodies = {
      {"bone",
       Cylinder{0.1, 0.5},
       {Vec3(0, 0, -9), {1, 0, 0, 0}},
       slow,
       FreeRigidMotion{1.0, 2.0},
       "humerus",
       0.1,
       {0}},
      {"plane", HalfSpace(), {}, {}, {}, "", 0, {0}},
      {"ball", Ball{0.1}, {}, {}, {}, "", 0, {0}},
      {"box", Cuboid{Vec3::Ones()}, {}, {}, {}, "", 0, {0}},
      {"surface", TriangleMesh{{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()}, {{0, 1, 2}}}, {}, {}, {}, "", 0, {0}}};
  scene.method = method;
  scene.tet.time_step = scene.voxel.time_step = scene.eulerian.time_step = 1e-3;
  scene.eulerian.room = Bounds{-Vec3::Ones(), Vec3::Ones()};
  scene.squeezes = {{Vec3::Zero(), Vec3::UnitX(), 1, 1, Curve::Constant(1)}};
  scene.contacts = {{{0, 1}, 0.1, true}};
  scene.duration = 1;
  scene.output = {0.1, {OutputField::kVelocity}, {{"probe", 0, 0, ProbePlace{0, Vec3(0.2, 0.3, 0.1)}}}, 1e-3};
  scene.output.moments = {{0, 0, Vec3(0, 0, 1), Vec3::UnitX()}};
  scene.output.line_of_action = Vec3::UnitX();
  if (method == Method::kTet) scene.skeleton = FullSkeleton();
  return scene;
}

inline std::vector<Scene> FullScenes() {
  return {FullScene(Method::kTet, FullTetShape()), FullScene(Method::kVoxel, FullVoxelShape()),
          FullScene(Method::kEulerian, FullSurfaceShape())};
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_FULL_SCENES_H_
