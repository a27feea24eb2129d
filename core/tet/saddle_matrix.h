#ifndef FASCICLE_CORE_TET_SADDLE_MATRIX_H_
#define FASCICLE_CORE_TET_SADDLE_MATRIX_H_

#include <optional>
#include <stop_token>

#include "core/linalg/block_matrix.h"
#include "core/tet/element_matrices.h"

namespace fascicle {

// The matrix of one Newton iteration, with the pressures p of the patches as separate unknowns (a perturbed Lagrangian,
// [Zienkiewicz, Taylor & Zhu 2013, 11.3]):
//
//   [ A   B^T ] [dx]
//   [ B   -C  ] [dp],      A = -df/dx at fixed p,   B = V_n dtheta_n/dx,   C = V_n / U''(theta_n)
//
// over all nodes, including prescribed components until IsolatePrescribed replaces these by the identity.
struct SaddleMatrix {
  BlockPattern pattern;         // nodes by nodes
  BlockValues A;                // [N/m]
  BlockPattern volume_pattern;  // patches by nodes
  TransposedPattern volume_of_node;
  NodalVector B;          // [m^2]
  std::vector<double> C;  // diagonal [m^3/Pa]
  FreeComponents free;
  // Lower bound, from inertia alone, for the least eigenvalue of A preconditioned by its diagonal blocks; 0 if there is
  // none.
  double least_eigenvalue = 0;

  std::size_t nodes() const { return pattern.rows(); }
  std::size_t patches() const { return C.size(); }

  // force = A dx + B^T dp, volume = B dx - C dp.
  void Multiply(const NodalVector& dx, std::span<const double> dp, ThreadTeam& team, NodalVector& force,
                std::span<double> volume) const;
  // B dx of patch p.
  double VolumeOf(std::size_t p, const NodalVector& dx) const {
    double sum = 0;
    for (std::int32_t k = volume_pattern.begin[p]; k < volume_pattern.begin[p + 1]; ++k) {
      sum += B[k].dot(dx[volume_pattern.column[k]]);
    }
    return sum;
  }
  // force += scale B^T dp.
  void AddPressureForce(std::span<const double> dp, double scale, ThreadTeam& team, NodalVector& force) const;
  void IsolatePrescribed(ThreadTeam& team);
};

// What a matrix depends on beside the positions.
struct PressuresAndTouches {
  std::span<const double> acting;  // W p of the patches [Pa]
  std::span<const double> ratio;   // theta of the patches
  std::span<const Touch> touches;  // at the positions
};

// Assembles SaddleMatrix from the element matrices (element_matrices.h). Blocks and rows are added up in the order of
// the elements, so the bits do not depend on the number of threads. Not thread-safe.
class SaddleAssembly {
 public:
  // Finds the sparsity pattern. The model must outlive the assembly.
  explicit SaddleAssembly(const TetModel& model, const std::stop_token& stop = {});

  // Assembles at positions x. Exact tangents.
  void Assemble(const IncrementalPotential& potential, const NodalVector& x, const PressuresAndTouches& at,
                ThreadTeam& team, ForceWorkspace& workspace);

  // The change of A when the tangent of every point is replaced by the nearest positive semidefinite one, and the
  // stiffness of contacts by that without curvature.
  void AssembleProjection(const IncrementalPotential& potential, const NodalVector& x, const PressuresAndTouches& at,
                          ThreadTeam& team, ForceWorkspace& workspace);
  const BlockValues& projection() const { return projection_; }

  SaddleMatrix& matrix() { return matrix_; }
  const SaddleMatrix& matrix() const { return matrix_; }

 private:
  template <class Element>
  void FindPattern(const std::stop_token& stop);
  void FindSmoothedPattern();
  template <class Element>
  void AssembleVolumes(const NodalVector& x, ThreadTeam& team);
  void SmoothVolumes(ThreadTeam& team);

  const TetModel& model_;
  SaddleMatrix matrix_;
  std::optional<StiffnessLayout> layout_;  // of A
  BlockValues projection_;                 // on the pattern of A
  // B before smoothing, if there is smoothing, and the corners that contribute to each of its rows: 4 * element +
  // corner.
  BlockPattern raw_pattern_;
  NodalVector raw_B_;
  std::vector<std::int32_t> corner_begin_, corners_;
  std::vector<std::int32_t> volume_places_;  // for each corner: the nodes of its element
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_SADDLE_MATRIX_H_
