#include "core/eulerian/fields.h"

#include <cmath>

#include "core/eulerian/elasticity.h"
#include "core/eulerian/interpolation.h"
#include "core/scene/output_fields.h"

namespace fascicle {
namespace {

// Cells farther from a vertex than this do not contribute to its values [cells].
constexpr double kFieldReach = 2;

// Stress of a cell, with the pressure that kept its volume [Pa].
Mat3 StressOf(const EulerianBody& body, const EulerianState& state, const FibreState& fibre, const EulerianCells& cells,
              std::size_t cell) {
  const Mat3 Fe = ElasticGradient(body, state, cells, cell);
  Mat3 sigma = std::visit([&](const auto& law) { return CauchyStress(law, Fe, fibre); }, body.material);
  if (std::isfinite(state.pressure[cell])) sigma -= state.pressure[cell] * Mat3::Identity();
  return sigma;
}

// What means over cells are taken of: the field, or the tensor that it is computed from.
OutputField Averaged(OutputField field) {
  return InfoOf(field).from == FieldSource::kStress ? OutputField::kCauchyStress : InfoOf(field).mean_of;
}

// That in a cell, component by component.
std::vector<double> CellValue(const EulerianBody& body, const EulerianState& state, const BodyControls& now,
                              const EulerianCells& cells, const AskedField& asked, std::size_t cell) {
  const FieldSource from = InfoOf(asked.field).from;
  FibreState fibre = FibreOf(body, state, now, body.grid.CellAt(cell));
  MaterialPoint point;
  const GridFrame frame(state.pose, body.travels);
  point.F = frame.GradientInWorld(cells.F[cell]);
  point.J = cells.J[cell];
  point.a0 = fibre.direction;
  point.line_of_action = asked.line_of_action;
  if (from == FieldSource::kStress || from == FieldSource::kFibreStress) {
    point.sigma = frame.TensorInWorld(StressOf(body, state, fibre, cells, cell));
  } else if (from == FieldSource::kEnergy) {
    const Mat3 Fe = ElasticGradient(body, state, cells, cell);
    point.energy_density = std::visit([&](const auto& law) { return law.Energy(Fe, fibre); }, body.material);
  }
  if (from == FieldSource::kFibreStress) {
    fibre.activation = 0;
    point.passive_sigma = frame.TensorInWorld(StressOf(body, state, fibre, cells, cell));
  }
  std::vector<double> values(InfoOf(Averaged(asked.field)).components);
  PutField(Averaged(asked.field), point, values.data());
  return values;
}

// The mean over solid cells around a point, weighted by solid part and distance; zero if there are none.
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
    const double weight = cells.inside[cell] * (kFieldReach - (grid.CellCentre(at) - x).norm() / grid.spacing);
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

// From the mean at a point to the field's values there.
std::vector<double> AtPoint(OutputField field, const std::vector<double>& mean) {
  const OutputFieldInfo& info = InfoOf(field);
  std::vector<double> values(info.components);
  if (info.from == FieldSource::kStress) {
    MaterialPoint point;
    point.sigma = Tensor(mean);
    PutField(field, point, values.data());
  } else {
    PutFromMean(field, mean.data(), values.data());
  }
  return values;
}

std::vector<double> VelocitiesAt(const EulerianBody& body, const EulerianState& state,
                                 const std::vector<Vec3>& points) {
  const GridFrame frame(state.pose, body.travels);
  std::vector<double> values;
  for (const Vec3& x : points) {
    const Vec3 v = frame.VectorInWorld(Interpolate(body.grid, {&state.v, &state.known}, x).value_or(Vec3::Zero()));
    values.insert(values.end(), v.begin(), v.end());
  }
  return values;
}

}  // namespace

std::vector<double> FieldValuesAt(const EulerianBody& body, const EulerianState& state, const BodyControls& now,
                                  const EulerianCells& cells, const AskedField& asked,
                                  const std::vector<Vec3>& points) {
  if (InfoOf(asked.field).from == FieldSource::kMotion) return VelocitiesAt(body, state, points);
  std::vector<std::vector<double>> of_cell(cells.inside.size());
  const auto value_of = [&](std::size_t cell) -> const std::vector<double>& {
    if (of_cell[cell].empty()) of_cell[cell] = CellValue(body, state, now, cells, asked, cell);
    return of_cell[cell];
  };
  std::vector<double> values;
  for (const Vec3& x : points) {
    const std::vector<double> mean =
        MeanAround(body.grid, cells, x, InfoOf(Averaged(asked.field)).components, value_of);
    const std::vector<double> at_point = AtPoint(asked.field, mean);
    values.insert(values.end(), at_point.begin(), at_point.end());
  }
  return values;
}

}  // namespace fascicle
