#include "server/translate/outputs.h"

#include <algorithm>
#include <cmath>

#include "server/translate/values.h"

namespace fascicle::server {
namespace {

constexpr double kMaxFrames = 100'000;

OutputField ToOutputField(v1::Field field) {
  switch (field) {
    case v1::FIELD_CAUCHY_STRESS:
      return OutputField::kCauchyStress;
    case v1::FIELD_VON_MISES_STRESS:
      return OutputField::kVonMisesStress;
    case v1::FIELD_PRESSURE:
      return OutputField::kPressure;
    case v1::FIELD_VOLUME_RATIO:
      return OutputField::kVolumeRatio;
    case v1::FIELD_FIBRE_STRETCH:
      return OutputField::kFibreStretch;
    case v1::FIELD_FIBRE_DIRECTION:
      return OutputField::kFibreDirection;
    default:
      return OutputField::kVelocity;
  }
}

bool IsFibreField(OutputField field) {
  return field == OutputField::kFibreStretch || field == OutputField::kFibreDirection;
}

bool AnyFibres(const v1::Scene& scene) {
  return std::any_of(scene.bodies().begin(), scene.bodies().end(),
                     [](const v1::Body& body) { return body.has_fibres(); });
}

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

// Quadratic elements where steps are solved for, unless the scene says otherwise: there they are the more accurate ones
// for the time they take.
ElementOrder ToElement(v1::Element element, Stepping stepping) {
  if (element == v1::ELEMENT_LINEAR) return ElementOrder::kLinear;
  if (element == v1::ELEMENT_QUADRATIC) return ElementOrder::kQuadratic;
  const bool is_explicit = stepping == Stepping::kExplicit || stepping == Stepping::kMixed;
  return is_explicit ? ElementOrder::kLinear : ElementOrder::kQuadratic;
}

void CheckFrameCount(const v1::Scene& scene, Problems& problems) {
  const double duration = scene.duration(), interval = scene.output().frame_interval();
  // Wrong numbers are reported with the rules.
  if (!std::isfinite(duration) || !(duration > 0) || !std::isfinite(interval) || !(interval > 0)) return;
  const double frames = std::ceil(duration / interval) + 1;
  if (frames <= kMaxFrames) return;
  problems.Add("output.frame_interval", "gives " + Text(frames) + " frames; at most 100,000 are kept",
               "at least " + Text(duration / (kMaxFrames - 1)) + " s for this duration");
}

std::vector<OutputField> TranslateFields(const v1::Scene& scene, Problems& problems) {
  std::vector<OutputField> fields;
  for (int i = 0; i < scene.output().fields_size(); ++i) {
    const std::string path = IndexPath("output.fields", static_cast<std::size_t>(i));
    const v1::Field wire = scene.output().fields(i);
    if (wire == v1::FIELD_UNSPECIFIED) problems.Add(path, "is missing", "such as velocity or von_mises_stress");
    if (wire == v1::FIELD_UNSPECIFIED || !v1::Field_IsValid(wire)) continue;
    const OutputField field = ToOutputField(wire);
    if (std::find(fields.begin(), fields.end(), field) != fields.end()) {
      problems.Add(path, "is listed twice", "list each field once");
      continue;
    }
    if (IsFibreField(field) && !AnyFibres(scene)) {
      problems.Add(path, "no body has fibres", "give a body `fibres`, or leave the field out");
    }
    fields.push_back(field);
  }
  return fields;
}

std::int64_t FieldBytes(OutputField field, const Body& body) {
  const auto nodes = static_cast<std::int64_t>(body.nodes().size());
  // Fields of a surface are at its nodes.
  const auto elements = body.surface.nodes.empty() ? static_cast<std::int64_t>(body.elements()) : nodes;
  constexpr std::int64_t kDouble = sizeof(double);
  switch (field) {
    case OutputField::kVelocity:
      return 3 * kDouble * nodes;
    case OutputField::kCauchyStress:
      return 6 * kDouble * elements;
    case OutputField::kFibreDirection:
      return 3 * kDouble * elements;
    default:
      return kDouble * elements;
  }
}

void CheckFrameSize(const Output& output, const std::vector<Body>& bodies, std::int64_t max_bytes, Problems& problems) {
  std::int64_t bytes = 0;
  for (const Body& body : bodies) {
    bytes += static_cast<std::int64_t>(body.nodes().size() * sizeof(Vec3));
    for (const OutputField field : output.fields) bytes += FieldBytes(field, body);
  }
  if (bytes <= max_bytes) return;
  problems.Add("output.fields", "each frame would have " + std::to_string(bytes) + " bytes",
               "at most " + std::to_string(max_bytes) + "; keep fewer fields or take coarser meshes");
}

// The node nearest to `point` [m]. A point further away than the body is large has a wrong unit or a wrong body.
std::int32_t NearestNode(const std::vector<Vec3>& nodes, const Vec3& point, const std::string& path,
                         Problems& problems) {
  std::int32_t nearest = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if ((nodes[i] - point).squaredNorm() < (nodes[static_cast<std::size_t>(nearest)] - point).squaredNorm()) {
      nearest = static_cast<std::int32_t>(i);
    }
  }
  const double distance = (nodes[static_cast<std::size_t>(nearest)] - point).norm();
  if (!(distance <= Diagonal(nodes))) {
    problems.Add(path, "is " + Text(distance) + " m away from the body, further than the body is large",
                 "probe points are in the body's own unit");
  }
  return nearest;
}

std::vector<Probe> TranslateProbes(const v1::Scene& scene, const std::vector<Body>& bodies, const Names& body_names,
                                   Problems& problems) {
  Names names("probe");
  std::vector<Probe> probes;
  for (int i = 0; i < scene.output().probes_size(); ++i) {
    const v1::Probe& probe = scene.output().probes(i);
    const std::string path = IndexPath("output.probes", static_cast<std::size_t>(i));
    names.Add(probe.name(), JoinPath(path, "name"), problems);
    const auto body = body_names.Find(probe.body(), JoinPath(path, "body"), problems);
    if (!body || bodies[*body].nodes().empty() || !ObeysRules(probe)) continue;
    const Vec3 point = ToVec3(probe.point()) * MetresIn(scene.bodies(static_cast<int>(*body)).unit());
    probes.push_back({probe.name(), static_cast<std::int32_t>(*body),
                      NearestNode(bodies[*body].nodes(), point, JoinPath(path, "point"), problems)});
  }
  return probes;
}

}  // namespace

