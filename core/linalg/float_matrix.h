#ifndef FASCICLE_CORE_LINALG_FLOAT_MATRIX_H_
#define FASCICLE_CORE_LINALG_FLOAT_MATRIX_H_

#include <array>
#include <vector>

#include "core/linalg/block_matrix.h"

// Matrices of 3x3 blocks in single precision, for preconditioners.
namespace fascicle {

using Vec4f = Eigen::Vector4f;  // three components and a zero, which fill a vector register
using FloatField = std::vector<Vec4f>;

struct FloatBlock {
  std::array<Vec4f, 3> column;

  FloatBlock() = default;
  explicit FloatBlock(const Mat3& m) {
    for (int c = 0; c < 3; ++c) column[c] << m.col(c).cast<float>(), 0;
  }
  Vec4f operator*(const Vec4f& x) const { return column[0] * x[0] + column[1] * x[1] + column[2] * x[2]; }
  Vec4f TransposedTimes(const Vec4f& x) const { return Vec4f(column[0].dot(x), column[1].dot(x), column[2].dot(x), 0); }
};

// Blocks of nine numbers each, column by column without gaps: what products read most of.
class FloatBlocks {
 public:
  void resize(std::size_t blocks) { numbers_.resize(9 * blocks + 1); }  // columns are read as four numbers
  void Set(std::size_t k, const Mat3& block) {
    for (int i = 0; i < 9; ++i) numbers_[9 * k + i] = static_cast<float>(block.data()[i]);
  }
  // sum += block k times x; the fourth component of the sum is meaningless.
  [[gnu::always_inline]] void AddProduct(std::size_t k, const Vec4f& x, Vec4f& sum) const {
    using Column = Eigen::Map<const Vec4f>;
    const float* at = &numbers_[9 * k];
    sum += Column(at) * x[0] + Column(at + 3) * x[1] + Column(at + 6) * x[2];
  }

 private:
  std::vector<float> numbers_;
};

// The inverse of a symmetric block whose eigenvalues are replaced by their absolute values and bounded away from zero.
Mat3 PositiveInverse(const Mat3& block);

// A square matrix with the inverses of its diagonal blocks.
class FloatMatrix {
 public:
  // The pattern must outlive the matrix, or the next call of SetValues.
  void SetValues(const BlockPattern& pattern, const BlockValues& values, ThreadTeam& team);

  std::size_t rows() const { return inverse_diagonal_.size(); }
  Vec4f RowTimes(std::size_t i, const FloatField& v) const {
    Vec4f sum = Vec4f::Zero();
    for (std::int32_t k = pattern_->begin[i]; k < pattern_->begin[i + 1]; ++k) {
      blocks_.AddProduct(k, v[pattern_->column[k]], sum);
    }
    sum[3] = 0;
    return sum;
  }
  const FloatBlock& inverse_diagonal(std::size_t i) const { return inverse_diagonal_[i]; }

 private:
  const BlockPattern* pattern_ = nullptr;
  FloatBlocks blocks_;
  std::vector<FloatBlock> inverse_diagonal_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_FLOAT_MATRIX_H_
