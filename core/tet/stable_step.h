#ifndef FASCICLE_CORE_TET_STABLE_STEP_H_
#define FASCICLE_CORE_TET_STABLE_STEP_H_

#include <array>
#include <span>
#include <vector>

#include "core/linalg/lanczos.h"
#include "core/tet/forces.h"

namespace fascicle {

// The stiffness K = -df/dx of all elements at one state, kept as the tangents dP/dF of the laws.
class TetStiffness {
 public:
  // Tangents at positions x [m] and activation. O(elements); allocates in the first call only.
  void Set(const TetModel& model, std::span<const double> activation, const NodalVector& x, ThreadTeam& team);

  // product = K p: the change of P in every element, as nodal forces with the sign turned.
  void Apply(const TetModel& model, const NodalVector& p, ThreadTeam& team, CornerForceArray& corners,
             NodalVector& product) const;

 private:
  // The upper triangle of a symmetric 9x9 matrix, row by row. In float: a step length needs no more, and this is by
  // far the largest array of a simulation.
  using PackedTangent = std::array<float, 45>;
  std::vector<PackedTangent> tangents_;
};

struct StableStepWorkspace {
  TetStiffness stiffness;
  NodalVector inverse_root_mass;
  LanczosWorkspace lanczos;
};

// The largest stable step of the central difference method at a state [s]:
//   dt = (2/omega) (sqrt(1 + xi^2) - xi)     [Belytschko, Liu, Moran & Elkhodary 2014, 6.2.8]
// with omega^2 the largest eigenvalue of M^-1 K over the free components, fibres and activation counted (at a kink of a
// fibre curve the stiffer side), and
// 2 xi omega the largest eigenvalue of M^-1 (-D), D the viscous operator, when damping is explicit (else xi = 0). Both
// are estimated from above by Lanczos. Infinite without stiffness and damping. Not finite when the state is not.
double LargestStableStep(const TetModel& model, std::span<const double> activation, const NodalVector& x,
                         bool explicit_damping, ThreadTeam& team, CornerForceArray& corners,
                         StableStepWorkspace& workspace);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_STABLE_STEP_H_
