#ifndef FASCICLE_CORE_VOXEL_ROTATED_KERNELS_IMPL_H_
#define FASCICLE_CORE_VOXEL_ROTATED_KERNELS_IMPL_H_

#include "core/materials/rotation.h"
#include "core/voxel/kernels_impl.h"

// Kernels of rotated bricks, for one type of Lanes; the rules of kernels_impl.h apply.
//
// Everything is in modes (brick_modes.h) and in the frame of the brick: y = R^T x for positions x, X of the undeformed
// brick, f = K (y - X). R is the rotation nearest to the deformation gradient F = R S at the centre, which is the
// constant part of x. The energy of a brick is 1/2 (y - X) . K (y - X). Since R depends on x,
//   R^T dx = dy + w cross y,  w = G a,  G = (tr(S) I - S)^-1,  a: twice the axial vector of R^T dF,
// the derivative of the energy is the force R (f - e(g)), with g = G t for the torque t = sum of y cross f, and e(g)
// the matrix of g cross as a force on the constant part. (Without e(g) [Mueller & Gross 2004], neither energy nor
// angular momentum is conserved, and the tangent is not symmetric.)
namespace fascicle {

template <class T>
[[gnu::always_inline]] inline Vector3<T> Cross(const Vector3<T>& a, const Vector3<T>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
// (A32 - A23, A13 - A31, A21 - A12).
template <class T>
[[gnu::always_inline]] inline Vector3<T> TwiceAxial(const Matrix3<T>& A) {
  return {{A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1)}};
}
// tr(S) I - S.
template <class T>
[[gnu::always_inline]] inline Matrix3<T> SpinMatrix(const Matrix3<T>& S) {
  return PlusDiagonal(T(-1.0) * S, Trace(S));
}

template <class L>
struct TurnedBrick {
  using S = typename L::Scalar;
  static constexpr int kSingle[3] = {kModeX, kModeY, kModeZ};
  // Least det(tr(S) I - S), which is 8 without strain. Below it a brick is crushed or inverted and R jumps; then R is
  // taken as constant.
  static constexpr double kLeastSpin = 1e-2;

  // Gradient per mode of the constant part along each axis: 1/(4 h).
  [[gnu::always_inline]] static void GradientFactors(const RotatedTask<S>& task, L (&factor)[3]) {
    const L a0 = task.shape->a[0], a1 = task.shape->a[1], a2 = task.shape->a[2];
    // a = sqrt(V)/(4 h), so that a0 a1 a2 = sqrt(V)/64.
    const L inverse_root = 1 / (64 * (a0 * a1 * a2));
    factor[0] = a0 * inverse_root, factor[1] = a1 * inverse_root, factor[2] = a2 * inverse_root;
  }
  [[gnu::always_inline]] static Matrix3<L> GradientOf(const L (&factor)[3], const L (&u)[3][8]) {
    Matrix3<L> gradient;
    for (int g = 0; g < 3; ++g) {
      for (int d = 0; d < 3; ++d) gradient(d, g) = factor[g] * u[d][kSingle[g]];
    }
    return gradient;
  }
  [[gnu::always_inline]] static Matrix3<L> LoadRotation(const S* const (&rotation)[9], std::int32_t voxel) {
    Matrix3<L> R;
    for (int k = 0; k < 9; ++k) R.m[k] = L::Load(rotation[k] + voxel);
    return R;
  }
  [[gnu::always_inline]] static void Turn(const Matrix3<L>& R, const L (&from)[3][8], L (&to)[3][8]) {
    for (int m = 1; m < 8; ++m) {
      for (int d = 0; d < 3; ++d) to[d][m] = R(d, 0) * from[0][m] + R(d, 1) * from[1][m] + R(d, 2) * from[2][m];
    }
  }
  // Sum of a cross b over the modes.
  [[gnu::always_inline]] static Vector3<L> Torque(const L (&a)[3][8], const L (&b)[3][8]) {
    Vector3<L> sum = {{L(0.0), L(0.0), L(0.0)}};
    for (int m = 1; m < 8; ++m) {
      for (int d = 0; d < 3; ++d) {
        const int g = (d + 1) % 3, h = (d + 2) % 3;
        sum[d] += a[g][m] * b[h][m] - a[h][m] * b[g][m];
      }
    }
    return sum;
  }
  // f -= e(g).
  [[gnu::always_inline]] static void SubtractSpinForce(const L (&factor)[3], const Vector3<L>& g, L (&f)[3][8]) {
    for (int d = 0; d < 3; ++d) {
      const int k = (d + 1) % 3, l = (d + 2) % 3;
      // Entries (l, k) and (k, l) of the matrix of g cross are g_d and -g_d.
      f[l][kSingle[k]] -= factor[k] * g[d];
      f[k][kSingle[l]] += factor[l] * g[d];
    }
  }

