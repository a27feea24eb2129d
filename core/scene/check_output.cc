#include <algorithm>
#include <set>
#include <span>

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

}  // namespace

void CheckOutput(const Scene& scene, Problems& problems) {
  const Output& output = scene.output;
  if (!(scene.duration > 0)) problems.Add("duration", "the simulated time must be positive");
  if (!(output.frame_interval > 0)) {
    problems.Add("output.frame_interval", "the time between frames must be positive");
  } else if (scene.duration / output.frame_interval > kMaxFrames) {
    problems.Add("output.frame_interval", "this gives more than 100,000 frames", "use a longer interval");
  }
  const bool fibres = std::any_of(scene.bodies.begin(), scene.bodies.end(), HasFibres);
  for (std::size_t i = 0; i < output.fields.size(); ++i) {
    CheckOutputField(output.fields[i], std::span(output.fields).first(i), scene.method, fibres,
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
}

}  // namespace fascicle::scene_checks
