#include "core/sim/eulerian_measure.h"

#include "core/eulerian/elasticity.h"
#include "core/eulerian/fields.h"
#include "core/eulerian/surface.h"
#include "core/scene/probe_place.h"
#include "core/sim/series.h"

namespace fascicle {
namespace {

AskedField FieldAsked(const Scene& scene, OutputField field) {
  return {field, scene.output.line_of_action.value_or(Vec3::UnitX())};
}

// The current position of a probe on the surface, in the body's grid.
Vec3 PositionOf(const Scene& scene, const Probe& probe, const EulerianState& state) {
  Vec3 x = Vec3::Zero();
  const Shape& shape = scene.bodies[probe.body].shape;
  for (const auto& [node, weight] : WeightsAt(PlaceOf(probe, shape), shape)) x += weight * state.surface[node];
  return x;
}

Vec3 DisplacementOf(const Scene& scene, const Probe& probe, const EulerianBody& solid, const EulerianState& state) {
  Vec3 u = Vec3::Zero();
  const Body& body = scene.bodies[probe.body];
  const GridFrame frame(state.pose, solid.travels);
  for (const auto& [node, weight] : WeightsAt(PlaceOf(probe, body.shape), body.shape)) {
    u += weight * (frame.PointInWorld(state.surface[node]) - body.nodes()[node]);
  }
  return u;
}

}  // namespace

std::vector<SeriesInfo> EulerianSeriesOf(const Scene& scene) {
  std::vector<SeriesInfo> series = {
      {"energy/elastic", "J", "elastic energy of all bodies, including the potential of active fibres"},
      {"energy/kinetic", "J", "kinetic energy of all bodies"},
      {"solver/step", "s", "length of the last time step"},
      {"solver/iterations", "1", "iterations of MINRES since the previous frame"},
  };
  for (const Floor& floor : scene.floors) {
    for (const char* axis : kAxisNames) {
      series.push_back(
          {"floor/" + floor.name + "/" + axis, "N", "force of the floor on all bodies along " + std::string(axis)});
    }
  }
  for (const Body& body : scene.bodies) {
    series.push_back({body.name + "/volume_ratio", "1", "volume within the surface over the rest volume"});
    series.push_back({body.name + "/min_volume_ratio", "1", "smallest volume ratio J of a cell"});
    series.push_back({body.name + "/max_volume_ratio", "1", "largest volume ratio J of a cell"});
    series.push_back({body.name + "/activation", "1", "activation"});
    AddBodySeries(body, series);
  }
  AddProbeSeries(scene, series);
  return series;
}

std::vector<double> MeasureEulerianSeries(const Scene& scene, const std::vector<const EulerianBody*>& bodies,
                                          const EulerianWorldState& world, const Controls& now,
                                          const std::vector<Reaction>& reactions, std::int64_t iterations_before,
                                          ThreadTeam& team) {
  double elastic = 0, kinetic = 0;
  std::vector<double> of_bodies;
  auto of_body = reactions.begin();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const EulerianBody& body = *bodies[b];
    const EulerianState& state = world.bodies[b];
    const BodyControls controls = ControlsOf(scene, b, now);
    EulerianCells cells;
    NodeRoles roles;
    NodalForces forces;
    UpdateCells(body, state, team, cells);
    SetForces(body, state, controls, cells, team, roles, forces);
    elastic += ElasticEnergy(body, state, controls, cells);
    kinetic += KineticEnergy(state, forces);
    of_bodies.insert(of_bodies.end(), {SurfaceVolume(body, state) / body.shape.volume(), cells.smallest_J,
                                       cells.largest_J, controls.activations[0]});
    const std::size_t count = scene.bodies[b].constraints.size();
    AddBodyValues(scene.bodies[b], controls, {of_body, count}, of_bodies);
    of_body += static_cast<std::ptrdiff_t>(count);
  }
  std::vector<double> values = {elastic, kinetic, world.time_step,
                                static_cast<double>(world.iterations - iterations_before)};
  for (const Vec3& force : world.floor_forces) values.insert(values.end(), force.begin(), force.end());
  values.insert(values.end(), of_bodies.begin(), of_bodies.end());
  for (const Probe& probe : scene.output.probes) {
    const std::vector<Vec3>& rest = scene.bodies[probe.body].nodes();
    const EulerianState& state = world.bodies[probe.body];
    const GridFrame frame(state.pose, bodies[probe.body]->travels);
    const Vec3 u = frame.PointInWorld(state.surface[probe.node]) - rest[probe.node];
    values.insert(values.end(), u.begin(), u.end());
  }
  return values;
}

std::vector<SeriesInfo> EulerianLaterSeriesOf(const Scene& scene) {
  std::vector<SeriesInfo> series;
  AddMomentSeries(scene, series);
  AddInnerProbeSeries(scene, series);
  return series;
}

std::vector<double> MeasureEulerianLaterSeries(const Scene& scene, const std::vector<const EulerianBody*>& bodies,
                                               const EulerianWorldState& world, const Controls& now,
                                               const std::vector<Reaction>& reactions, ThreadTeam& team) {
  std::vector<double> values;
  AddMomentValues(scene, reactions, values);
  std::vector<EulerianCells> cells(bodies.size());
  const bool has_fields = !scene.output.probes.empty() && !scene.output.fields.empty();
  for (std::size_t b = 0; has_fields && b < bodies.size(); ++b) {
    UpdateCells(*bodies[b], world.bodies[b], team, cells[b]);
  }
  const ProbeMeasures probes = {
      [&](const Probe& probe) { return DisplacementOf(scene, probe, *bodies[probe.body], world.bodies[probe.body]); },
      [&](const Probe& probe, OutputField field) {
        const auto b = static_cast<std::size_t>(probe.body);
        return FieldValuesAt(*bodies[b], world.bodies[b], ControlsOf(scene, b, now), cells[b], FieldAsked(scene, field),
                             {PositionOf(scene, probe, world.bodies[b])});
      }};
  AddInnerProbeValues(scene, probes, values);
  return values;
}

BodyFrame MeasureEulerianBody(const Scene& scene, const EulerianBody& body, const EulerianState& state,
                              const BodyControls& now, ThreadTeam& team) {
  BodyFrame frame;
  frame.positions = SurfaceInWorld(body, state);
  if (scene.output.fields.empty()) return frame;
  EulerianCells cells;
  UpdateCells(body, state, team, cells);
  for (const OutputField field : scene.output.fields) {
    frame.fields.push_back(FieldOf(field, FieldLocation::kNode,
                                   FieldValuesAt(body, state, now, cells, FieldAsked(scene, field), state.surface)));
  }
  return frame;
}

}  // namespace fascicle
