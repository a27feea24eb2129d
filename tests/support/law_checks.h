#ifndef FASCICLE_TESTS_SUPPORT_LAW_CHECKS_H_
#define FASCICLE_TESTS_SUPPORT_LAW_CHECKS_H_

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <type_traits>

#include "core/materials/constitutive_model.h"

// Properties of every law as functions that return the largest relative error; usable for the laws of the list and for
// laws that are broken on purpose.
namespace fascicle::laws {

struct Sample {
  Mat3 F;
  FibreState fibre;
};

// Step of the central differences of fourth order below. Truncation ~ h^4 b^4 / 30 with b the steepest exponent of a
// curve (46 per unit of stretch) and round-off ~ 1e-16 / h are both below 1e-8.
inline constexpr double kStep = 3e-4;

// --- Samples ---------------------------------------------------------------------------------------------------------

class Sampler {
 public:
  explicit Sampler(unsigned seed) : random_(seed) {}

  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double LogUniform(double low, double high) { return std::exp(Uniform(std::log(low), std::log(high))); }

  Mat3 Rotation() {
    std::normal_distribution<double> normal;
    return Eigen::Quaterniond(normal(random_), normal(random_), normal(random_), normal(random_))
        .normalized()
        .toRotationMatrix();
  }

  Vec3 Direction() { return Rotation().col(0); }

  Mat3 Matrix(double size) {
    Mat3 a;
    for (double& x : a.reshaped()) x = Uniform(-size, size);
    return a;
  }

  // In turn: near rest; large strain with J from 0.5 to 2; stretched along the fibre over the whole range of the fibre
  // curves; nearly incompressible, as in a simulation.
  Sample Draw(int index, double activation) {
    const Vec3 a0 = Direction();
    Mat3 F;
    switch (index % 4) {
      case 0:
        F = Rotation() * (Mat3::Identity() + Matrix(0.05));
        break;
      case 1:
        F = WithVolumeRatio(Stretched(), index % 8 == 1 ? 0.5 : LogUniform(0.5, 2));
        break;
      case 2: {
        const double stretch = Uniform(0.4, 2.4);
        const Mat3 along = a0 * a0.transpose();
        F = stretch * along + (Mat3::Identity() - along) / std::sqrt(stretch);
        F = Rotation() * (F + Matrix(0.03));
        break;
      }
      default:
        F = WithVolumeRatio(Stretched(), 1 + Uniform(-1e-3, 1e-3));
    }
    return {F, {a0, activation}};
  }

 private:
  Mat3 Stretched() {
    const Vec3 stretches(LogUniform(0.5, 2), LogUniform(0.5, 2), LogUniform(0.5, 2));
    return Rotation() * stretches.asDiagonal() * Rotation();
  }
  static Mat3 WithVolumeRatio(const Mat3& F, double J) { return std::cbrt(J / F.determinant()) * F; }

  std::mt19937 random_;
};

// Whether a difference stencil around the sample may cross one of `kinks` of the isochoric fibre stretch;
// fibre_curves_test.cc checks the curves there.
inline bool NearKink(const Sample& s, std::span<const double> kinks) {
  const Vec3 a = s.F * s.fibre.direction;
  const double J_third = std::cbrt(s.F.determinant());
  const double stretch = a.norm() / J_third;
  const Mat3 gradient = (a * s.fibre.direction.transpose() / a.squaredNorm() - s.F.inverse().transpose() / 3) * stretch;
  const double reach = 2.5 * kStep * gradient.cwiseAbs().maxCoeff();
  return std::any_of(kinks.begin(), kinks.end(), [&](double kink) { return std::abs(stretch - kink) < reach; });
}

// --- Checks ----------------------------------------------------------------------------------------------------------

template <class Law>
double ModulusOf(const Law& law) {
  return law.ShearModulus() + std::abs(law.BulkModulus());
}

// d f(F)/dF_ij by a central difference of fourth order.
template <class Function, class Value = std::invoke_result_t<Function, Mat3>>
Value Difference(const Function& f, const Mat3& F, int i, int j) {
  const auto at = [&](double offset) {
    Mat3 moved = F;
    moved(i, j) += offset * kStep;
    return f(moved);
  };
  return ((8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * kStep));
}

// P against the difference of W; relative to the larger of |P| and the shear modulus.
template <class Law>
double StressError(const Law& law, const Sample& s) {
  const Mat3 P = law.Stress(s.F, s.fibre);
  Mat3 expected;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      expected(i, j) = Difference([&](const Mat3& F) { return law.Energy(F, s.fibre); }, s.F, i, j);
    }
  }
  return (P - expected).norm() / std::max(P.norm(), law.ShearModulus());
}

