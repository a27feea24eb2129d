#ifndef FASCICLE_CORE_MATERIALS_TENSOR_ALGEBRA_H_
#define FASCICLE_CORE_MATERIALS_TENSOR_ALGEBRA_H_

#include "core/base/types.h"

// 3x3 algebra shared by the laws. Matrices become vectors of nine in Eigen's column-major order (see types.h).
namespace fascicle {

using Vec9 = Eigen::Matrix<double, 9, 1>;

inline Vec9 Flatten(const Mat3& a) { return Eigen::Map<const Vec9>(a.data()); }

// a : b.
inline double Contract(const Mat3& a, const Mat3& b) { return a.cwiseProduct(b).sum(); }

// cof F = J F^-T = dJ/dF, for any F.
inline Mat3 Cofactor(const Mat3& F) {
  Mat3 h;
  h(0, 0) = F(1, 1) * F(2, 2) - F(1, 2) * F(2, 1);
  h(1, 0) = F(2, 1) * F(0, 2) - F(2, 2) * F(0, 1);
  h(2, 0) = F(0, 1) * F(1, 2) - F(0, 2) * F(1, 1);
  h(0, 1) = F(1, 2) * F(2, 0) - F(1, 0) * F(2, 2);
  h(1, 1) = F(2, 2) * F(0, 0) - F(2, 0) * F(0, 2);
  h(2, 1) = F(0, 2) * F(1, 0) - F(0, 0) * F(1, 2);
  h(0, 2) = F(1, 0) * F(2, 1) - F(1, 1) * F(2, 0);
  h(1, 2) = F(2, 0) * F(0, 1) - F(2, 1) * F(0, 0);
  h(2, 2) = F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0);
  return h;
}

// det F from F and its cofactor.
inline double DeterminantOf(const Mat3& F, const Mat3& cofactor) { return F.col(0).dot(cofactor.col(0)); }

// Adds scale * d(F N)/dF: (i, j; k, l) -> delta_ik N_lj.
inline void AddRightProduct(double scale, const Mat3& N, Mat9& tangent) {
  for (int j = 0; j < 3; ++j) {
    for (int l = 0; l < 3; ++l) {
      for (int i = 0; i < 3; ++i) tangent(3 * j + i, 3 * l + i) += scale * N(l, j);
    }
  }
}

// Adds scale * d(M F)/dF: (i, j; k, l) -> M_ik delta_lj.
inline void AddLeftProduct(double scale, const Mat3& M, Mat9& tangent) {
  for (int j = 0; j < 3; ++j) tangent.block<3, 3>(3 * j, 3 * j) += scale * M;
}

// Adds scale * d(A dF^T A)/d(dF): (i, j; k, l) -> A_il A_kj. With A = F^-T and scale -1 this is d(F^-T)/dF.
inline void AddTransposedProduct(double scale, const Mat3& A, Mat9& tangent) {
  for (int j = 0; j < 3; ++j) {
    for (int l = 0; l < 3; ++l) tangent.block<3, 3>(3 * j, 3 * l) += scale * A.col(l) * A.col(j).transpose();
  }
}

// [a]x: the matrix with [a]x b = a x b.
inline Mat3 CrossMatrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

// Adds scale * d(cof F)/dF, the second derivative of J: column k of cof F is F_i x F_j, (i, j, k) cyclic.
inline void AddCofactorTangent(double scale, const Mat3& F, Mat9& tangent) {
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    tangent.block<3, 3>(3 * k, 3 * i) -= CrossMatrix(scale * F.col(j));
    tangent.block<3, 3>(3 * k, 3 * j) += CrossMatrix(scale * F.col(i));
  }
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_TENSOR_ALGEBRA_H_
