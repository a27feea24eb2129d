#ifndef FASCICLE_CORE_MATERIALS_TANGENT_TERMS_H_
#define FASCICLE_CORE_MATERIALS_TANGENT_TERMS_H_

#include "core/base/matrix3.h"

// The tangent H = dP/dF of every law is a sum of terms of a few kinds; the law lists them. Of the two classes here that
// receive the terms, one sums up the matrix, the other its product with one dF. Matrices are vectors of nine in
// column-major order.
//
//   Diagonal(s)        s I
//   Square(s, a)       s a a^T
//   Pair(a, b)         a b^T + b a^T
//   Right(N)           d(F N)/dF with N symmetric:        (i, j; k, l) -> delta_ik N_lj
//   Left(M)            d(M F)/dF with M symmetric:        (i, j; k, l) -> M_ik delta_lj
//   Transposed(s, A)   s d(A dF^T A)/d(dF):               (i, j; k, l) -> s A_il A_kj
namespace fascicle {

// The upper triangle of H, row by row.
template <class T>
class TangentMatrix {
 public:
  TangentMatrix() {
    for (T& entry : h_) entry = T(0.0);
  }
  static constexpr int kEntries = 45;
  // Index of entry (row, column), row <= column.
  static constexpr int At(int row, int column) { return 9 * row - row * (row - 1) / 2 + column - row; }
  const T& operator[](int place) const { return h_[place]; }
  void Set(int place, const T& value) { h_[place] = value; }

  void Diagonal(const T& s) {
    for (int i = 0; i < 9; ++i) h_[At(i, i)] += s;
  }
  void Square(const T& s, const Matrix3<T>& a) {
    for (int i = 0; i < 9; ++i) {
      const T scaled = s * a.m[i];
      for (int j = i; j < 9; ++j) h_[At(i, j)] += scaled * a.m[j];
    }
  }
  void Pair(const Matrix3<T>& a, const Matrix3<T>& b) {
    for (int i = 0; i < 9; ++i) {
      for (int j = i; j < 9; ++j) h_[At(i, j)] += a.m[i] * b.m[j] + b.m[i] * a.m[j];
    }
  }
  void Right(const Matrix3<T>& N) {
    for (int j = 0; j < 3; ++j) {
      for (int l = j; l < 3; ++l) {
        for (int i = 0; i < 3; ++i) h_[At(3 * j + i, 3 * l + i)] += N(l, j);
      }
    }
  }
  void Left(const Matrix3<T>& M) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        for (int k = i; k < 3; ++k) h_[At(3 * j + i, 3 * j + k)] += M(i, k);
      }
    }
  }
  void Transposed(const T& s, const Matrix3<T>& A) {
    const Matrix3<T> scaled = s * A;
    for (int j = 0; j < 3; ++j) {
      for (int l = j; l < 3; ++l) {
        for (int i = 0; i < 3; ++i) {
          for (int k = l == j ? i : 0; k < 3; ++k) h_[At(3 * j + i, 3 * l + k)] += scaled(i, l) * A(k, j);
        }
      }
    }
  }
  // s d(cof F)/dF: column k of cof F is F_i x F_j, (i, j, k) cyclic.
  void CofactorTerm(const T& s, const Matrix3<T>& F) {
    for (int j = 0; j < 3; ++j) {
      for (int l = j + 1; l < 3; ++l) {
        // d(column j)/d(column l) is -+[column m]x with m the third.
        const int m = 3 - j - l;
        const bool cyclic = (j + 1) % 3 == l;
        for (int i = 0; i < 3; ++i) {
          const int k = (i + 1) % 3, n = (i + 2) % 3;
          // [a]x has -a_n at (i, k) and a_k at (i, n).
          const T at_k = s * F(n, m), at_n = s * F(k, m);
          h_[At(3 * j + i, 3 * l + k)] += cyclic ? at_k : -at_k;
          h_[At(3 * j + i, 3 * l + n)] += cyclic ? -at_n : at_n;
        }
      }
    }
  }

 private:
  T h_[kEntries];
};

// H : dF.
template <class T>
class TangentProduct {
 public:
  explicit TangentProduct(const Matrix3<T>& dF) : dF_(dF) {
    for (T& entry : dP_.m) entry = T(0.0);
  }
  const Matrix3<T>& dP() const { return dP_; }

  void Diagonal(const T& s) { dP_ = dP_ + s * dF_; }
  void Square(const T& s, const Matrix3<T>& a) { dP_ = dP_ + (s * Contract(a, dF_)) * a; }
  void Pair(const Matrix3<T>& a, const Matrix3<T>& b) { dP_ = dP_ + Contract(b, dF_) * a + Contract(a, dF_) * b; }
  void Right(const Matrix3<T>& N) { dP_ = dP_ + dF_ * N; }
  void Left(const Matrix3<T>& M) { dP_ = dP_ + M * dF_; }
  void Transposed(const T& s, const Matrix3<T>& A) { dP_ = dP_ + s * (A * (Transpose(dF_) * A)); }
  void CofactorTerm(const T& s, const Matrix3<T>& F) {
    // cof is quadratic: the change of the cofactor is cof(F + dF) - cof F - cof dF.
    Matrix3<T> change;
    for (int j = 0; j < 3; ++j) {
      const int k = (j + 1) % 3, l = (j + 2) % 3;
      for (int i = 0; i < 3; ++i) {
        const int m = (i + 1) % 3, n = (i + 2) % 3;
        change(i, j) = F(m, k) * dF_(n, l) + dF_(m, k) * F(n, l) - F(m, l) * dF_(n, k) - dF_(m, l) * F(n, k);
      }
    }
    dP_ = dP_ + s * change;
  }

 private:
  Matrix3<T> dF_, dP_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_TANGENT_TERMS_H_