// dP/dF against the difference of P.
template <class Law>
double TangentError(const Law& law, const Sample& s) {
  const Mat9 tangent = law.Tangent(s.F, s.fibre);
  Mat9 expected;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const Mat3 column = Difference([&](const Mat3& F) -> Mat3 { return law.Stress(F, s.fibre); }, s.F, i, j);
      expected.col(3 * j + i) = column.reshaped();
    }
  }
  return (tangent - expected).norm() / tangent.norm();
}

template <class Law>
double TangentAsymmetry(const Law& law, const Sample& s) {
  const Mat9 tangent = law.Tangent(s.F, s.fibre);
  return (tangent - tangent.transpose()).norm() / tangent.norm();
}

// W(Q F) = W(F) and P(Q F) = Q P(F).
template <class Law>
double ObjectivityError(const Law& law, const Sample& s, const Mat3& Q) {
  const double W = law.Energy(s.F, s.fibre);
  const Mat3 P = law.Stress(s.F, s.fibre);
  const double energy = std::abs(law.Energy(Q * s.F, s.fibre) - W) / std::max(std::abs(W), law.ShearModulus());
  const double stress = (law.Stress(Q * s.F, s.fibre) - Q * P).norm() / std::max(P.norm(), law.ShearModulus());
  return std::max(energy, stress);
}

// W(F Q; Q^T a0) = W(F; a0), and likewise P(F Q; Q^T a0) = P(F; a0) Q: the fibre is the only distinguished direction.
// An isotropic law gets a fibre that does not rotate, so that it must ignore it. `turned` is the law with its own
// directions, if it has any, turned by Q^T.
template <class Law>
double SymmetryError(const Law& law, const Law& turned, const Sample& s, const Mat3& Q) {
  const double W = law.Energy(s.F, s.fibre);
  const Mat3 P = law.Stress(s.F, s.fibre);
  FibreState fibre = s.fibre;
  if (Law::kNeedsFibres) fibre.direction = Q.transpose() * s.fibre.direction;
  const double energy = std::abs(turned.Energy(s.F * Q, fibre) - W) / std::max(std::abs(W), law.ShearModulus());
  const double stress = (turned.Stress(s.F * Q, fibre) - P * Q).norm() / std::max(P.norm(), law.ShearModulus());
  return std::max(energy, stress);
}
template <class Law>
double SymmetryError(const Law& law, const Sample& s, const Mat3& Q) {
  return SymmetryError(law, law, s, Q);
}

// W - W' = (k - k')/2 (ln J)^2 for the same law with another coefficient k' of its volume term, and its first and
// second derivatives; each relative to the larger of the law's own and the shear modulus.
template <class Law>
double VolumeSplitError(const Law& law, const Sample& s, double other_modulus) {
  const Law other = law.WithVolumeModulus(other_modulus);
  const double k = law.VolumeModulus() - other.VolumeModulus();
  const double log_J = std::log(s.F.determinant());
  const Mat3 H = s.F.inverse().transpose();
  Mat9 tangent;  // of k/2 (ln J)^2: k (H_ij H_kl - ln J H_il H_kj)
  for (int column = 0; column < 9; ++column) {
    for (int row = 0; row < 9; ++row) {
      const int i = row % 3, j = row / 3, m = column % 3, n = column / 3;
      tangent(row, column) = k * (H(i, j) * H(m, n) - log_J * H(i, n) * H(m, j));
    }
  }
  const double W = law.Energy(s.F, s.fibre);
  const Mat3 P = law.Stress(s.F, s.fibre);
  const Mat9 dP = law.Tangent(s.F, s.fibre);
  const double floor = std::max(law.ShearModulus(), std::abs(other_modulus));
  return std::max({std::abs(W - other.Energy(s.F, s.fibre) - 0.5 * k * log_J * log_J) / std::max(std::abs(W), floor),
                   (P - other.Stress(s.F, s.fibre) - k * log_J * H).norm() / std::max(P.norm(), floor),
                   (dP - other.Tangent(s.F, s.fibre) - tangent).norm() / std::max(dP.norm(), floor)});
}

