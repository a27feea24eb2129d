#include "server/translate/outputs.h"

#include <algorithm>
#include <cmath>

#include "core/scene/output_fields.h"
#include "core/scene/probe_place.h"
#include "proto/rules/enum_names.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

constexpr double kMaxFrames = 100'000;

bool AnyFibres(const v1::Scene& scene) {
  return std::any_of(scene.bodies().begin(), scene.bodies().end(),
                     [](const v1::Body& body) { return body.has_fibres(); });
}

void CheckFrameCount(const v1::Scene& scene, Problems& problems) {
  const double duration = scene.duration(), interval = scene.output().frame_interval();
  // Invalid numbers are reported by the rules.
  if (!std::isfinite(duration) || !(duration > 0) || !std::isfinite(interval) || !(interval > 0)) return;
  const double frames = std::ceil(duration / interval) + 1;
  if (frames <= kMaxFrames) return;
  problems.Add("output.frame_interval", "gives " + Text(frames) + " frames; at most 100,000 are allowed",
               "at least " + Text(duration / (kMaxFrames - 1)) + " s for this duration");
}

std::vector<OutputField> TranslateFields(const v1::Scene& scene, Method method, Problems& problems) {
  std::vector<OutputField> fields;
  for (int i = 0; i < scene.output().fields_size(); ++i) {
    const std::string path = IndexPath("output.fields", static_cast<std::size_t>(i));
    const auto* value = v1::Field_descriptor()->FindValueByNumber(scene.output().fields(i));
    if (value == nullptr) continue;  // reported with the rules
    if (value->number() == v1::FIELD_UNSPECIFIED) {
      problems.Add(path, "is missing", "such as velocity or von_mises_stress");
      continue;
    }
    const OutputFieldInfo* info = FindOutputField(NameOf(*value));
    if (info == nullptr) {
      problems.Add(path, "is a field that this server does not compute", "omit it");
      continue;
    }
    CheckOutputField(info->field, fields, {method, AnyFibres(scene), !scene.output().line_of_action().empty()}, path,
                     problems);
    fields.push_back(info->field);
  }
  return fields;
}

// About the size of what a frame has at the mid-edge nodes of quadratic elements. A closed mesh without holes has as
// many edges as nodes, tetrahedra and half of its boundary's triangles together, less one.
std::int64_t HigherOrderBytes(const Output& output, const TetMesh& mesh) {
  const std::size_t edges = mesh.nodes.size() + mesh.tetrahedra.size();
  std::size_t bytes = edges * sizeof(Vec3);
  for (const OutputField field : output.fields) {
    if (IsNodal(InfoOf(field))) bytes += (mesh.nodes.size() + edges) * sizeof(Vec3);
  }
  return static_cast<std::int64_t>(bytes);
}

void CheckFrameSize(const Output& output, const std::vector<Body>& bodies, bool quadratic, std::int64_t max_bytes,
                    Problems& problems) {
  std::int64_t bytes = 0;
  for (const Body& body : bodies) {
    bytes += static_cast<std::int64_t>(body.nodes().size() * sizeof(Vec3));
    if (quadratic) bytes += HigherOrderBytes(output, body.tet().mesh);
    for (const OutputField field : output.fields) {
      const OutputFieldInfo& info = InfoOf(field);
      bytes += static_cast<std::int64_t>(info.components * sizeof(double) * PlacesOf(info, body.shape));
    }
  }
  if (bytes <= max_bytes) return;
  problems.Add("output.fields", "each frame would have " + std::to_string(bytes) + " bytes",
               "at most " + std::to_string(max_bytes) + "; use fewer fields or coarser meshes");
}

// A point farther away from the body than its size has a wrong unit or belongs to another body.
void CheckDistance(double distance, const Body& body, const std::string& path, Problems& problems) {
  if (distance <= Diagonal(body.nodes())) return;
  problems.Add(path, "is " + Text(distance) + " m away from the body, farther than the size of the body",
               "probe points are in the body's own unit");
}

