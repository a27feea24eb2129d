#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>

#include "core/base/vector_text.h"
#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

// A body may begin this deep inside of another one, relative to its mean element: contact pushes it out.
constexpr double kDeepestStart = 0.1;

bool IsPositive(double value) { return value > 0 && std::isfinite(value); }

bool IsProper(const ObstacleShape& shape) {
  if (const auto* ball = std::get_if<Ball>(&shape)) return IsPositive(ball->radius);
  if (const auto* box = std::get_if<Cuboid>(&shape)) return box->size.minCoeff() > 0 && box->size.allFinite();
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    return IsPositive(cylinder->radius) && IsPositive(cylinder->length);
  }
  const auto* mesh = std::get_if<TriangleMesh>(&shape);
  return mesh == nullptr || !mesh->triangles.empty();
}

bool IsProper(const Pose& pose) {
  const auto [w, x, y, z] = pose.quaternion;
  return pose.position.allFinite() && std::abs(w * w + x * x + y * y + z * z - 1) < 1e-9;
}

void CheckMotions(const RigidBody& rigid, const std::string& path, Problems& problems) {
  if (rigid.motion.has_value() + rigid.free.has_value() + !rigid.bone.empty() > 1) {
    problems.Add(path, "has more than one of motion, free and bone", "give at most one");
  }
  if (!rigid.bone.empty()) {
    problems.Add(JoinPath(path, "bone"), "is not supported yet", "use motion for a prescribed motion");
  }
  if (rigid.free && (rigid.free->mass.has_value() == rigid.free->density.has_value())) {
    problems.Add(JoinPath(path, "free"), "needs either a mass or a density");
  }
  if (rigid.free && std::holds_alternative<HalfSpace>(rigid.shape)) {
    problems.Add(JoinPath(path, "free"), "a half-space cannot move freely", "use a box");
  }
  if (!rigid.motion) return;
  const RigidMotion start = RigidMotionAt(rigid, 0);
  if (start.translation != Vec3::Zero() || start.rotation != Mat3::Identity()) {
    problems.Add(JoinPath(path, "motion"), "does not begin at 0 at time 0",
                 "position and rotation give the pose at time 0");
  }
}

// The nodes that no support holds.
std::vector<bool> FreeNodes(const Body& body) {
  std::vector<bool> free(body.nodes().size(), true);
  for (const Constraint& constraint : body.constraints) {
    if (constraint.region < 0 || constraint.region >= static_cast<std::int32_t>(body.regions.size())) continue;
    for (const std::int32_t n : body.regions[constraint.region].nodes) free[n] = false;
  }
  return free;
}

double MeanElementSize(const TetShape& shape) {
  return std::cbrt(TotalVolume(shape.mesh) / static_cast<double>(std::max<std::size_t>(1, ElementCount(shape.mesh))));
}

std::vector<Vec3> StartPositions(const TetShape& shape) {
  std::vector<Vec3> x = shape.mesh.nodes;
  for (std::size_t n = 0; n < std::min(x.size(), shape.initial_displacement.size()); ++n) {
    x[n] += shape.initial_displacement[n];
  }
  return x;
}

// The largest depth(node, position), at least 0, and its place.
template <class Depth>
std::pair<double, Vec3> DeepestOf(const std::vector<Vec3>& x, const Depth& depth) {
  std::pair<double, Vec3> deepest = {0, Vec3::Zero()};
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (const double d = depth(n, x[n]); d > deepest.first) deepest = {d, x[n]};
  }
  return deepest;
}

void CheckStart(const RigidBody& rigid, const Body& body, const std::string& path, Problems& problems) {
  const auto* shape = std::get_if<TetShape>(&body.shape);
  if (shape == nullptr) return;
  const ObstacleDistance distance(rigid.shape);
  const Mat3 R = RotationOf(rigid.pose);
  const std::vector<bool> free = FreeNodes(body);
  const auto [deepest, place] = DeepestOf(StartPositions(*shape), [&](std::size_t n, const Vec3& x) {
    return free[n] ? -distance.At(R.transpose() * (x - rigid.pose.position)).distance : 0;
  });
  if (!(deepest > kDeepestStart * MeanElementSize(*shape))) return;
  char depth[32];
  std::snprintf(depth, sizeof depth, "%.3g m", deepest);
  problems.Add(path, "the body `" + body.name + "` starts " + depth + " inside of it, at " + VectorText(place) + " m",
               "move one of them, hold that part of the body by a constraint, or list in `bodies` what it touches");
}

void CheckRigidBody(const Scene& scene, const RigidBody& rigid, const std::string& path, Problems& problems) {
  CheckMotions(rigid, path, problems);
  const bool proper = IsProper(rigid.shape) && IsProper(rigid.pose);
  if (!proper) problems.Add(path, "has no proper shape and pose");
  if (!(rigid.friction >= 0 && std::isfinite(rigid.friction))) {
    problems.Add(JoinPath(path, "friction"), "must be at least 0");
  }
  for (const std::int32_t b : rigid.bodies) {
    if (b < 0 || b >= static_cast<std::int32_t>(scene.bodies.size())) {
      problems.Add(JoinPath(path, "bodies"), "refers to a body that does not exist");
      return;
    }
  }
  for (std::size_t b = 0; proper && b < scene.bodies.size(); ++b) {
    if (Touches(rigid, b)) CheckStart(rigid, scene.bodies[b], path, problems);
  }
}

}  // namespace

void CheckRigidBodies(const Scene& scene, Problems& problems) {
  std::set<std::string> names;
  for (const Floor& floor : scene.floors) names.insert(floor.name);
  for (std::size_t k = 0; k < scene.rigid_bodies.size(); ++k) {
    const std::string path = IndexPath("rigid_bodies", k);
    const RigidBody& rigid = scene.rigid_bodies[k];
    if (!names.insert(rigid.name).second) {
      problems.Add(JoinPath(path, "name"), "`" + rigid.name + "` is the name of another rigid body or floor");
    }
    CheckRigidBody(scene, rigid, path, problems);
  }
}

void RefuseRigidBodies(const Scene& scene, const std::string& method, Problems& problems) {
  if (scene.rigid_bodies.empty()) return;
  problems.Add("rigid_bodies", "the " + method + " method does not support rigid bodies",
               "omit them, or use the tet method");
}

}  // namespace fascicle::scene_checks
