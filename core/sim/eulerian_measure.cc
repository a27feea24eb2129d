#include "core/sim/eulerian_measure.h"

#include "core/eulerian/elasticity.h"
#include "core/eulerian/fields.h"
#include "core/eulerian/surface.h"
#include "core/sim/series.h"

namespace fascicle {

std::vector<SeriesInfo> EulerianSeriesOf(const Scene& scene) {
  std::vector<SeriesInfo> series = {
      {"energy/elastic", "J", "elastic energy of all bodies, including the potential of active fibres"},
      {"energy/kinetic", "J", "kinetic energy of all bodies"},
      {"solver/step", "s", "length of the last time step"},
      {"solver/iterations", "1", "iterations of MINRES since the previous frame"},
  };
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
                                          const std::vector<Vec3>& reactions, std::int64_t iterations_before,
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
  values.insert(values.end(), of_bodies.begin(), of_bodies.end());
  for (const Probe& probe : scene.output.probes) {
    const std::vector<Vec3>& rest = scene.bodies[probe.body].nodes();
    const Vec3 u = world.bodies[probe.body].surface[probe.node] - rest[probe.node];
    values.insert(values.end(), u.begin(), u.end());
  }
  return values;
}

BodyFrame MeasureEulerianBody(const Scene& scene, const EulerianBody& body, const EulerianState& state,
                              const BodyControls& now, ThreadTeam& team) {
  BodyFrame frame;
  frame.positions = state.surface;
  if (scene.output.fields.empty()) return frame;
  EulerianCells cells;
  UpdateCells(body, state, team, cells);
  for (const OutputField field : scene.output.fields) {
    frame.fields.push_back(FieldOf(field, Method::kEulerian, FieldValuesOf(body, state, now, cells, field)));
  }
  return frame;
}

}  // namespace fascicle
