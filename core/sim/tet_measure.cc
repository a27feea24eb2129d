#include "core/sim/tet_measure.h"

#include "core/sim/series.h"
#include "core/tet/contact.h"
#include "core/tet/diagnostics.h"
#include "core/tet/floor_contact.h"

namespace fascicle {
namespace {

bool IsQuasiStatic(const TetModel& model) { return model.scene().tet.stepping == Stepping::kQuasiStatic; }

std::size_t NodeOf(const TetModel& model, const Probe& probe) {
  return model.bodies()[probe.body].node_begin + static_cast<std::size_t>(probe.node);
}

// Of each rigid body: the force of bodies on it, its moment, and depths.
void AddContactSeries(const TetModel& model, std::vector<SeriesInfo>& series) {
  for (const RigidBody& rigid : model.scene().rigid_bodies) {
    const std::string name = "contact/" + rigid.name + "/", force = "force of all bodies on `" + rigid.name + "`";
    for (const char* axis : kAxisNames) series.push_back({name + "force/" + axis, "N", force + " along " + axis});
    for (const char* axis : kAxisNames) {
      series.push_back({name + "moment/" + axis, "N m",
                        "moment of that force about the origin of its frame, along " + std::string(axis)});
    }
    series.push_back({name + "depth", "m", "deepest penetration"});
    series.push_back({name + "relative_depth", "1",
                      "largest penetration relative to the allowed one, a tenth of an element's edge"});
  }
}

void AddContactValues(const TetModel& model, const TetState& state, const Controls& now, ThreadTeam& team,
                      std::vector<double>& values) {
  if (model.contact().empty()) return;
  const std::vector<Touch> touches = TouchesOf(model, state, now, team);
  for (const ContactSum& sum : SumsOfRigidBodies(PlacementsOf(model, now), touches)) {
    values.insert(values.end(), sum.force.begin(), sum.force.end());
    values.insert(values.end(), sum.moment.begin(), sum.moment.end());
    values.insert(values.end(), {sum.depth, sum.excess});
  }
}

}  // namespace

std::vector<SeriesInfo> SeriesOf(const TetModel& model) {
  std::vector<SeriesInfo> series = {
      {"energy/elastic", "J", "elastic energy of all bodies, including the potential of active fibres"},
      {"energy/kinetic", "J", "kinetic energy of all bodies"},
      {"energy/load_work", "J", "work of loads and gravity so far, by the trapezoidal rule"},
      {"energy/dissipated", "J", "energy dissipated by damping so far"},
      {"solver/step", "s", "length of the last time step"},
      {"solver/iterations", "1", "iterations of linear solves, or of Newton's method, since the previous frame"},
  };
  if (!model.scene().floors.empty() || !model.contact().empty()) {
    series.push_back({"energy/contact", "J", "energy stored in contacts"});
  }
  for (const Floor& floor : model.scene().floors) {
    for (const char* axis : kAxisNames) {
      series.push_back(
          {"floor/" + floor.name + "/" + axis, "N", "force of the floor on all bodies along " + std::string(axis)});
    }
  }
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const Body& body = *model.bodies()[b].source;
    series.push_back({body.name + "/volume_ratio", "1", "current volume over rest volume"});
    series.push_back({body.name + "/min_volume_ratio", "1", "smallest volume ratio J of an element"});
    series.push_back({body.name + "/activation", "1", "activation"});
    AddBodySeries(body, series);
  }
  AddProbeSeries(model.scene(), series);
  return series;
}

std::vector<SeriesInfo> LaterSeriesOf(const TetModel& model) {
  std::vector<SeriesInfo> series = {{"energy/external_work", "J", "work of loads, gravity and supports so far"}};
  if (IsQuasiStatic(model)) series.push_back({"energy/activation_work", "J", "work of the fibres' activation so far"});
  AddContactSeries(model, series);
  AddMomentSeries(model.scene(), series);
  AddInnerProbeSeries(model.scene(), series);
  return series;
}

std::vector<double> MeasureLaterSeries(const TetModel& model, const TetState& state, const Controls& now,
                                       const std::vector<Reaction>& reactions, ThreadTeam& team) {
  std::vector<double> values = {state.external_work};
  if (IsQuasiStatic(model)) values.push_back(state.activation_work);
  AddContactValues(model, state, now, team, values);
  AddMomentValues(model.scene(), reactions, values);
  const ProbeMeasures probes = {
      [&](const Probe& probe) { return DisplacementAt(model, probe, state); },
      [&](const Probe& probe, OutputField field) { return FieldValuesAt(model, probe, field, state, now, team); }};
  AddInnerProbeValues(model.scene(), probes, values);
  return values;
}

