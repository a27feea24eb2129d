#ifndef FASCICLE_TESTS_SUPPORT_SOLIDS_H_
#define FASCICLE_TESTS_SUPPORT_SOLIDS_H_

#include <array>
#include <cmath>
#include <map>

#include "core/eulerian/surface.h"
#include "core/eulerian/world.h"

namespace fascicle::testing {

// The surface of a cube around the origin with n x n squares per side; `round`: of the ball in it.
inline TriangleMesh CubeSurface(double side, int n, bool round = false) {
  TriangleMesh surface;
  std::map<std::array<int, 3>, std::int32_t> numbers;
  const auto node = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = numbers.try_emplace(at, static_cast<std::int32_t>(surface.nodes.size()));
    if (!is_new) return found->second;
    Vec3 p = 2.0 / n * Vec3(at[0], at[1], at[2]) - Vec3::Ones();
    if (round) {
      const Vec3 s = p.cwiseAbs2();
      for (int d = 0; d < 3; ++d) {
        const double a = s[(d + 1) % 3], b = s[(d + 2) % 3];
        p[d] *= std::sqrt(1 - a / 2 - b / 2 + a * b / 3);
      }
    }
    surface.nodes.push_back(side / 2 * p);
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool far : {false, true}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int a, int b) {
            std::array<int, 3> at = {};
            at[axis] = far ? n : 0;
            at[(axis + 1) % 3] = i + a;
            at[(axis + 2) % 3] = j + b;
            return node(at);
          };
          const std::int32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (far) {
            surface.triangles.insert(surface.triangles.end(), {{a, b, c}, {a, c, d}});
          } else {
            surface.triangles.insert(surface.triangles.end(), {{a, c, b}, {a, d, c}});
          }
        }
      }
    }
  }
  return surface;
}

inline constexpr double kSide = 0.1;  // [m]

// A neo-Hookean body in a box of 2.2 sides of n^3 cells around it; `squares` per side of its surface.
inline EulerianBody MakeSolid(int n, bool round, double young, double poisson, ThreadTeam& team, int squares = 12) {
  EulerianGrid grid;
  grid.cells = {n, n, n};
  grid.spacing = 2.2 * kSide / n;
  grid.origin = Vec3::Constant(-1.1 * kSide);
  const std::array<double, 2> values = {young, poisson};
  EulerianBody body{grid, SolidShape(CubeSurface(kSide, squares, round), grid.spacing / 2, team), NeoHookean(values)};
  body.density = 1000;
  body.volume = VolumeTreatment::kNone;
  return body;
}

// Fixes the material above a height.
inline void HoldAbove(double z, EulerianBody& body) {
  Region above;
  above.selectors = {PlaneSelector{Vec3(0, 0, z), Vec3::UnitZ()}};
  body.supports = {RegionPoints(above, {}, 0)};
}

// A force per volume towards the plane x = 0, within a width proportional to the distance.
inline PlaneForceField TowardsMiddle(double force_density, double width) {
  PlaneForceField field;
  field.force_density = force_density;
  field.width = width;
  return field;
}

// Solids that are stepped together. Loads and force fields act at scale 1 and supports rest, until a test sets
// `controls` for the steps to come.
class SolidRun {
 public:
  using Field = std::function<Vec3(const Vec3&)>;

  // scene: with contacts and floors only.
  SolidRun(const std::vector<const EulerianBody*>& bodies, ThreadTeam& team, Profile* profile = nullptr,
           const Scene& scene = {})
      : scene_(SceneOf(bodies, scene)), world(scene_, bodies, team, profile), state(world.InitialState()) {
    for (const EulerianBody* body : bodies) {
      controls.activations.push_back(0);
      controls.load_scales.insert(controls.load_scales.end(), body->loads.size(), 1.0);
      controls.motions.resize(controls.motions.size() + body->supports.size());
    }
    controls.force_field_scales.assign(bodies[0]->force_fields.size(), 1.0);
  }
  SolidRun(const EulerianBody& body, ThreadTeam& team, Profile* profile = nullptr)
      : SolidRun(std::vector{&body}, team, profile) {}

  // Starts a solid with X(x) = map(x) and v(x) = velocity(x); null: x, 0.
  void Begin(std::size_t number, const Field& map, const Field& velocity = nullptr) {
    state.bodies[number] = world.body(number).InitialState(map, velocity);
  }

  // The step that would be made, or why there is none.
  StepProposal Propose(double end) {
    controls.time = state.time;
    return world.ProposeStep(state, controls, end);
  }
  // Makes a step towards `end` [s].
  EulerianReport Step(double end) {
    StepProposal step = Propose(end);
    if (step.problem != StepProblem::kNone) return {step.problem, std::move(step.bad)};
    Controls next = controls;
    next.time = step.time;
    return world.Step(state, controls, next, step.dt);
  }

  // Of the first solid.
  EulerianState& solid() { return state.bodies[0]; }
  const NodalForces& forces() const { return world.body(0).forces(); }

 private:
  // Of the scene nothing is looked at but how many controls each body has, the contacts and the floors.
  static Scene SceneOf(const std::vector<const EulerianBody*>& bodies, Scene scene) {
    for (const EulerianBody* solid : bodies) {
      Body& body = scene.bodies.emplace_back();
      body.loads.resize(solid->loads.size());
      body.constraints.resize(solid->supports.size());
    }
    return scene;
  }
  Scene scene_;

 public:
  EulerianWorld world;
  EulerianWorldState state;
  Controls controls;
};

// The volume inside of the surface, relative to that at rest.
inline double VolumeRatio(const EulerianBody& body, const EulerianState& state) {
  return SurfaceVolume(body, state) / body.shape.volume();
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_SOLIDS_H_