  // Intermediate results of the forces at x.
  struct State {
    // x: displacements on input; positions afterwards.
    [[gnu::always_inline]] State(const RotatedTask<S>& task, const BrickModuli<L>& moduli, const Matrix3<L>& R,
                                 L (&x)[3][8]) {
      GradientFactors(task, factor);
      for (int d = 0; d < 3; ++d) x[d][kSingle[d]] += 1 / factor[d];
      Turn(Transpose(R), x, y);
      stretch = SymmetricPart(GradientOf(factor, y));
      L strain[3][8];
      for (int d = 0; d < 3; ++d) {
        for (int m = 1; m < 8; ++m) strain[d][m] = y[d][m];
        strain[d][kSingle[d]] -= 1 / factor[d];
      }
      ModeForces(*task.shape, moduli, strain, f);
      energy = L(0.0);
      for (int d = 0; d < 3; ++d) {
        for (int m = 1; m < 8; ++m) energy += f[d][m] * strain[d][m];
      }
      energy = 0.5 * energy;
      const Matrix3<L> spin = SpinMatrix(stretch);
      const Matrix3<L> cofactor = Cofactor(spin);
      const L determinant = DeterminantOf(spin, cofactor);
      G = Select(determinant > L(kLeastSpin), 1 / determinant, L(0.0)) * cofactor;
      g = G * Torque(y, f);
    }
    L factor[3], y[3][8], f[3][8], energy;
    Matrix3<L> stretch, G;  // S, G
    Vector3<L> g;
  };

  // f = R f; zero beyond the end of the run.
  [[gnu::always_inline]] static void TurnBack(const Matrix3<L>& R, const typename L::Mask& inside,
                                              const L (&local)[3][8], L (&f)[3][8]) {
    Turn(R, local, f);
    for (int d = 0; d < 3; ++d) {
      for (int m = 1; m < 8; ++m) f[d][m] = Select(inside, f[d][m], L(0.0));
    }
  }
  [[gnu::always_inline]] static typename L::Mask Inside(const VoxelRun& run, std::int32_t at) {
    return L::Load(LaneNumbers<L>::kNumbers.n) < L(static_cast<double>(run.length - at));
  }
};

// Forces, with their rotations and energies.
template <class L>
struct RotatedForces : TurnedBrick<L> {
  using Base = TurnedBrick<L>;
  using Task = RotatedTask<typename L::Scalar>;
  static constexpr int kFields = 1;

  [[gnu::always_inline]] static void Forces(const Task& task, const VoxelRun& run, std::int32_t at,
                                            const L (&u)[1][3][8], L (&f)[3][8]) {
    const auto inside = Base::Inside(run, at);
    L factor[3], x[3][8];
    Base::GradientFactors(task, factor);
    for (int d = 0; d < 3; ++d) {
      for (int m = 1; m < 8; ++m) x[d][m] = Select(inside, u[0][d][m], L(0.0));
    }
    const Matrix3<L> R = NearestRotation(PlusDiagonal(Base::GradientOf(factor, x), L(1.0)));
    const typename Base::State state(task, ModuliOfLanes(task, run, ScaleOf<L>(task, run, at)), R, x);
    L local[3][8];
    for (int d = 0; d < 3; ++d) {
      for (int m = 1; m < 8; ++m) local[d][m] = state.f[d][m];
    }
    Base::SubtractSpinForce(factor, state.g, local);
    Base::TurnBack(R, inside, local, f);
    const std::int32_t voxel = run.first_voxel + at;
    const std::int32_t count = run.length - at < L::kLanes ? run.length - at : L::kLanes;
    for (int lane = 0; lane < count; ++lane) {
      for (int k = 0; k < 9; ++k) task.new_rotation[k][voxel + lane] = R.m[k][lane];
      task.energy[voxel + lane] = state.energy[lane];
    }
  }
};

// The derivative of the forces at `at`, times x: with v = R^T x and w as above,
//   dy = v - w cross y, df = K dy, dS = R^T dF - [w] S, dt = sum of dy cross f + y cross df,
//   dg = G (dt - (tr(dS) I - dS) g), and the product R (w cross (f - e(g)) + df - e(dg)).
template <class L>
struct RotatedTangent : TurnedBrick<L> {
  using Base = TurnedBrick<L>;
  using Task = RotatedTask<typename L::Scalar>;
  static constexpr int kFields = 2;

