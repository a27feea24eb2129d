#ifndef FASCICLE_TESTS_BENCH_SCALAR_REFERENCE_H_
#define FASCICLE_TESTS_BENCH_SCALAR_REFERENCE_H_

#include <array>
#include <cmath>
#include <variant>
#include <vector>

#include "core/tet/model.h"

// The straightforward implementation: a loop over linear tetrahedra, one after the other, with fixed-size Eigen
// matrices: F = Ds Dm^-1, P from the law, [f1 f2 f3] = -V P Dm^-T added to the nodes [Teran 2003, 4.1]. The vectorized
// loops are compared with it, in double and in float.
namespace fascicle::bench {

template <class Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
template <class Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

// The isometric muscle of core/materials/muscle.h for any scalar.
template <class ScalarType>
struct PlainMuscle {
  using Scalar = ScalarType;
  Scalar c1, c2, bulk, peak_stress, length_per_stretch, passive_scale, passive_exponent, transition, transition_value,
      slope;

  // values: those of Muscle::kParameters up to passive_transition.
  explicit PlainMuscle(const std::array<double, 8>& values)
      : c1(static_cast<Scalar>(values[0])),
        c2(static_cast<Scalar>(values[1])),
        bulk(static_cast<Scalar>(values[2])),
        peak_stress(static_cast<Scalar>(values[3])),
        length_per_stretch(static_cast<Scalar>(1 / values[4])),
        passive_scale(static_cast<Scalar>(values[5])),
        passive_exponent(static_cast<Scalar>(values[6])),
        transition(static_cast<Scalar>(values[7])),
        transition_value(passive_scale * std::expm1(passive_exponent * (transition - 1))),
        slope(passive_exponent * (transition_value + passive_scale)) {}

  Matrix3<Scalar> Stress(const Matrix3<Scalar>& F, const Vector3<Scalar>& a0, Scalar activation) const {
    const Matrix3<Scalar> C = F.transpose() * F;
    const Scalar I1 = C.trace();
    const Scalar I2 = (I1 * I1 - C.squaredNorm()) / 2;
    const Matrix3<Scalar> cofactor = Cofactor(F);
    const Scalar J = F.col(0).dot(cofactor.col(0));
    const Matrix3<Scalar> inverse_transpose = (1 / J) * cofactor;
    const Scalar log_J = std::log(J);
    const Scalar scale = std::exp(Scalar(-2. / 3) * log_J);  // J^(-2/3)
    const Scalar stretch = std::sqrt(scale * a0.dot(C * a0));
    const Scalar r = stretch * length_per_stretch;
    const Scalar W4 = peak_stress * length_per_stretch * (activation * Active(r) + Passive(r)) / (2 * stretch);
    Matrix3<Scalar> N = W4 * a0 * a0.transpose();
    N.diagonal().array() += c1;
    const Scalar s1 = 2 * scale, s2 = 2 * c2 * scale * scale;
    Matrix3<Scalar> S = s1 * N - s2 * C;
    S.diagonal().array() += s2 * I1;
    const Scalar pressure = bulk * log_J - (s1 * C.cwiseProduct(N).sum() + 2 * s2 * I2) / 3;
    return F * S + pressure * inverse_transpose;
  }

 private:
  static Matrix3<Scalar> Cofactor(const Matrix3<Scalar>& F) {
    Matrix3<Scalar> cofactor;
    cofactor << F(1, 1) * F(2, 2) - F(1, 2) * F(2, 1), F(1, 2) * F(2, 0) - F(1, 0) * F(2, 2),
        F(1, 0) * F(2, 1) - F(1, 1) * F(2, 0),  //
        F(2, 1) * F(0, 2) - F(2, 2) * F(0, 1), F(2, 2) * F(0, 0) - F(2, 0) * F(0, 2),
        F(2, 0) * F(0, 1) - F(2, 1) * F(0, 0),  //
        F(0, 1) * F(1, 2) - F(0, 2) * F(1, 1), F(0, 2) * F(1, 0) - F(0, 0) * F(1, 2),
        F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0);
    return cofactor;
  }
  static Scalar Active(Scalar r) {
    if (r <= Scalar(0.4) || r >= Scalar(1.6)) return 0;
    if (r < Scalar(0.6)) return 9 * (r - Scalar(0.4)) * (r - Scalar(0.4));
    if (r <= Scalar(1.4)) return 1 - 4 * (r - 1) * (r - 1);
    return 9 * (r - Scalar(1.6)) * (r - Scalar(1.6));
  }
  Scalar Passive(Scalar r) const {
    if (r <= 1) return 0;
    if (r < transition) return passive_scale * std::expm1(passive_exponent * (r - 1));
    return transition_value + slope * (r - transition);
  }
};