// A remark if a probe is recorded at another place than asked for.
void AddProbeNote(const LocatedProbe& located, const std::string& path, Body& body) {
  if (!(located.outside > 1e-9 * Diagonal(body.nodes()))) return;
  body.notes.push_back(path + ": is outside of the body's elements; the nearest " +
                       (located.probe.inside ? "point of the surface" : "node") + ", " + Text(located.outside) +
                       " m away, is recorded");
}

std::vector<Probe> TranslateProbes(const v1::Scene& scene, std::vector<Body>& bodies, const Names& body_names,
                                   Problems& problems) {
  Names names("probe");
  std::vector<Probe> probes;
  for (int i = 0; i < scene.output().probes_size(); ++i) {
    const v1::Probe& probe = scene.output().probes(i);
    const std::string path = IndexPath("output.probes", static_cast<std::size_t>(i));
    names.Add(probe.name(), JoinPath(path, "name"), problems);
    const auto index = body_names.Find(probe.body(), JoinPath(path, "body"), problems);
    if (!index || bodies[*index].nodes().empty() || !ObeysRules(probe)) continue;
    Body& body = bodies[*index];
    const Vec3 point = ToVec3(probe.point()) * MetresIn(scene.bodies(static_cast<int>(*index)).unit());
    const LocatedProbe located = LocateProbe(probe.name(), static_cast<std::int32_t>(*index), body.shape, point);
    CheckDistance(located.outside, body, JoinPath(path, "point"), problems);
    AddProbeNote(located, JoinPath(path, "point"), body);
    probes.push_back(located.probe);
  }
  return probes;
}

std::vector<SupportMoment> TranslateMoments(const v1::Scene& scene, const std::vector<Body>& bodies,
                                            const Names& body_names, Problems& problems) {
  std::vector<SupportMoment> moments;
  for (int i = 0; i < scene.output().moments_size(); ++i) {
    const v1::SupportMoment& wire = scene.output().moments(i);
    const std::string path = IndexPath("output.moments", static_cast<std::size_t>(i));
    SupportMoment moment;
    if (!wire.axis().empty()) moment.axis = ToDirection(wire.axis(), JoinPath(path, "axis"), problems);
    const auto body = body_names.Find(wire.body(), JoinPath(path, "body"), problems);
    if (!body) continue;
    Names regions("region");
    Problems reported;  // malformed names are reported with the body
    for (const Region& region : bodies[*body].regions) regions.Add(region.name, "", reported);
    const auto region = regions.Find(wire.region(), JoinPath(path, "region"), problems);
    if (!region) continue;
    moment.body = static_cast<std::int32_t>(*body);
    moment.region = static_cast<std::int32_t>(*region);
    if (!wire.point().empty()) {
      moment.point = ToVec3(wire.point()) * MetresIn(scene.bodies(static_cast<int>(*body)).unit());
    }
    moments.push_back(moment);
  }
  return moments;
}

}  // namespace

Output TranslateOutput(const v1::Scene& scene, Method method, ElementOrder order, std::vector<Body>& bodies,
                       const Names& body_names, std::int64_t max_frame_bytes, Problems& problems) {
  Output output;
  if (!scene.has_output()) {
    problems.Add("output", "is missing", "give at least frame_interval [s]");
    return output;
  }
  CheckFrameCount(scene, problems);
  output.frame_interval = scene.output().frame_interval();
  output.fields = TranslateFields(scene, method, problems);
  output.probes = TranslateProbes(scene, bodies, body_names, problems);
  output.moments = TranslateMoments(scene, bodies, body_names, problems);
  if (!scene.output().line_of_action().empty()) {
    output.line_of_action = ToDirection(scene.output().line_of_action(), "output.line_of_action", problems);
  }
  if (scene.output().has_settle_speed()) output.settle_speed = scene.output().settle_speed();
  const bool quadratic = method == Method::kTet && order == ElementOrder::kQuadratic;
  CheckFrameSize(output, bodies, quadratic, max_frame_bytes, problems);
  return output;
}

}  // namespace fascicle::server
