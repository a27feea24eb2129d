#include "core/sim/eulerian_measure.h"

#include <cmath>

#include "core/eulerian/interpolation.h"
#include "core/eulerian/surface.h"
#include "core/sim/series.h"

namespace fascicle {
namespace {

// Cells further than that from a vertex have no part in its values [cells].
constexpr double kReach = 2;

// Stress of a cell, with the pressure that kept its volume [Pa].
Mat3 StressOf(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells, std::size_t cell) {
  const FibreState fibre = FibreOf(body, state, body.grid.CellAt(cell));
  Mat3 sigma = CauchyStress(body, ElasticGradient(body, state, cells, cell), fibre);
  if (std::isfinite(state.pressure[cell])) sigma -= state.pressure[cell] * Mat3::Identity();
  return sigma;
}

// What means over cells are taken of: the field, or the tensor that it is computed from.
OutputField Averaged(OutputField field) {
  return InfoOf(field).from == FieldSource::kStress ? OutputField::kCauchyStress : field;
}

// That in a cell, component by component.
std::vector<double> CellValue(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                              OutputField field, std::size_t cell) {
  MaterialPoint point;
  if (InfoOf(field).from == FieldSource::kStress) {
    point.sigma = StressOf(body, state, cells, cell);
  } else {
    point.F = cells.F[cell];
    point.J = cells.J[cell];
    point.a0 = FibreOf(body, state, body.grid.CellAt(cell)).direction;
  }
  std::vector<double> values(InfoOf(Averaged(field)).components);
  PutField(Averaged(field), point, values.data());
  return values;
}

// The mean over solid cells around a point, each by its solid part and its nearness; zero where there is none.
template <class ValueOf>
std::vector<double> MeanAround(const EulerianGrid& grid, const EulerianCells& cells, const Vec3& x,
                               std::size_t components, const ValueOf& value_of) {
  std::vector<double> sum(components, 0);
  double total = 0;
  const GridIndex centre = grid.PlaceOf(x).cell;
  for (int n = 0; n < 125; ++n) {
    const GridIndex at = {centre[0] - 2 + n % 5, centre[1] - 2 + n / 5 % 5, centre[2] - 2 + n / 25};
    if (!grid.HasCell(at)) continue;
    const std::size_t cell = grid.CellNumber(at);
    const double weight = cells.inside[cell] * (kReach - (grid.CellCentre(at) - x).norm() / grid.spacing);
    if (!(weight > 0)) continue;
    const std::vector<double>& value = value_of(cell);
    for (std::size_t k = 0; k < components; ++k) sum[k] += weight * value[k];
    total += weight;
  }
  for (double& value : sum) value = total > 0 ? value / total : 0;
  return sum;
}

Mat3 Tensor(const std::vector<double>& s) {
  return (Mat3() << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]).finished();
}

// From the mean at a vertex to the field's values there.
std::vector<double> AtVertex(OutputField field, const std::vector<double>& mean) {
  const OutputFieldInfo& info = InfoOf(field);
  std::vector<double> values = mean;
  if (info.from == FieldSource::kStress) {
    MaterialPoint point;
    point.sigma = Tensor(mean);
    values.resize(info.components);
    PutField(field, point, values.data());
  }
  if (info.is_direction) NormalizeDirections(values);
  return values;
}

std::vector<double> AtVertices(const EulerianBody& body, const EulerianState& state, OutputField field) {
  const std::size_t components = InfoOf(field).components;
  std::vector<double> values(components * state.surface.size());
  for (std::size_t v = 0; v < state.surface.size(); ++v) {
    MaterialPoint point;
    point.v = Interpolate(body.grid, {&state.v, &state.known}, state.surface[v]).value_or(Vec3::Zero());
    PutField(field, point, &values[components * v]);
  }
  return values;
}

std::vector<double> FieldValuesOf(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                                  OutputField field) {
  if (InfoOf(field).from == FieldSource::kMotion) return AtVertices(body, state, field);
  std::vector<std::vector<double>> of_cell(cells.inside.size());
  const auto value_of = [&](std::size_t cell) -> const std::vector<double>& {
    if (of_cell[cell].empty()) of_cell[cell] = CellValue(body, state, cells, field, cell);
    return of_cell[cell];
  };
  std::vector<double> values;
  for (const Vec3& x : state.surface) {
    const std::vector<double> mean = MeanAround(body.grid, cells, x, InfoOf(Averaged(field)).components, value_of);
    const std::vector<double> at_vertex = AtVertex(field, mean);
    values.insert(values.end(), at_vertex.begin(), at_vertex.end());
  }
  return values;
}

}  // namespace