// Stress and energy of the undeformed body without activation.
template <class Law>
double RestError(const Law& law, const Vec3& direction) {
  const FibreState fibre{direction, 0};
  const Mat3 F = Mat3::Identity();
  return std::max(law.Stress(F, fibre).norm(), std::abs(law.Energy(F, fibre))) / ModulusOf(law);
}

// The stress of a small strain without fibre stress. The matrix of laws with two shear moduli, along and across the
// fibres, which run along `axis`, does not resist a change of the fibres' length.
template <class Law>
Mat3 SmallStrainStress(const Law& law, const Mat3& strain, int axis) {
  if constexpr (requires { law.ShearModulusAlong(); }) {
    Mat3 shear = strain, across = strain;
    shear.diagonal().setZero();
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    shear(i, j) = shear(j, i) = 0;
    across.row(axis).setZero();
    across.col(axis).setZero();
    across(i, i) = 0.5 * (strain(i, i) - strain(j, j));
    across(j, j) = -across(i, i);
    return 2 * law.ShearModulusAlong() * shear + 2 * law.ShearModulusAcross() * across +
           law.BulkModulus() * strain.trace() * Mat3::Identity();
  } else {
    const double lambda = law.BulkModulus() - 2 * law.ShearModulus() / 3;
    return 2 * law.ShearModulus() * strain + lambda * strain.trace() * Mat3::Identity();
  }
}

// dP/dF at rest against Hooke's law with the law's stated moduli, deviatoric and volumetric part each relative to its
// own. Along a coordinate axis the fibre stretch is 1 without round-off, so that fibres which pull above 1 are slack.
template <class Law>
double ModuliError(const Law& law, int axis) {
  const Mat9 tangent = law.Tangent(Mat3::Identity(), {Vec3::Unit(axis), 0});
  const auto respond = [&](const Mat3& strain) -> Mat3 {
    return (tangent * Eigen::Matrix<double, 9, 1>(strain.reshaped())).eval().reshaped(3, 3);
  };
  const Mat3 volume = respond(Mat3::Identity());
  double error = (volume - 3 * law.BulkModulus() * Mat3::Identity()).norm() / (3 * std::abs(law.BulkModulus()));
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    Mat3 shear = Mat3::Zero(), stretch = Mat3::Zero(), spin = Mat3::Zero();
    shear(i, j) = shear(j, i) = 1;
    stretch(i, i) = 1;
    stretch(j, j) = -1;
    spin(i, j) = 1;
    spin(j, i) = -1;
    const double mu = law.ShearModulus();
    const Mat3 of_shear = SmallStrainStress(law, shear, axis), of_stretch = SmallStrainStress(law, stretch, axis);
    // The entries of the tangents are of the order of the bulk modulus, and so are their rounding errors.
    const double scale = std::max(2 * mu, 1e-6 * std::abs(law.BulkModulus()));
    error = std::max({error, (respond(shear) - of_shear).norm() / scale, (respond(stretch) - of_stretch).norm() / scale,
                      respond(spin).norm() / scale});
  }
  return error;
}

}  // namespace fascicle::laws

#endif  // FASCICLE_TESTS_SUPPORT_LAW_CHECKS_H_
