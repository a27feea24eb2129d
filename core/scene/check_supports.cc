#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/vector_text.h"
#include "core/scene/checks.h"
#include "core/scene/free_motions.h"
#include "core/scene/nodal_forces.h"

namespace fascicle::scene_checks {
namespace {

// Resultant of a load at scale 1 [N].
Vec3 Resultant(const Body& body, const Load& load) {
  Vec3 sum = Vec3::Zero();
  for (const auto& [node, force] : NodalForcesOf(load, LoadedRegionOf(body.regions[load.region], body))) {
    sum += force;
  }
  return sum;
}

double VolumeOf(const TetShape& shape) { return TotalVolume(shape.mesh); }
double VolumeOf(const VoxelShape& shape) {
  return static_cast<double>(shape.mesh.bricks.size()) * shape.mesh.grid.spacing.prod();
}
double VolumeOf(const SurfaceShape& shape) { return EnclosedVolume(shape.mesh); }

// Whether the scene asks for an equilibrium.
bool IsStatic(const Scene& scene) {
  if (scene.method == Method::kVoxel) {
    return scene.voxel.stepping == VoxelStepping::kStatic || scene.voxel.start_loaded;
  }
  return scene.method == Method::kTet && (scene.tet.stepping == Stepping::kQuasiStatic || scene.start.equilibrium);
}

std::array<bool, 3> HeldAxes(const Body& body) {
  std::array<bool, 3> held = {};
  for (const Constraint& constraint : body.constraints) {
    for (int axis = 0; axis < 3; ++axis) held[axis] |= constraint.axes[axis];
  }
  for (const Load& load : body.loads) {
    const auto* springs = std::get_if<Springs>(&load.kind);
    for (int axis = 0; axis < 3 && springs != nullptr; ++axis) held[axis] |= springs->stiffness[axis] > 0;
  }
  return held;
}

// The factor of a load over time; a muscle's force is non-zero while it is active.
const Curve& ScaleOf(const Load& load) { return load.stern ? load.stern->drive.activation : load.scale; }

// Whether the loads on a body have a resultant along `axis` at any time, up to round-off. Between the points of their
// curves the scales lie between those at the points, so it is enough to check the points.
bool Pushes(const Scene& scene, const Body& body, const std::vector<Vec3>& resultants, double mass, int axis) {
  std::vector<double> times = scene.gravity.scale.times;
  for (const Load& load : body.loads) {
    const Curve& scale = ScaleOf(load);
    times.insert(times.end(), scale.times.begin(), scale.times.end());
  }
  return std::any_of(times.begin(), times.end(), [&](double time) {
    double net = mass * scene.gravity.acceleration[axis] * scene.gravity.scale.At(time);
    double size = std::abs(net);
    for (std::size_t k = 0; k < resultants.size(); ++k) {
      const double force = resultants[k][axis] * ScaleOf(body.loads[k]).At(time);
      net += force;
      size += std::abs(force);
    }
    return std::abs(net) > 1e-9 * size;
  });
}

// Whether the body touches a rigid body or another body.
bool HasContact(const Scene& scene, std::size_t body) {
  return std::any_of(scene.rigid_bodies.begin(), scene.rigid_bodies.end(),
                     [&](const RigidBody& rigid) { return Touches(rigid, body); }) ||
         std::any_of(scene.contacts.begin(), scene.contacts.end(),
                     [&](const Contact& contact) { return Touches(contact, body); });
}

// Whether something that the body cannot enter acts along an axis: a body that falls on it comes to rest, or bounces.
bool HasFloorAcross(const Scene& scene, std::size_t body, int axis) {
  return HasContact(scene, body) || std::any_of(scene.floors.begin(), scene.floors.end(), [axis](const Floor& floor) {
           return std::abs(floor.normal[axis]) > 0.01;
         });
}

// An equilibrium needs supports against every rigid motion; floors and contacts only push, so bodies with these are
// not judged.
void CheckFreeParts(const Scene& scene, std::size_t i, Problems& problems) {
  if (scene.method != Method::kTet || !IsStatic(scene) || !scene.floors.empty() || HasContact(scene, i)) return;
  for (const FreePart& part : FindFreeParts(scene.bodies[i])) {
    std::string who = "the body";
    if (part.parts > 1) {
      who = "the part of " + std::to_string(part.tetrahedra) + " tetrahedra at " + VectorText(part.place) + " m";
    }
    problems.Add(JoinPath(IndexPath("bodies", i), "constraints"),
                 "the supports leave " + who + " free: it " + part.motions,
                 "the equilibrium is not unique: hold more nodes or axes, or use a stepping with inertia");
  }
}

}  // namespace

void CheckSupports(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::array<bool, 3> held = HeldAxes(body);
    std::vector<Vec3> resultants;
    for (const Load& load : body.loads) resultants.push_back(Resultant(body, load));
    const double mass = body.density * std::visit([](const auto& shape) { return VolumeOf(shape); }, body.shape);
    if (std::all_of(held.begin(), held.end(), [](bool axis) { return axis; })) CheckFreeParts(scene, i, problems);
    for (int axis = 0; axis < 3; ++axis) {
      if (!held[axis] && IsStatic(scene)) {
        problems.Add(JoinPath(IndexPath("bodies", i), "constraints"),
                     std::string("no support holds the body along ") + "xyz"[axis],
                     "the equilibrium is not unique: add a constraint, or use a stepping with inertia");
        continue;
      }
      if (held[axis] || HasFloorAcross(scene, i, axis) || !Pushes(scene, body, resultants, mass, axis)) continue;
      problems.Add(JoinPath(IndexPath("bodies", i), "constraints"),
                   std::string("no support balances the loads on the body along ") + "xyz"[axis],
                   "it would accelerate indefinitely: add a constraint, or remove the load or gravity");
    }
  }
}

}  // namespace fascicle::scene_checks
