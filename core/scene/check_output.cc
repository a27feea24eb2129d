#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "core/scene/checks.h"
#include "core/scene/output_fields.h"

namespace fascicle::scene_checks {
namespace {

constexpr double kMaxFrames = 100000;

bool HasFibres(const Body& body) {
  struct Fibres {
    bool operator()(const TetShape& shape) const { return !shape.fibres.empty(); }
    bool operator()(const VoxelShape&) const { return false; }
    bool operator()(const SurfaceShape& shape) const { return !shape.fibres.empty(); }
  };
  return std::visit(Fibres{}, body.shape);
}

bool IsSupport(const Body& body, std::int32_t region) {
  return std::any_of(body.constraints.begin(), body.constraints.end(),
                     [region](const Constraint& constraint) { return constraint.region == region; });
}

void CheckMoments(const Scene& scene, Problems& problems) {
  std::set<std::pair<std::int32_t, std::int32_t>> before;
  for (std::size_t i = 0; i < scene.output.moments.size(); ++i) {
    const SupportMoment& moment = scene.output.moments[i];
    const std::string path = JoinPath("output", IndexPath("moments", i));
    if (moment.body < 0 || moment.body >= static_cast<std::int32_t>(scene.bodies.size())) {
      problems.Add(JoinPath(path, "body"), "there is no such body");
    } else if (!IsSupport(scene.bodies[moment.body], moment.region)) {
      problems.Add(JoinPath(path, "region"), "is not the region of a support",
                   "give the region of one of the body's constraints");
    } else if (!before.emplace(moment.body, moment.region).second) {
      problems.Add(JoinPath(path, "region"), "has a point already", "give one entry for each support");
    }
  }
}

}  // namespace

void CheckOutput(const Scene& scene, Problems& problems) {
  const Output& output = scene.output;
  if (!(scene.duration > 0)) problems.Add("duration", "the simulated time must be positive");
  if (!(output.frame_interval > 0)) {
    problems.Add("output.frame_interval", "the time between frames must be positive");
  } else if (scene.duration / output.frame_interval > kMaxFrames) {
    problems.Add("output.frame_interval", "this gives more than 100,000 frames", "use a longer interval");
  }
  const FieldMeans means = {scene.method, std::any_of(scene.bodies.begin(), scene.bodies.end(), HasFibres),
                            output.line_of_action.has_value()};
  for (std::size_t i = 0; i < output.fields.size(); ++i) {
    CheckOutputField(output.fields[i], std::span(output.fields).first(i), means,
                     JoinPath("output", IndexPath("fields", i)), problems);
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < output.probes.size(); ++i) {
    const Probe& probe = output.probes[i];
    const std::string path = JoinPath("output", IndexPath("probes", i));
    if (!names.insert(probe.name).second) {
      problems.Add(JoinPath(path, "name"), "another probe is called `" + probe.name + "`");
    }
    if (probe.body < 0 || probe.body >= static_cast<std::int32_t>(scene.bodies.size())) {
      problems.Add(JoinPath(path, "body"), "there is no such body");
    } else if (probe.node < 0 || probe.node >= static_cast<std::int64_t>(scene.bodies[probe.body].nodes().size())) {
      problems.Add(JoinPath(path, "point"), "there is no such node");
    }
  }
  CheckMoments(scene, problems);
}

}  // namespace fascicle::scene_checks
