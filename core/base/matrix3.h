#ifndef FASCICLE_CORE_BASE_MATRIX3_H_
#define FASCICLE_CORE_BASE_MATRIX3_H_

#include <type_traits>

// Vectors and matrices of size three, of numbers or of Lanes: only the operations that constitutive laws and elements
// need.
namespace fascicle {

template <class T>
struct Vector3 {
  T v[3];
  T& operator[](int i) { return v[i]; }
  const T& operator[](int i) const { return v[i]; }
};

// Column-major, like Mat3.
template <class T>
struct Matrix3 {
  T m[9];
  T& operator()(int i, int j) { return m[3 * j + i]; }
  const T& operator()(int i, int j) const { return m[3 * j + i]; }
};

template <class T>
Matrix3<T> operator+(const Matrix3<T>& a, const Matrix3<T>& b) {
  Matrix3<T> r;
  for (int k = 0; k < 9; ++k) r.m[k] = a.m[k] + b.m[k];
  return r;
}
template <class T>
Matrix3<T> operator-(const Matrix3<T>& a, const Matrix3<T>& b) {
  Matrix3<T> r;
  for (int k = 0; k < 9; ++k) r.m[k] = a.m[k] - b.m[k];
  return r;
}
template <class T>
Matrix3<T> operator*(const std::type_identity_t<T>& s, const Matrix3<T>& a) {
  Matrix3<T> r;
  for (int k = 0; k < 9; ++k) r.m[k] = s * a.m[k];
  return r;
}
template <class T>
Matrix3<T> operator*(const Matrix3<T>& a, const Matrix3<T>& b) {
  Matrix3<T> r;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) r(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
  }
  return r;
}
template <class T>
Vector3<T> operator*(const Matrix3<T>& a, const Vector3<T>& b) {
  Vector3<T> r;
  for (int i = 0; i < 3; ++i) r[i] = a(i, 0) * b[0] + a(i, 1) * b[1] + a(i, 2) * b[2];
  return r;
}

template <class T>
Matrix3<T> Transpose(const Matrix3<T>& a) {
  Matrix3<T> r;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) r(i, j) = a(j, i);
  }
  return r;
}
template <class T>
Matrix3<T> SymmetricPart(const Matrix3<T>& a) {
  return 0.5 * (a + Transpose(a));
}
// a + s I.
template <class T>
Matrix3<T> PlusDiagonal(Matrix3<T> a, const std::type_identity_t<T>& s) {
  for (int i = 0; i < 3; ++i) a(i, i) = a(i, i) + s;
  return a;
}
template <class T>
Matrix3<T> Diagonal(const T& s) {
  Matrix3<T> r;
  for (int k = 0; k < 9; ++k) r.m[k] = T(0.0);
  return PlusDiagonal(r, s);
}
// a b^T.
template <class T>
Matrix3<T> Outer(const Vector3<T>& a, const Vector3<T>& b) {
  Matrix3<T> r;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) r(i, j) = a[i] * b[j];
  }
  return r;
}
// s a a^T, symmetric to the last bit.
template <class T>
Matrix3<T> ScaledSquare(const std::type_identity_t<T>& s, const Vector3<T>& a) {
  return s * Outer(a, a);
}

template <class T>
T Dot(const Vector3<T>& a, const Vector3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
// a : b.
template <class T>
T Contract(const Matrix3<T>& a, const Matrix3<T>& b) {
  T column[3];
  for (int j = 0; j < 3; ++j) column[j] = a(0, j) * b(0, j) + a(1, j) * b(1, j) + a(2, j) * b(2, j);
  return column[0] + column[1] + column[2];
}
template <class T>
T SquaredNorm(const Matrix3<T>& a) {
  return Contract(a, a);
}
template <class T>
T Trace(const Matrix3<T>& a) {
  return a(0, 0) + a(1, 1) + a(2, 2);
}

// cof F = J F^-T = dJ/dF, for any F.
template <class T>
Matrix3<T> Cofactor(const Matrix3<T>& F) {
  Matrix3<T> h;
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3, l = (j + 2) % 3;
    for (int i = 0; i < 3; ++i) {
      const int m = (i + 1) % 3, n = (i + 2) % 3;
      h(i, j) = F(m, k) * F(n, l) - F(m, l) * F(n, k);
    }
  }
  return h;
}
// det F from F and its cofactor matrix.
template <class T>
T DeterminantOf(const Matrix3<T>& F, const Matrix3<T>& cofactor) {
  return F(0, 0) * cofactor(0, 0) + F(1, 0) * cofactor(1, 0) + F(2, 0) * cofactor(2, 0);
}
template <class T>
T Determinant(const Matrix3<T>& F) {
  return DeterminantOf(F, Cofactor(F));
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_MATRIX3_H_
