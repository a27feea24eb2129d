#ifndef FASCICLE_CORE_LINALG_SWEEP_MATRIX_H_
#define FASCICLE_CORE_LINALG_SWEEP_MATRIX_H_

#include "core/linalg/float_matrix.h"
#include "core/linalg/sweep_order.h"

namespace fascicle {

// A symmetric matrix A = L + D + U of 3x3 blocks in single precision, with Gauss-Seidel sweeps. All fields are in the
// order of `order()`. L and U, the parts before and after the diagonal blocks D, are stored one after the other,
// because a sweep from zero reads only one of them. The same bits for any number of threads. Not thread-safe.
class SweepMatrix {
 public:
  // The pattern must outlive the matrix; it is symmetric and has all diagonal blocks.
  SweepMatrix(const BlockPattern& pattern, std::span<const Vec3> positions);

  // Values on the pattern. Diagonal blocks that are not clearly positive are inverted as by PositiveInverse.
  void SetValues(const BlockValues& values, ThreadTeam& team);

  const SweepOrder& order() const { return order_; }
  std::size_t rows() const { return order_.row.size(); }
  const FloatBlock& inverse_diagonal(std::size_t i) const { return inverse_diagonal_[i]; }

  // product = A x.
  void Multiply(const FloatField& x, ThreadTeam& team, FloatField& product) const;
  // Solves (L + D) x = b: a forward sweep from zero.
  void SweepFromZero(const FloatField& b, ThreadTeam& team, FloatField& x) const;
  // r = b - A x after a forward sweep from zero, which is -U x.
  void ResidualAfterSweep(const FloatField& x, ThreadTeam& team, FloatField& r) const;
  // Completes a forward sweep from zero to a symmetric one: D y = D x - U y in place of x.
  void SweepBackFromSweep(ThreadTeam& team, FloatField& x) const;
  // A backward sweep: (U + D) y = b - L x in place of x.
  void SweepBack(const FloatField& b, ThreadTeam& team, FloatField& x) const;

 private:
  // One part of the blocks: L or U.
  struct Part {
    std::vector<std::int32_t> begin, column, source;  // rows, columns and places in the pattern
    FloatBlocks blocks;

    void AddRow(std::size_t i, const FloatField& x, Vec4f& sum) const {
      for (std::int32_t k = begin[i]; k < begin[i + 1]; ++k) blocks.AddProduct(k, x[column[k]], sum);
    }
    // For rows in descending order, so that memory is read in one direction.
    void AddRowBackward(std::size_t i, const FloatField& x, Vec4f& sum) const {
      for (std::int32_t k = begin[i + 1]; k-- > begin[i];) blocks.AddProduct(k, x[column[k]], sum);
    }
  };
  template <class Visit>
  void Forward(ThreadTeam& team, const Visit& visit) const;
  template <class Visit>
  void Backward(ThreadTeam& team, const Visit& visit) const;

  SweepOrder order_;
  Part lower_, upper_;
  std::vector<std::int32_t> diagonal_source_;
  std::vector<FloatBlock> diagonal_, inverse_diagonal_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_SWEEP_MATRIX_H_
