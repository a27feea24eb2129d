#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

bool IsLinear(const Material& material) { return std::holds_alternative<LinearElastic>(material); }
bool IsCorotated(const Material& material) { return std::holds_alternative<CorotatedLinear>(material); }

void CheckLaws(const Body& body, const std::string& path, Problems& problems) {
  std::vector<Material> laws = body.voxel().materials.more;
  laws.push_back(body.material);
  if (!std::all_of(laws.begin(), laws.end(), [](const Material& m) { return IsLinear(m) || IsCorotated(m); })) {
    problems.Add(JoinPath(path, "material"), "voxels must be linear elastic, but a material is not",
                 "linear_elastic for small deflections, corotated_linear for large rotations; other laws need the tet "
                 "method");
  } else if (std::any_of(laws.begin(), laws.end(), IsLinear) && std::any_of(laws.begin(), laws.end(), IsCorotated)) {
    problems.Add(JoinPath(path, "region_materials"), "mix linear_elastic and corotated_linear",
                 "use one of them for the whole body");
  }
}

void CheckLeftOut(const Body& body, const std::string& path, Problems& problems) {
  const auto is_zero = [](const Curve& curve) {
    return std::all_of(curve.values.begin(), curve.values.end(), [](double value) { return value == 0; });
  };
  if (!is_zero(body.activation) || body.excitation) {
    problems.Add(JoinPath(path, body.excitation ? "excitation" : "activation"), "voxels don't contract",
                 "apply the muscle's force as a load on a region, or use the tet method");
  }
  if (body.damping.stiffness_proportional != 0 || body.damping.viscosity != 0) {
    problems.Add(JoinPath(path, "damping"), "the voxel method has mass-proportional damping only",
                 "use mass_proportional only");
  }
}

// Whether every axis of the image is parallel to a world axis, so that world components are grid components.
bool IsAlongAxes(const Mat3& direction) { return (direction.cwiseAbs().array() > 1 - 1e-9).count() == 3; }

void CheckAxes(const Body& body, const std::string& path, Problems& problems) {
  if (IsAlongAxes(body.voxel().mesh.grid.direction)) return;
  for (std::size_t k = 0; k < body.constraints.size(); ++k) {
    const auto& axes = body.constraints[k].axes;
    if (axes[0] == axes[1] && axes[1] == axes[2]) continue;
    problems.Add(JoinPath(path, JoinPath(IndexPath("constraints", k), "axes")),
                 "single axes can't be prescribed if the image is not aligned with the world axes",
                 "prescribe all three, or resample the image along x, y and z");
  }
}

}  // namespace

void CheckVoxel(const Scene& scene, Problems& problems) {
  if (scene.method != Method::kVoxel) return;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!std::holds_alternative<VoxelShape>(scene.bodies[i].shape)) continue;
    const std::string path = IndexPath("bodies", i);
    CheckLaws(scene.bodies[i], path, problems);
    RefuseViscoelasticity(scene.bodies[i], "voxel", path, problems);
    CheckLeftOut(scene.bodies[i], path, problems);
    CheckAxes(scene.bodies[i], path, problems);
  }
  if (!scene.floors.empty()) {
    problems.Add("floors", "the voxel method does not support floors", "omit them, or use the tet method");
  }
  RefuseRigidBodies(scene, "voxel", problems);
  if (scene.voxel.stepping == VoxelStepping::kDynamic && scene.output.frame_interval > 0) {
    const double frames = scene.duration / scene.output.frame_interval;
    if (std::abs(frames - std::round(frames)) > 1e-9 * frames) {
      problems.Add("duration",
                   "is not a multiple of the frame interval, but the voxel method's steps are all equally long",
                   "choose the duration as a multiple of output.frame_interval");
    }
  }
  if (scene.voxel.stepping == VoxelStepping::kStatic && scene.output.settle_speed) {
    problems.Add("output.settle_speed", "static solutions have no speed", "omit it, or use dynamic stepping");
  }
}

}  // namespace fascicle::scene_checks
