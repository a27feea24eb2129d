#ifndef FASCICLE_CORE_TET_STABLE_STEP_H_
#define FASCICLE_CORE_TET_STABLE_STEP_H_

#include <vector>

#include "core/linalg/lanczos.h"
#include "core/tet/forces.h"

namespace fascicle {

// The stiffness K = -df/dx of all elements, patches and floors at one state. No matrix is kept: each product goes
// through the laws again, with less memory to read than matrices would be.
class TetStiffness {
 public:
  // At positions x [m] and what drives the fibres; both, with what the drive points to, must stay until the last
  // product. Updates the workspace's patches, which must be left as they are as long.
  void Set(const TetModel& model, const FibreDrive& drive, const NodalVector& x, ThreadTeam& team,
           ForceWorkspace& workspace);

  // product = K p.
  void Apply(const TetModel& model, const NodalVector& p, ThreadTeam& team, ForceWorkspace& workspace,
             NodalVector& product);

 private:
  // The change of the patches' pressures under p.
  void ApplyToPatches(const TetModel& model, const NodalVector& p, ThreadTeam& team, ForceWorkspace& workspace);

  FibreDrive drive_;
  const NodalVector* x_ = nullptr;
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
