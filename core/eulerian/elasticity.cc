#include "core/eulerian/elasticity.h"

#include <cmath>

#include "core/eulerian/plasticity.h"

namespace fascicle {

FibreState FibreOf(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                   const GridIndex& cell) {
  if (!body.fibres) return {};
  return body.FibreAt(CentreValue(body.grid, state.X, cell), controls);
}

Mat3 ElasticGradient(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                     std::size_t cell) {
  if (!body.plasticity) return cells.F[cell];
  const Vec3 X = CentreValue(body.grid, state.X, body.grid.CellAt(cell));
  return cells.F[cell] * PlasticInverse(PlasticGrid(body), state.plastic, X);
}

double ShearModulusOf(const Material& material) {
  return std::visit([](const auto& law) { return law.ShearModulus(); }, material);
}

double ElasticEnergy(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                     const EulerianCells& cells) {
  return std::visit(
      [&](const auto& law) {
        double sum = 0;
        for (const std::size_t c : cells.solid) {
          const FibreState fibre = FibreOf(body, state, controls, body.grid.CellAt(c));
          const Mat3 Fe = ElasticGradient(body, state, cells, c);
          sum += law.Energy(Fe, fibre) * cells.inside[c] / cells.J[c];
        }
        return sum * std::pow(body.grid.spacing, 3);
      },
      body.material);
}

}  // namespace fascicle
