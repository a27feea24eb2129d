#ifndef FASCICLE_CORE_TET_BRANCHES_H_
#define FASCICLE_CORE_TET_BRANCHES_H_

#include <vector>

#include "core/tet/forces.h"

// Maxwell branches of viscoelastic materials at the quadrature points (see core/materials/prony.h).
//
// Over a step the stress of a point is
//
//   S = S_e + factor S_p(C) + B,  factor = sum of gains,  B = sum decay H - factor S_p(C before)
//
// with factor and B constant. So a viscoelastic step has a potential, too: W + factor W_p + B : (C - I)/2.
//
// State: for each point of a viscoelastic block, symmetric tensors as xx, yy, zz, xy, yz, zx of its elements side by
// side: S_p and the Green strain at the end of the last step, then H of each term. [Pa; 1; Pa]
namespace fascicle {

// What the branches add to the law: see above. Empty: nothing.
struct BranchDrive {
  std::vector<double> factor;  // for each chunk [1]
  std::vector<double> stress;  // B, six numbers for each element of each point of a viscoelastic block [Pa]
};

// The state of branches that have been relaxed at positions x for a long time; points that are not defined there count
// as undeformed. Empty if the model is elastic.
std::vector<double> RelaxedBranches(const TetModel& model, const NodalVector& x, ThreadTeam& team,
                                    ForceWorkspace& workspace);

// The drive of a step of length h >= 0 [s] from a state. h = 0 gives the response to a sudden deformation.
void SetStepDrive(const TetModel& model, const std::vector<double>& state, double h, ThreadTeam& team,
                  BranchDrive& drive);
// The drive at a state: factor 0, B = sum H.
void SetStateDrive(const TetModel& model, const std::vector<double>& state, ThreadTeam& team, BranchDrive& drive);

// B at point q of an element [Pa]; zero if it is elastic.
Mat3 BranchStressAt(const TetModel& model, const BranchDrive& drive, std::size_t tet, int q);
// The mean of B over the points of an element [Pa].
Mat3 MeanBranchStress(const TetModel& model, const BranchDrive& drive, std::size_t tet);
// The chunk of an element.
const Chunk& ChunkOf(const TetModel& model, std::size_t tet);

// The state at positions x after a step of length h > 0 from `state`. Returns the work done on the branches during the
// step, by the trapezoidal rule [J].
double AdvanceBranches(const TetModel& model, const std::vector<double>& state, const NodalVector& x, double h,
                       ThreadTeam& team, ForceWorkspace& workspace, std::vector<double>& next);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_BRANCHES_H_
