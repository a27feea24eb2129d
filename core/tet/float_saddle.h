#ifndef FASCICLE_CORE_TET_FLOAT_SADDLE_H_
#define FASCICLE_CORE_TET_FLOAT_SADDLE_H_

#include <span>

#include "core/linalg/sweep_matrix.h"
#include "core/tet/saddle_matrix.h"

namespace fascicle {

// Displacements or forces of nodes, in the order of a SweepMatrix, and pressures or volumes of patches, in single
// precision: a vector of FlexibleGmres.
struct SaddleField {
  FloatField x;
  std::vector<float> p;
};

// The operations on these vectors; sums have the same bits for any number of threads.
struct SaddleSpace {
  ThreadTeam& team;
  std::size_t nodes, patches;

  SaddleField Zero() const { return {FloatField(nodes, Vec4f::Zero()), std::vector<float>(patches, 0.0f)}; }
  double Dot(const SaddleField& a, const SaddleField& b) const;
  void Add(double scale, const SaddleField& v, SaddleField& sum) const;
  void Scale(double scale, SaddleField& v) const;
};

// The parts B and C of a SaddleMatrix in single precision, beside a SweepMatrix of A. Equations are scaled by the
// inverse square roots of the diagonal, for patches that of the approximate Schur complement. Not thread-safe.
class FloatSaddle {
 public:
  FloatSaddle(const SaddleMatrix& matrix, const SweepOrder& order);

  void SetValues(const SaddleMatrix& matrix, ThreadTeam& team);

  // Scales and rounds a right-hand side, multiplied by `factor`, and adds a rounded solution times `factor`.
  void FromDouble(const NodalVector& force, std::span<const double> volume, double factor, ThreadTeam& team,
                  SaddleField& result) const;
  void AddTo(NodalVector& dx, std::span<double> dp, double factor, ThreadTeam& team, const SaddleField& field) const;

  // Norm of a right-hand side after scaling.
  double NormOf(const NodalVector& force, std::span<const double> volume, ThreadTeam& team) const;

  // side = scaled K z, K = [A B^T; B -C].
  void Multiply(const SweepMatrix& A, const SaddleField& z, ThreadTeam& team, SaddleField& side) const;
  // The lower half of the preconditioner: p = -S^-1 volume and force - B^T p, both unscaled.
  void EliminatePressure(const SaddleField& side, ThreadTeam& team, std::vector<float>& p, FloatField& force) const;

 private:
  const SweepOrder& order_;
  // B by patches and by nodes, in the order of the nodes' places.
  BlockPattern rows_, columns_;
  std::vector<std::int32_t> rows_source_, columns_source_;
  FloatField B_, B_transposed_;
  std::vector<float> C_;
  FloatField scale_, inverse_scale_;  // of nodes
  std::vector<float> patch_scale_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FLOAT_SADDLE_H_
