#ifndef FASCICLE_CORE_TET_STABLE_STEP_H_
#define FASCICLE_CORE_TET_STABLE_STEP_H_

#include <array>
#include <span>
#include <vector>

#include "core/linalg/lanczos.h"
#include "core/tet/forces.h"

namespace fascicle {

// The stiffness K = -df/dx of all elements, patches and floors at one state, kept as the tangents dP/dF of the laws.
class TetStiffness {
 public:
  // Tangents at positions x [m]. O(elements); allocates in the first call only.
  void Set(const TetModel& model, const FibreDrive& drive, const NodalVector& x, ThreadTeam& team,
           ForceWorkspace& workspace);

  // product = K p: the change of P at every point, as nodal forces with the sign turned.
  void Apply(const TetModel& model, const NodalVector& p, ThreadTeam& team, ForceWorkspace& workspace,
             NodalVector& product);

 private:
  template <class Element>
  void SetElements(const TetModel& model, const FibreDrive& drive, const NodalVector& x, ThreadTeam& team,
                   const ForceWorkspace& workspace);
  template <class Element>
  void ApplyElements(const TetModel& model, const NodalVector& p, ThreadTeam& team, ForceWorkspace& workspace) const;
  // The change of the patches' pressures under p.
  template <class Element>
  void ApplyToPatches(const TetModel& model, const NodalVector& p, ThreadTeam& team, ForceWorkspace& workspace);

  // The upper triangle of a symmetric 9x9 matrix, row by row. In float: a step length needs no more, and this is by
  // far the largest array of a simulation.
  using PackedTangent = std::array<float, 45>;
  std::vector<PackedTangent> tangents_;  // of each point
  std::vector<Mat3> cofactors_;          // of each point, where there are patches
  std::vector<double> slopes_;           // U''(theta) of each patch [Pa]
  std::vector<double> pressure_change_;  // of each patch
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
double LargestStableStep(const TetModel& model, const FibreDrive& drive, const NodalVector& x, bool explicit_damping,
                         ThreadTeam& team, ForceWorkspace& forces, StableStepWorkspace& workspace);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_STABLE_STEP_H_
