#include <algorithm>

#include "core/scene/checks.h"
#include "core/scene/nodal_forces.h"

namespace fascicle::scene_checks {
namespace {

void CheckLoad(const Body& body, const Load& load, const std::string& path, Problems& problems) {
  if (load.region < 0 || load.region >= static_cast<std::int32_t>(body.regions.size())) {
    problems.Add(JoinPath(path, "region"), "there is no such region");
    return;
  }
  const Region& region = body.regions[load.region];
  const LoadedPart part = LoadedPartOf(load);
  if (region.nodes.empty()) {
    problems.Add(JoinPath(path, "region"), "region `" + region.name + "` has no nodes");
  } else if (part == LoadedPart::kElements && region.elements.empty()) {
    problems.Add(JoinPath(path, "region"), "the load needs elements, but region `" + region.name + "` contains none",
                 "choose a region by plane, box or sphere, which take elements with their centroid inside, by side "
                 "with a depth, or by a tag of elements");
  } else if (part == LoadedPart::kFaces && region.triangles.empty() && region.quads.empty()) {
    problems.Add(JoinPath(path, "region"),
                 "the load needs surface, but region `" + region.name + "` contains no complete face of the surface",
                 "choose a larger region, one by side or by tag, or a nodal_force");
  }
}

void CheckSprings(const Load& load, const std::string& path, Problems& problems) {
  const auto* springs = std::get_if<Springs>(&load.kind);
  if (springs == nullptr && !std::holds_alternative<LineSpring>(load.kind)) return;
  if (springs != nullptr && (springs->stiffness.minCoeff() < 0 || springs->stiffness.isZero())) {
    problems.Add(JoinPath(path, "springs.stiffness"), "needs values of at least 0 N/m, and one above",
                 "0 for the axes without springs");
  }
  if (*std::min_element(load.scale.values.begin(), load.scale.values.end()) < 0) {
    problems.Add(JoinPath(path, "scale"), "a spring of negative stiffness pushes nodes away without end",
                 "values of at least 0");
  }
}

bool IsImplicit(const TetMethod& method) {
  return method.stepping != Stepping::kExplicit && method.stepping != Stepping::kMixed;
}

void CheckLineSpring(const Scene& scene, const Body& body, const Load& load, const std::string& load_path,
                     Problems& problems) {
  // Every node of both regions depends on every other.
  constexpr std::size_t kMostNodes = 500;
  const auto* spring = std::get_if<LineSpring>(&load.kind);
  if (spring == nullptr) return;
  const std::string path = JoinPath(load_path, "line_spring");
  if (!(spring->stiffness > 0)) problems.Add(JoinPath(path, "stiffness"), "must be above 0 N/m");
  if (spring->body < 0 || spring->body >= static_cast<std::int32_t>(scene.bodies.size()) || spring->region < 0 ||
      spring->region >= static_cast<std::int32_t>(scene.bodies[spring->body].regions.size())) {
    problems.Add(JoinPath(path, "region"), "there is no such region");
    return;
  }
  const Body& other = scene.bodies[spring->body];
  if (other.regions[spring->region].nodes.empty()) {
    problems.Add(JoinPath(path, "region"), "region `" + other.regions[spring->region].name + "` has no nodes");
    return;
  }
  if (load.region < 0 || load.region >= static_cast<std::int32_t>(body.regions.size())) return;
  const Region& own = body.regions[load.region];
  const std::size_t nodes = own.nodes.size() + other.regions[spring->region].nodes.size();
  if (IsImplicit(scene.tet) && nodes > kMostNodes) {
    problems.Add(path, "its ends have " + std::to_string(nodes) + " nodes, which an implicit step couples",
                 "choose smaller regions, of 500 nodes together, or explicit stepping");
  }
  if (&other == &body && spring->region == load.region) {
    problems.Add(JoinPath(path, "region"), "both ends are the same region", "name another region");
  }
}

// What the scene's method can't do.
void CheckMethod(Method method, const Load& load, const std::string& path, Problems& problems) {
  const char* spring = std::holds_alternative<Springs>(load.kind)      ? "springs"
                       : std::holds_alternative<LineSpring>(load.kind) ? "line_spring"
                                                                       : nullptr;
  if (method == Method::kVoxel && spring != nullptr) {
    problems.Add(JoinPath(path, spring), "the voxel method has no springs", "use the tet method");
  }
  if (method != Method::kEulerian) return;
  const char* kind = std::holds_alternative<Pressure>(load.kind)    ? "pressure"
                     : std::holds_alternative<BodyForce>(load.kind) ? "body_force"
                                                                    : spring;
  if (kind == nullptr) return;
  problems.Add(JoinPath(path, kind), "the eulerian method has tractions, nodal forces and gravity only",
               "use one of these, or the tet method");
}

}  // namespace

void CheckLoads(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    for (std::size_t k = 0; k < body.loads.size(); ++k) {
      const std::string path = JoinPath(IndexPath("bodies", i), IndexPath("loads", k));
      CheckLoad(body, body.loads[k], path, problems);
      CheckSprings(body.loads[k], path, problems);
      CheckLineSpring(scene, body, body.loads[k], path, problems);
      CheckMethod(scene.method, body.loads[k], path, problems);
    }
  }
}

}  // namespace fascicle::scene_checks