// A model's arrays in another scalar type, and the loops. For models of linear elements with one law.
template <class Law>
class ScalarReference {
 public:
  using Scalar = typename Law::Scalar;
  using Vector = Vector3<Scalar>;

  // activation: of all elements [1].
  ScalarReference(const TetModel& model, const Law& law, double activation)
      : law_(law),
        activation_(static_cast<Scalar>(activation)),
        corners_(model.corners()),
        nodes_(model.nodes()),
        patches_(model.patches()) {
    for (std::size_t e = 0; e < model.elements(); ++e) {
      Dm_inverse_.push_back(model.Dm_inverse()[e].template cast<Scalar>());
      volume_.push_back(static_cast<Scalar>(model.rest_volume()[e]));
      fibres_.push_back(model.fibres()[e].template cast<Scalar>());
    }
  }

  // x [m] of all nodes; force [N] is resized.
  void Force(const std::vector<Vector>& x, std::vector<Vector>& force) {
    force.assign(nodes_, Vector::Zero());
    if (!patches_.empty()) UpdatePressures(x);
    for (std::size_t e = 0; e < corners_.size(); ++e) {
      const Tetrahedron& c = corners_[e];
      const Matrix3<Scalar> F = GradientOf(e, x);
      Matrix3<Scalar> P = law_.Stress(F, fibres_[e], activation_);
      if (!patches_.empty()) P += PressureOf(e) * F.determinant() * F.inverse().transpose();
      const Matrix3<Scalar> f = -volume_[e] * P * Dm_inverse_[e].transpose();
      force[c[0]] -= f.rowwise().sum();
      for (int k = 0; k < 3; ++k) force[c[k + 1]] += f.col(k);
    }
  }

 private:
  Matrix3<Scalar> GradientOf(std::size_t e, const std::vector<Vector>& x) const {
    const Tetrahedron& c = corners_[e];
    Matrix3<Scalar> Ds;
    Ds << x[c[1]] - x[c[0]], x[c[2]] - x[c[0]], x[c[3]] - x[c[0]];
    return Ds * Dm_inverse_[e];
  }
  // W U'(W theta), with theta the mean of J around each node; see VolumePatches.
  void UpdatePressures(const std::vector<Vector>& x) {
    std::vector<double> theta(patches_.size(), 0.0), smooth(patches_.size()), own(patches_.size());
    for (std::size_t e = 0; e < corners_.size(); ++e) {
      const double J = static_cast<double>(GradientOf(e, x).determinant());
      for (const std::int32_t patch : patches_.of_element[e]) theta[patch] += static_cast<double>(volume_[e]) / 4 * J;
    }
    for (std::size_t n = 0; n < patches_.size(); ++n) theta[n] /= patches_.rest_volume[n];
    patches_.Smooth(theta, smooth);
    for (std::size_t n = 0; n < patches_.size(); ++n) own[n] = PatchEnergy{patches_.modulus[n]}.Pressure(smooth[n]);
    pressure_.resize(patches_.size());
    patches_.Smooth(own, pressure_);
  }
  Scalar PressureOf(std::size_t e) const {
    double sum = 0;
    for (const std::int32_t patch : patches_.of_element[e]) sum += pressure_[patch] / 4;
    return static_cast<Scalar>(sum);
  }

  const Law law_;
  const Scalar activation_;
  const std::vector<Tetrahedron>& corners_;
  const std::size_t nodes_;
  const VolumePatches& patches_;
  std::vector<Matrix3<Scalar>> Dm_inverse_;  // [1/m]
  std::vector<Scalar> volume_;               // [m^3]
  std::vector<Vector> fibres_;
  std::vector<double> pressure_;  // of each patch [Pa]
};

template <class Scalar>
std::vector<Vector3<Scalar>> CastAll(const NodalVector& values) {
  std::vector<Vector3<Scalar>> cast;
  for (const Vec3& v : values) cast.push_back(v.cast<Scalar>());
  return cast;
}

// Largest difference of two nodal vectors over the largest value of the second [1].
template <class Scalar>
double RelativeDifference(const std::vector<Vector3<Scalar>>& a, const NodalVector& b) {
  double difference = 0, largest = 0;
  for (std::size_t n = 0; n < b.size(); ++n) {
    difference = std::max(difference, (a[n].template cast<double>() - b[n]).norm());
    largest = std::max(largest, b[n].norm());
  }
  return difference / largest;
}

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_SCALAR_REFERENCE_H_