Output TranslateOutput(const v1::Scene& scene, const std::vector<Body>& bodies, const Names& body_names,
                       std::int64_t max_frame_bytes, Problems& problems) {
  Output output;
  if (!scene.has_output()) {
    problems.Add("output", "is missing", "give at least frame_interval [s]");
    return output;
  }
  CheckFrameCount(scene, problems);
  output.frame_interval = scene.output().frame_interval();
  output.fields = TranslateFields(scene, problems);
  output.probes = TranslateProbes(scene, bodies, body_names, problems);
  if (scene.output().has_settle_speed()) output.settle_speed = scene.output().settle_speed();
  CheckFrameSize(output, bodies, max_frame_bytes, problems);
  return output;
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

namespace {

// Where bodies may move; nothing where it is not given, or wrong.
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
                 "exchange lowest and highest");
    return std::nullopt;
  }
  return room;
}

}  // namespace

EulerianMethod TranslateEulerianMethod(const v1::Scene& scene, Problems& problems) {
  EulerianMethod method;
  if (!scene.has_eulerian()) return method;
  const v1::EulerianMethod& wire = scene.eulerian();
  method.room = TranslateRoom(wire, problems);
  if (!ObeysRules(wire)) return method;
  method.cell_size = wire.cell_size();
  method.margin = wire.margin();
  if (wire.volume() == v1::VOLUME_TREATMENT_DIVERGENCE_FREE) method.volume = VolumeTreatment::kDivergenceFree;
  if (wire.volume() == v1::VOLUME_TREATMENT_NONE) method.volume = VolumeTreatment::kNone;
  method.stabilization = wire.stabilization();
  method.implicit_elasticity = wire.elastic_force() == v1::ELASTIC_FORCE_IMPLICIT;
  if (wire.has_time_step()) method.time_step = wire.time_step();
  method.maccormack = wire.advection() == v1::ADVECTION_MACCORMACK;
  return method;
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
  return method;
}

}  // namespace fascicle::server