std::vector<SeriesInfo> EulerianSeriesOf(const Scene& scene) {
  std::vector<SeriesInfo> series = {
      {"energy/elastic", "J", "elastic energy of all bodies, with the potential of active fibres"},
      {"energy/kinetic", "J", "kinetic energy of all bodies"},
      {"solver/step", "s", "length of the last time step"},
      {"solver/iterations", "1", "iterations of MINRES since the frame before"},
  };
  for (const Body& body : scene.bodies) {
    series.push_back({body.name + "/volume_ratio", "1", "volume within the surface over that at rest"});
    series.push_back({body.name + "/min_volume_ratio", "1", "smallest volume ratio J of a cell"});
    series.push_back({body.name + "/max_volume_ratio", "1", "largest volume ratio J of a cell"});
    series.push_back({body.name + "/activation", "1", "activation"});
    AddBodySeries(body, series);
  }
  AddProbeSeries(scene, series);
  return series;
}

std::vector<double> MeasureEulerianSeries(const Scene& scene, const std::vector<std::unique_ptr<EulerianBody>>& bodies,
                                          const std::vector<EulerianState>& states,
                                          const std::vector<EulerianSolver>& solvers, double time_step,
                                          std::int64_t iterations, ThreadTeam& team) {
  double elastic = 0, kinetic = 0;
  std::vector<double> of_bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const EulerianBody& body = *bodies[b];
    const EulerianState& state = states[b];
    EulerianCells cells;
    NodalForces nodes;
    UpdateCells(body, state, team, cells);
    SetForces(body, state, cells, team, nodes);
    elastic += ElasticEnergy(body, state, cells);
    kinetic += KineticEnergy(state, nodes);
    of_bodies.insert(of_bodies.end(), {SurfaceVolume(body, state) / body.shape.volume(), cells.smallest_J,
                                       cells.largest_J, scene.bodies[b].activation.At(state.time)});
    std::vector<Vec3> forces = solvers[b].reactions();
    forces.resize(scene.bodies[b].constraints.size(), Vec3::Zero());
    AddBodyValues(scene.bodies[b], state.time, forces, of_bodies);
  }
  std::vector<double> values = {elastic, kinetic, time_step, static_cast<double>(iterations)};
  values.insert(values.end(), of_bodies.begin(), of_bodies.end());
  for (const Probe& probe : scene.output.probes) {
    const std::vector<Vec3>& rest = scene.bodies[probe.body].nodes();
    const Vec3 u = states[probe.body].surface[probe.node] - rest[probe.node];
    values.insert(values.end(), u.begin(), u.end());
  }
  return values;
}

BodyFrame MeasureEulerianBody(const Scene& scene, const EulerianBody& body, const EulerianState& state,
                              ThreadTeam& team) {
  BodyFrame frame;
  frame.positions = state.surface;
  if (scene.output.fields.empty()) return frame;
  EulerianCells cells;
  UpdateCells(body, state, team, cells);
  for (const OutputField field : scene.output.fields) {
    frame.fields.push_back(FieldOf(field, Method::kEulerian, FieldValuesOf(body, state, cells, field)));
  }
  return frame;
}

}  // namespace fascicle
