#include "core/sim/eulerian_measure.h"

#include <cmath>

#include "core/base/von_mises.h"
#include "core/eulerian/interpolation.h"
#include "core/eulerian/surface.h"
#include "core/sim/field_info.h"
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

// What a field is in a cell, component by component.
std::vector<double> CellValue(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                              OutputField field, std::size_t cell) {
  const Vec3 along = cells.F[cell] * FibreOf(body, state, body.grid.CellAt(cell)).direction;
  switch (field) {
    case OutputField::kVolumeRatio:
      return {cells.J[cell]};
    case OutputField::kFibreStretch:
      return {along.norm()};
    case OutputField::kFibreDirection:
      return {along[0], along[1], along[2]};
    default:
      const Mat3 s = StressOf(body, state, cells, cell);
      return {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
  }
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

// From the mean tensor or vector of a vertex to the field's values.
void AddValues(OutputField field, const std::vector<double>& mean, std::vector<double>& values) {
  if (field == OutputField::kVonMisesStress) {
    values.push_back(VonMises(Tensor(mean)));
  } else if (field == OutputField::kPressure) {
    values.push_back(Tensor(mean).trace() / 3);
  } else if (field == OutputField::kFibreDirection) {
    const Vec3 direction = Vec3(mean[0], mean[1], mean[2]).normalized();
    values.insert(values.end(), direction.begin(), direction.end());
  } else {
    values.insert(values.end(), mean.begin(), mean.end());
  }
}

std::size_t ComponentsOf(OutputField field) {
  switch (field) {
    case OutputField::kVolumeRatio:
    case OutputField::kFibreStretch:
      return 1;
    case OutputField::kFibreDirection:
      return 3;
    default:
      return 6;
  }
}

std::vector<double> VelocitiesOf(const EulerianBody& body, const EulerianState& state) {
  std::vector<double> values;
  for (const Vec3& x : state.surface) {
    const Vec3 v = Interpolate(body.grid, {&state.v, &state.known}, x).value_or(Vec3::Zero());
    values.insert(values.end(), v.begin(), v.end());
  }
  return values;
}

std::vector<double> FieldValuesOf(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                                  OutputField field) {
  if (field == OutputField::kVelocity) return VelocitiesOf(body, state);
  std::vector<std::vector<double>> of_cell(cells.inside.size());
  const auto value_of = [&](std::size_t cell) -> const std::vector<double>& {
    if (of_cell[cell].empty()) of_cell[cell] = CellValue(body, state, cells, field, cell);
    return of_cell[cell];
  };
  std::vector<double> values;
  for (const Vec3& x : state.surface) {
    AddValues(field, MeanAround(body.grid, cells, x, ComponentsOf(field), value_of), values);
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
    frame.fields.push_back(FieldOf(field, FieldLocation::kNode, FieldValuesOf(body, state, cells, field)));
  }
  return frame;
}

}  // namespace fascicle
