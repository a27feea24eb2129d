#include "server/translate/methods.h"

#include <cmath>
#include <utility>

#include "server/translate/values.h"

namespace fascicle::server {
namespace {

Stepping ToStepping(v1::Stepping stepping) {
  switch (stepping) {
    case v1::STEPPING_MIXED:
      return Stepping::kMixed;
    case v1::STEPPING_BACKWARD_EULER:
      return Stepping::kBackwardEuler;
    case v1::STEPPING_NEWMARK:
      return Stepping::kNewmark;
    case v1::STEPPING_BDF2:
      return Stepping::kBdf2;
    case v1::STEPPING_QUASI_STATIC:
      return Stepping::kQuasiStatic;
    default:
      return Stepping::kExplicit;
  }
}

// Unless the scene says otherwise, implicit steppings use quadratic elements, which are more accurate for the same
// time.
ElementOrder ToElement(v1::Element element, Stepping stepping) {
  if (element == v1::ELEMENT_LINEAR) return ElementOrder::kLinear;
  if (element == v1::ELEMENT_QUADRATIC) return ElementOrder::kQuadratic;
  if (element == v1::ELEMENT_HEXAHEDRAL) return ElementOrder::kHexahedral;
  if (element == v1::ELEMENT_HEXAHEDRAL_QUADRATIC) return ElementOrder::kHexahedralQuadratic;
  const bool is_explicit = stepping == Stepping::kExplicit || stepping == Stepping::kMixed;
  return is_explicit ? ElementOrder::kLinear : ElementOrder::kQuadratic;
}

// The extent of the grid; nothing if it is not given, or invalid.
std::optional<Bounds> TranslateRoom(const v1::EulerianMethod& method, Problems& problems) {
  if (method.lowest().empty() && method.highest().empty()) return std::nullopt;
  for (const auto& [name, size] : {std::pair("lowest", method.lowest_size()), {"highest", method.highest_size()}}) {
    if (size == 0) problems.Add(JoinPath("eulerian", name), "is missing beside the other corner", "give both, or none");
  }
  if (method.lowest_size() != 3 || method.highest_size() != 3) return std::nullopt;
  const Bounds room = {ToVec3(method.lowest()), ToVec3(method.highest())};
  for (int axis = 0; axis < 3; ++axis) {
    if (room.lowest[axis] < room.highest[axis]) continue;
    problems.Add(JoinPath("eulerian", IndexPath("lowest", static_cast<std::size_t>(axis))),
                 "is " + Text(room.lowest[axis]) + ", not below the highest, " + Text(room.highest[axis]),
                 "swap lowest and highest");
    return std::nullopt;
  }
  return room;
}

}  // namespace

int RefinementsOf(const v1::Scene& scene) {
  constexpr int kMost = 3;
  return scene.refinements() >= 0 && scene.refinements() <= kMost ? scene.refinements() : 0;
}

TetMethod TranslateTetMethod(const v1::Scene& scene) {
  TetMethod method;
  if (!scene.has_tet() || !ObeysRules(scene.tet())) return method;
  method.stepping = ToStepping(scene.tet().stepping());
  method.element = ToElement(scene.tet().element(), method.stepping);
  if (scene.tet().volume() == v1::VOLUME_FORM_ELEMENT) method.volume = VolumeForm::kElement;
  if (scene.tet().linear_solver() == v1::LINEAR_SOLVER_DIRECT) method.linear_solver = LinearSolver::kDirect;
  if (scene.tet().linear_solver() == v1::LINEAR_SOLVER_ITERATIVE) method.linear_solver = LinearSolver::kIterative;
  if (scene.tet().precision() == v1::PRECISION_SINGLE) method.precision = Precision::kSingle;
  method.newton_tolerance = scene.tet().newton_tolerance();
  if (scene.tet().has_time_step()) method.time_step = scene.tet().time_step();
  method.safety = scene.tet().safety();
  method.solver_tolerance = scene.tet().solver_tolerance();
  method.spectral_radius = scene.tet().spectral_radius();
  if (scene.tet().has_step_error()) method.step_error = scene.tet().step_error();
  return method;
}

VoxelMethod TranslateVoxelMethod(const v1::Scene& scene) {
  VoxelMethod method;
  if (!scene.has_voxel() || !ObeysRules(scene.voxel())) return method;
  if (scene.voxel().stepping() == v1::VOXEL_STEPPING_DYNAMIC) method.stepping = VoxelStepping::kDynamic;
  method.mean_dilatation = scene.voxel().dilatation() == v1::DILATATION_MEAN;
  if (scene.voxel().has_time_step()) method.time_step = scene.voxel().time_step();
  method.tolerance = scene.voxel().tolerance();
  method.start_loaded = scene.voxel().start_loaded();
  return method;
}

EulerianMethod TranslateEulerianMethod(const v1::Scene& scene, Problems& problems) {
  EulerianMethod method;
  if (!scene.has_eulerian()) return method;
  const v1::EulerianMethod& wire = scene.eulerian();
  method.room = TranslateRoom(wire, problems);
  if (!ObeysRules(wire)) return method;
  // A refined grid has half the cells' size.
  method.cell_size = std::ldexp(wire.cell_size(), -RefinementsOf(scene));
  method.margin = wire.margin();
  if (wire.volume() == v1::VOLUME_TREATMENT_DIVERGENCE_FREE) method.volume = VolumeTreatment::kDivergenceFree;
  if (wire.volume() == v1::VOLUME_TREATMENT_NONE) method.volume = VolumeTreatment::kNone;
  method.stabilization = wire.stabilization();
  method.implicit_elasticity = wire.elastic_force() == v1::ELASTIC_FORCE_IMPLICIT;
  if (wire.has_time_step()) method.time_step = wire.time_step();
  method.maccormack = wire.advection() == v1::ADVECTION_MACCORMACK;
  method.rigid_grids = wire.grid_motion() == v1::GRID_MOTION_RIGID;
  return method;
}

}  // namespace fascicle::server
