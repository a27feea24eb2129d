#ifndef FASCICLE_CORE_TET_SADDLE_MATRIX_H_
#define FASCICLE_CORE_TET_SADDLE_MATRIX_H_

#include "core/linalg/block_matrix.h"
#include "core/tet/potential.h"

namespace fascicle {

// The matrix of one Newton iteration, with the pressures p of the patches as unknowns of their own (a perturbed
// Lagrangian, [Zienkiewicz, Taylor & Zhu 2013, 11.3]):
//
//   [ A   B^T ] [dx]
//   [ B   -C  ] [dp],      A = -df/dx at fixed p,   B = V_n dtheta_n/dx,   C = V_n / U''(theta_n)
//
// over all nodes, prescribed components as well, until IsolatePrescribed makes an identity of these.
struct SaddleMatrix {
  BlockPattern pattern;         // nodes by nodes
  BlockValues A;                // [N/m]
  BlockPattern volume_pattern;  // patches by nodes
  TransposedPattern volume_of_node;
  NodalVector B;          // [m^2]
  std::vector<double> C;  // diagonal [m^3/Pa]
  FreeComponents free;

  std::size_t nodes() const { return pattern.rows(); }
  std::size_t patches() const { return C.size(); }

  // force = A dx + B^T dp, volume = B dx - C dp.
  void Multiply(const NodalVector& dx, std::span<const double> dp, ThreadTeam& team, NodalVector& force,
                std::span<double> volume) const;
  // force += scale B^T dp.
  void AddPressureForce(std::span<const double> dp, double scale, ThreadTeam& team, NodalVector& force) const;
  void IsolatePrescribed(ThreadTeam& team);
};

// Assembles SaddleMatrix: elements by blocks that fit the cache, each block's matrices in parallel, then the rows in
// parallel, each in the order of its elements; so the bits do not depend on the number of threads. One at a time.
class SaddleAssembly {
 public:
  // Finds the pattern; the model must outlive the assembly.
  explicit SaddleAssembly(const TetModel& model);

  // At positions x and acting pressures W p [Pa]; volume ratios theta of the patches. Exact tangents.
  void Assemble(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> acting,
                std::span<const double> ratio, ThreadTeam& team);

  // What A gains when the tangent of every point is replaced by the positive semidefinite one that is nearest to it, at
  // the x and pressures of the last Assemble.
  void AssembleProjection(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> acting,
                          ThreadTeam& team);
  const BlockValues& projection() const { return projection_; }

  SaddleMatrix& matrix() { return matrix_; }
  const SaddleMatrix& matrix() const { return matrix_; }

 private:
  template <class Element>
  void FindPattern();
  enum class Part { kExact, kProjection };
  template <class Element>
  void AssembleElements(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> acting,
                        Part part, ThreadTeam& team);
  template <class Element>
  void AddBlock(std::size_t begin, std::size_t end, Part part, ThreadTeam& team);
  void SmoothVolumes(ThreadTeam& team);

  const TetModel& model_;
  SaddleMatrix matrix_;
  BlockValues projection_;  // on the pattern of A
  // B before smoothing, where there is smoothing.
  BlockPattern raw_pattern_;
  NodalVector raw_B_;
  std::vector<std::int32_t> block_places_;   // of element e: nodes x nodes, row by row
  std::vector<std::int32_t> volume_places_;  // of element e: 4 corners x nodes
  std::vector<double> element_matrices_;     // of one block of elements
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_SADDLE_MATRIX_H_