std::vector<double> MeasureSeries(const TetModel& model, const TetState& state, const Controls& now,
                                  const std::vector<Reaction>& reactions, std::int64_t iterations_before,
                                  ThreadTeam& team) {
  double elastic = 0;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    elastic += ElasticEnergy(model, b, FibreDrive{now.activations}, state.positions, team);
  }
  std::vector<double> values = {elastic,         KineticEnergy(model, state.velocities, team),
                                state.load_work, state.dissipated,
                                state.time_step, static_cast<double>(state.iterations - iterations_before)};
  if (!model.scene().floors.empty() || !model.contact().empty()) {
    const double of_rigid_bodies = model.contact().empty() ? 0 : ContactEnergy(TouchesOf(model, state, now, team));
    values.push_back(FloorEnergy(model, state.positions) + of_rigid_bodies);
  }
  for (const Vec3& force : FloorForces(model, state.positions)) {
    values.insert(values.end(), force.begin(), force.end());
  }
  auto of_body = reactions.begin();
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const VolumeRatios ratios = VolumeRatiosOf(model, b, state.positions);
    values.insert(values.end(), {ratios.total, ratios.smallest, now.activations[model.bodies()[b].activation]});
    const std::size_t count = model.bodies()[b].source->constraints.size();
    AddBodyValues(*model.bodies()[b].source, ControlsOf(model.scene(), b, now), {of_body, count}, values);
    of_body += static_cast<std::ptrdiff_t>(count);
  }
  for (const Probe& probe : model.scene().output.probes) {
    const std::size_t n = NodeOf(model, probe);
    const Vec3 displacement = state.positions[n] - model.rest_positions()[n];
    values.insert(values.end(), displacement.begin(), displacement.end());
  }
  return values;
}

std::vector<HigherOrderNodes> HigherOrderNodesOf(const TetModel& model) {
  std::vector<HigherOrderNodes> bodies;
  if (model.order() != ElementOrder::kQuadratic) return bodies;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const TetBody& body = model.bodies()[b];
    const TetMesh& mesh = body.source->tet().mesh;
    const MeshEdges& edges = model.edges(b);
    const auto first = static_cast<std::int32_t>(mesh.nodes.size());
    HigherOrderNodes& nodes = bodies.emplace_back();
    nodes.positions.assign(model.rest_positions().begin() + static_cast<std::ptrdiff_t>(body.mesh_node_end),
                           model.rest_positions().begin() + static_cast<std::ptrdiff_t>(body.node_end));
    nodes.of_elements.reserve(6 * mesh.tetrahedra.size());
    for (const std::array<std::int32_t, 6>& of_tetrahedron : edges.of_tetrahedra) {
      for (const std::int32_t edge : of_tetrahedron) nodes.of_elements.push_back(first + edge);
    }
    const std::vector<Triangle> boundary = BoundaryTriangles(mesh);
    for (const Region& region : body.source->regions) {
      std::vector<std::int32_t>& of_region = nodes.of_regions.emplace_back();
      const std::vector<bool> within = EdgesWithin(mesh, edges, boundary, region.nodes);
      for (std::size_t edge = 0; edge < within.size(); ++edge) {
        if (within[edge]) of_region.push_back(first + static_cast<std::int32_t>(edge));
      }
    }
  }
  return bodies;
}

std::vector<BodyFrame> MeasureBodies(const TetModel& model, const TetState& state, const StateControls& controls,
                                     ThreadTeam& team) {
  std::vector<BodyFrame> frames(model.bodies().size());
  for (std::size_t b = 0; b < frames.size(); ++b) {
    const TetBody& body = model.bodies()[b];
    frames[b].positions.assign(state.positions.begin() + static_cast<std::ptrdiff_t>(body.node_begin),
                               state.positions.begin() + static_cast<std::ptrdiff_t>(body.mesh_node_end));
    frames[b].higher_order_positions.assign(state.positions.begin() + static_cast<std::ptrdiff_t>(body.mesh_node_end),
                                            state.positions.begin() + static_cast<std::ptrdiff_t>(body.node_end));
    for (const OutputField field : model.scene().output.fields) {
      NodeFieldValues values;
      if (IsNodal(InfoOf(field))) {
        values = NodeFieldOf(model, b, field, state, controls, team);
      } else {
        values.on_mesh = FieldValuesOf(model, b, field, state, controls, team);
      }
      const FieldLocation location = LocationOf(InfoOf(field), body.source->shape);
      frames[b].fields.push_back(FieldOf(field, location, std::move(values.on_mesh)));
      frames[b].fields.back().all_values = std::move(values.all);
    }
  }
  return frames;
}

}  // namespace fascicle
