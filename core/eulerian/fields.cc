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
Mat3 StressOf(const EulerianBody& body, const EulerianState& state, const BodyControls& now, const EulerianCells& cells,
              std::size_t cell) {
  const FibreState fibre = FibreOf(body, state, now, body.grid.CellAt(cell));
  const Mat3 Fe = ElasticGradient(body, state, cells, cell);
  Mat3 sigma = std::visit([&](const auto& law) { return CauchyStress(law, Fe, fibre); }, body.material);
  if (std::isfinite(state.pressure[cell])) sigma -= state.pressure[cell] * Mat3::Identity();
  return sigma;
}

// What means over cells are taken of: the field, or the tensor that it is computed from.
OutputField Averaged(OutputField field) {
  return InfoOf(field).from == FieldSource::kStress ? OutputField::kCauchyStress : field;
}

// That in a cell, component by component.
std::vector<double> CellValue(const EulerianBody& body, const EulerianState& state, const BodyControls& now,
                              const EulerianCells& cells, OutputField field, std::size_t cell) {
  MaterialPoint point;
  if (InfoOf(field).from == FieldSource::kStress) {
    point.sigma = StressOf(body, state, now, cells, cell);
  } else {
    point.F = cells.F[cell];
    point.J = cells.J[cell];
    point.a0 = FibreOf(body, state, now, body.grid.CellAt(cell)).direction;
  }
  std::vector<double> values(InfoOf(Averaged(field)).components);
  PutField(Averaged(field), point, values.data());
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

}  // namespace

std::vector<double> FieldValuesOf(const EulerianBody& body, const EulerianState& state, const BodyControls& now,
                                  const EulerianCells& cells, OutputField field) {
  if (InfoOf(field).from == FieldSource::kMotion) return AtVertices(body, state, field);
  std::vector<std::vector<double>> of_cell(cells.inside.size());
  const auto value_of = [&](std::size_t cell) -> const std::vector<double>& {
    if (of_cell[cell].empty()) of_cell[cell] = CellValue(body, state, now, cells, field, cell);
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

}  // namespace fascicle