  [[gnu::always_inline]] static void Forces(const Task& task, const VoxelRun& run, std::int32_t at,
                                            const L (&u)[2][3][8], L (&product)[3][8]) {
    const Matrix3<L> R = Base::LoadRotation(task.rotation, run.first_voxel + at);
    const BrickModuli<L> moduli = ModuliOfLanes(task, run, ScaleOf<L>(task, run, at));
    L x[3][8], v[3][8], dy[3][8], df[3][8];
    for (int d = 0; d < 3; ++d) {
      for (int m = 1; m < 8; ++m) x[d][m] = u[1][d][m];
    }
    const typename Base::State state(task, moduli, R, x);
    Base::Turn(Transpose(R), u[0], v);
    const Matrix3<L> A = Base::GradientOf(state.factor, v);
    const Vector3<L> w = state.G * TwiceAxial(A);
    for (int m = 1; m < 8; ++m) {
      for (int d = 0; d < 3; ++d) {
        const int g = (d + 1) % 3, h = (d + 2) % 3;
        dy[d][m] = v[d][m] - (w[g] * state.y[h][m] - w[h] * state.y[g][m]);
      }
    }
    ModeForces(*task.shape, moduli, dy, df);
    const Vector3<L> dt_strain = Base::Torque(dy, state.f), dt_force = Base::Torque(state.y, df);
    Matrix3<L> dS = A;
    for (int k = 0; k < 3; ++k) {
      const Vector3<L> turned = Cross(w, Vector3<L>{{state.stretch(0, k), state.stretch(1, k), state.stretch(2, k)}});
      for (int d = 0; d < 3; ++d) dS(d, k) = dS(d, k) - turned[d];
    }
    const Vector3<L> of_spin = SpinMatrix(SymmetricPart(dS)) * state.g;
    Vector3<L> change;
    for (int d = 0; d < 3; ++d) change[d] = dt_strain[d] + dt_force[d] - of_spin[d];
    const Vector3<L> dg = state.G * change;
    L force[3][8], local[3][8];
    for (int d = 0; d < 3; ++d) {
      for (int m = 1; m < 8; ++m) force[d][m] = state.f[d][m];
    }
    Base::SubtractSpinForce(state.factor, state.g, force);
    Base::SubtractSpinForce(state.factor, dg, df);
    for (int m = 1; m < 8; ++m) {
      for (int d = 0; d < 3; ++d) {
        const int g = (d + 1) % 3, h = (d + 2) % 3;
        local[d][m] = df[d][m] + (w[g] * force[h][m] - w[h] * force[g][m]);
      }
    }
    Base::TurnBack(R, Base::Inside(run, at), local, product);
  }
};

// R K R^T x: the derivative with R held constant, always positive semidefinite.
template <class L>
struct RotatedProduct : TurnedBrick<L> {
  using Base = TurnedBrick<L>;
  using Task = RotatedTask<typename L::Scalar>;
  static constexpr int kFields = 1;

  [[gnu::always_inline]] static void Forces(const Task& task, const VoxelRun& run, std::int32_t at,
                                            const L (&u)[1][3][8], L (&f)[3][8]) {
    const Matrix3<L> R = Base::LoadRotation(task.rotation, run.first_voxel + at);
    L v[3][8], local[3][8];
    Base::Turn(Transpose(R), u[0], v);
    ModeForces(*task.shape, ModuliOfLanes(task, run, ScaleOf<L>(task, run, at)), v, local);
    Base::Turn(R, local, f);
  }
};

template <class Set>
constexpr VoxelKernels VoxelKernelsOf() {
  using Doubles = Lanes<double, Set>;
  using Floats = Lanes<float, Set>;
  return {RunSum<Doubles, LinearBrick<Doubles>>::Add,
          RunSum<Floats, LinearBrick<Floats>>::Add,
          RunSum<Doubles, RotatedForces<Doubles>>::Add,
          RunSum<Doubles, RotatedTangent<Doubles>>::Add,
          RunSum<Floats, RotatedProduct<Floats>>::Add,
          PackedProduct<Set>::Add,
          Transfer<Set>::Interpolate,
          Transfer<Set>::Transpose};
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_ROTATED_KERNELS_IMPL_H_
