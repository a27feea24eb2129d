#ifndef FASCICLE_CORE_MATERIALS_SYMMETRIC_EIGEN_H_
#define FASCICLE_CORE_MATERIALS_SYMMETRIC_EIGEN_H_

#include "core/base/matrix3.h"
#include "core/materials/rotation.h"

namespace fascicle {

// Eigenvalues and eigenvectors of a symmetric positive definite matrix: a = V diag(values) V^T, V orthogonal. In no
// particular order; for equal eigenvalues, any basis. Both are accurate to round-off, also where eigenvalues coincide.
// NaN where a is not finite.
//
// Cyclic Jacobi rotations. An off-diagonal entry that is negligible beside the diagonal is left alone, so that a lane
// that has converged keeps its bits while others are still at work.
// [Golub, Van Loan 2013, Matrix computations, 8.5; Demmel, Veselic 1992, Jacobi's method is more accurate than QR]
template <class T>
struct SymmetricEigen {
  explicit SymmetricEigen(Matrix3<T> a) : vectors(Diagonal(T(1.0))) {
    constexpr int kMaxSweeps = 15;  // four are usual
    for (int i = 0; i < kMaxSweeps && AnyCoupled(a); ++i) {
      Rotate(a, 0, 1, 2);
      Rotate(a, 1, 2, 0);
      Rotate(a, 2, 0, 1);
    }
    for (int i = 0; i < 3; ++i) values[i] = a(i, i);
  }

  Vector3<T> Vector(int i) const { return {{vectors(0, i), vectors(1, i), vectors(2, i)}}; }

  Vector3<T> values;
  Matrix3<T> vectors;  // in columns

 private:
  // Whether the entry (p, q) matters beside the diagonal.
  static auto Coupled(const Matrix3<T>& a, int p, int q) {
    constexpr double kNegligible = 1e-34;
    return a(p, q) * a(p, q) > kNegligible * a(p, p) * a(q, q);
  }

  static bool AnyCoupled(const Matrix3<T>& a) {
    return AnyOf(Coupled(a, 0, 1)) || AnyOf(Coupled(a, 1, 2)) || AnyOf(Coupled(a, 2, 0));
  }

  // Makes the entry (p, q) zero; r is the third index. The upper and the lower triangle are kept equal.
  void Rotate(Matrix3<T>& a, int p, int q, int r) {
    const auto coupled = Coupled(a, p, q);
    const T d = a(q, q) - a(p, p);
    const T root = Sqrt(d * d + 4 * a(p, q) * a(p, q));
    const T t = Select(coupled, 2 * a(p, q) / Select(d >= 0, d + root, d - root), 0);
    const T c = 1 / Sqrt(1 + t * t), s = t * c;
    a(p, p) = a(p, p) - t * a(p, q);
    a(q, q) = a(q, q) + t * a(p, q);
    a(p, q) = a(q, p) = Select(coupled, 0, a(p, q));
    const T at_p = a(r, p), at_q = a(r, q);
    a(r, p) = a(p, r) = c * at_p - s * at_q;
    a(r, q) = a(q, r) = s * at_p + c * at_q;
    for (int i = 0; i < 3; ++i) {
      const T v_p = vectors(i, p), v_q = vectors(i, q);
      vectors(i, p) = c * v_p - s * v_q;
      vectors(i, q) = s * v_p + c * v_q;
    }
  }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_SYMMETRIC_EIGEN_H_
