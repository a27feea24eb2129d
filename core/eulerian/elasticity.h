#ifndef FASCICLE_CORE_EULERIAN_ELASTICITY_H_
#define FASCICLE_CORE_EULERIAN_ELASTICITY_H_

#include <Eigen/LU>

#include "core/eulerian/cells.h"

namespace fascicle {

// The fibre and activation at the centre of a cell.
FibreState FibreOf(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                   const GridIndex& cell);

// The elastic part Fe = F Fp^-1 of a solid cell's deformation gradient; F without plasticity.
Mat3 ElasticGradient(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                     std::size_t cell);

// sigma = P Fe^T / det Fe [Pa], without the pressure that preserves volume.
template <class Law>
Mat3 CauchyStress(const Law& law, const Mat3& Fe, const FibreState& fibre) {
  return law.Stress(Fe, fibre) * Fe.transpose() / Fe.determinant();
}

// The law's shear modulus at small strains [Pa].
double ShearModulusOf(const Material& material);

// Elastic energy of the solid, with the potential of active fibres [J].
double ElasticEnergy(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                     const EulerianCells& cells);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_ELASTICITY_H_
