#ifndef FASCICLE_CORE_TET_NEWTON_SYSTEM_H_
#define FASCICLE_CORE_TET_NEWTON_SYSTEM_H_

#include "core/linalg/direct_solver.h"
#include "core/tet/potential.h"

namespace fascicle {

// The linear system of one Newton iteration on IncrementalPotential, with the pressures p of the patches as unknowns of
// their own (a perturbed Lagrangian, [Zienkiewicz, Taylor & Zhu 2013, 11.3]):
//
//   [ A   B^T ] [dx]   [ f                      ]
//   [ B   -C  ] [dp] = [ C (p - U'(theta))      ],    B = V_n dtheta_n/dx,   C = V_n / U''(theta_n)
//
// f the force -dPhi/dx with p in place of U'(theta), A its derivative -df/dx, or that with the tangents of the points
// moved towards positive semidefinite ones. Eliminating dp gives Newton's equation of Phi, but p is free to differ from
// U'(theta) on the way, which spares the stiff volume energy's detours. Prescribed components are eliminated. All
// bits are the same for any number of threads.
class NewtonSystem {
 public:
  // Finds the pattern and has it analyzed; the model must outlive the system.
  explicit NewtonSystem(const TetModel& model);

  // Force f on all nodes (unknown and prescribed) and the merit function's parts at x with pressures p.
  struct Evaluation {
    double smallest_ratio = 1;  // least J of all points
    double rounding = 0;        // of the force of inertia, a small difference of positions times a large number [N]
    bool valid = false;         // J > 0 at all points, theta > 0, all finite
    double energy = 0;          // Phi without patches [J]
    double force_scale = 0;     // norm of all element forces and loads [N]: what f is small against
  };
  Evaluation Evaluate(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> pressure,
                      ThreadTeam& team, NodalVector& force);
  // theta of each patch at the x of the last Evaluate.
  const std::vector<double>& ratios() const { return forces_.ratio; }

  // Assembles and factors at x and p, theta from the last Evaluate at that x. `projection` in [0, 1] is the part of
  // every point's tangent that its projection to a positive semidefinite one replaces: 0 for the exact tangent. False
  // when the matrix can't be factored or its inertia is not that of a minimum.
  bool Factor(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> pressure,
              double projection, ThreadTeam& team);

  // Solves for the step: `force` as from Evaluate; `prescribed` the change of prescribed components, which dx takes
  // over.
  void Solve(const NodalVector& force, const NodalVector& prescribed, std::span<const double> pressure, NodalVector& dx,
             std::vector<double>& dp);

 private:
  // Part of each corner of an element in the theta of a patch: its weights in W.
  struct PatchShare {
    std::int32_t patch;
    std::array<double, 4> weights;
  };

  std::vector<PatchShare> SharesOf(std::size_t tet) const;
  template <class Element>
  std::array<std::int32_t, 3 * Element::kNodes> UnknownsOf(std::size_t tet) const;
  template <class Element>
  void FindPattern();
  template <class Element>
  Evaluation EvaluateElements(const IncrementalPotential& potential, const NodalVector& x, ThreadTeam& team);
  template <class Element>
  void SetElementMatrices(const IncrementalPotential& potential, const NodalVector& x, double projection,
                          ThreadTeam& team);
  template <class Element>
  void AddElementMatrices(bool without_patches);
  template <class Element>
  void MovePrescribed(const NodalVector& prescribed);
  void Smooth(const IncrementalPotential& potential, std::span<const double> pressure);
  void AddFloorMatrices(const NodalVector& x);
  // Change of V_n theta_n of a patch with component j of an element of volume derivatives B.
  template <int kComponents>
  static double VolumeChange(const PatchShare& share, const double* B, int j) {
    double sum = 0;
    for (int c = 0; c < 4; ++c) sum += share.weights[c] * B[kComponents * c + j];
    return sum;
  }

  const TetModel& model_;
  DirectSolver solver_;
  ForceWorkspace forces_;
  double force_floor_ = 0;  // [N]
  std::int32_t unknowns_ = 0;
  std::vector<std::array<std::int32_t, 3>> unknown_of_node_;  // -1: prescribed
  std::vector<std::int32_t> unknown_of_patch_;
  std::vector<PatchShare> shares_;  // of element e: [share_begin_[e], share_begin_[e + 1])
  std::vector<std::size_t> share_begin_;
  // Where each entry of each element goes among the values, -1: nowhere. Lower triangle of A, then a row for each
  // share. With floors, from node_blocks_begin_ on, the lower triangle of each node's own block.
  std::vector<std::int32_t> places_;
  std::size_t node_blocks_begin_ = 0;
  std::vector<std::int32_t> diagonal_;  // place of each unknown's diagonal entry
  std::vector<std::int32_t> rows_, columns_;
  std::vector<double> values_;
  std::vector<double> element_matrices_;
  bool untangling_ = false;         // the matrix last factored
  std::vector<double> acting_;      // W p of each patch [Pa]
  std::vector<double> compliance_;  // C of each patch
  std::vector<double> right_side_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_NEWTON_SYSTEM_H_
