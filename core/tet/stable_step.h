#ifndef FASCICLE_CORE_TET_STABLE_STEP_H_
#define FASCICLE_CORE_TET_STABLE_STEP_H_

#include <vector>

#include "core/linalg/lanczos.h"
#include "core/tet/forces.h"

namespace fascicle {

// The stiffness K = -df/dx of all elements, patches and floors at one state, without a matrix: each product evaluates
// the laws' tangents again, which reads less memory than stored matrices would.
class TetStiffness {
 public:
  // Sets positions x [m] and the fibre drive. Both, and everything the drive points to, must stay valid until the last
  // product. Updates the workspace's patches, which must stay unchanged as long.
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
  std::vector<double> pressure_change_;  // for each patch
};

struct StableStepWorkspace {
  TetStiffness stiffness;
  NodalVector inverse_root_mass;
  LanczosWorkspace lanczos;
};

// The largest stable step of the central difference method at a state [s]:
//   dt = (2/omega) (sqrt(1 + xi^2) - xi)     [Belytschko, Liu, Moran & Elkhodary 2014, 6.2.8]
// where omega^2 is the largest eigenvalue of M^-1 K over the free components, including fibres and activation (the
// stiffer side at a kink of a fibre curve), and 2 xi omega is the largest eigenvalue of M^-1 (-D), with the viscous
// operator D, if damping is explicit (otherwise xi = 0). Both are upper estimates by Lanczos. Infinite without
// stiffness and damping. Not finite if the state is not.
double LargestStableStep(const TetModel& model, const FibreDrive& drive, const NodalVector& x, bool explicit_damping,
                         ThreadTeam& team, ForceWorkspace& forces, StableStepWorkspace& workspace);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_STABLE_STEP_H_
