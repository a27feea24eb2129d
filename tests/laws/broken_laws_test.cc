// The battery's checks must find broken laws. Each law here has one typical mistake; the check for it must report it,
// and the checks unrelated to it must not.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/materials/isochoric.h"
#include "core/materials/material.h"
#include "core/materials/tensor_algebra.h"
#include "tests/support/law_checks.h"

namespace fascicle {
namespace {

constexpr std::array kYoungPoisson = {1e5, 0.3};
constexpr std::array kMuscle = {500.0, 500.0, 1e7, 3e5, 1.4, 0.05, 6.6, 1.4};
constexpr double kFound = 1e-3;  // a broken law's error is at least this
constexpr double kSound = 1e-6;  // the battery's tolerance

// Sign of the volume term in P.
struct WrongSign : NeoHookean {
  WrongSign() : NeoHookean(kYoungPoisson) {}
  Mat3 Stress(const Mat3& F, const FibreState& fibre) const {
    return 2 * ShearModulus() * F - NeoHookean::Stress(F, fibre);
  }
};

// P = K dU/dJ with U = K/2 (ln J)^2: K counted twice, as printed in a paper.
struct BulkCountedTwice : Muscle {
  BulkCountedTwice() : Muscle(kMuscle) {}
  Mat3 Stress(const Mat3& F, const FibreState& fibre) const {
    const IsochoricKinematics k(ToNumbers(F));
    return Muscle::Stress(F, fibre) + BulkModulus() * k.log_J * ToEigen(k.InverseTranspose());
  }
};

// W_lambda read as dF2/dlambda instead of dW/d(lambda^2).
struct WrongFibreDerivative : Muscle {
  WrongFibreDerivative() : Muscle(kMuscle) {}
  Mat3 Stress(const Mat3& F, const FibreState& fibre) const {
    const IsochoricKinematics k(ToNumbers(F));
    const Vector3<double> a0 = ToNumbers(fibre).direction;
    const double stretch = k.FibreStretch(a0);
    const double slope = FibreStress(stretch, fibre.activation) / stretch;
    const Mat3 gradient = ToEigen(FibreStretchSquaredGradient(ToNumbers(F), k, a0));
    return Muscle::Stress(F, fibre) + (slope - slope / (2 * stretch)) * gradient;
  }
};

// The derivative of F^-T is missing in the tangent.
struct TangentWithoutGeometricTerm : NeoHookean {
  TangentWithoutGeometricTerm() : NeoHookean(kYoungPoisson) {}
  Mat9 Tangent(const Mat3& F, const FibreState& fibre) const {
    const IsochoricKinematics k(ToNumbers(F));
    const double lambda = BulkModulus() - 2 * ShearModulus() / 3;
    Mat9 tangent = NeoHookean::Tangent(F, fibre);
    AddTransposedProduct(lambda * k.log_J - ShearModulus(), ToEigen(k.InverseTranspose()), tangent);
    return tangent;
  }
};

// dR/dF is missing: the rotation is treated as constant.
struct TangentWithFrozenRotation : CorotatedLinear {
  TangentWithFrozenRotation() : CorotatedLinear(kYoungPoisson) {}
  Mat9 Tangent(const Mat3& F, const FibreState&) const {
    const Vec9 r = Flatten(NearestRotation(F));
    return 2 * ShearModulus() * Mat9::Identity() + (BulkModulus() - 2 * ShearModulus() / 3) * r * r.transpose();
  }
};

// The curvature of the fibre energy is missing.
struct TangentWithoutFibreCurvature : Muscle {
  TangentWithoutFibreCurvature() : Muscle(kMuscle) {}
  Mat9 Tangent(const Mat3& F, const FibreState& fibre) const {
    const Matrix3<double> numbers = ToNumbers(F);
    const IsochoricKinematics k(numbers);
    const Vector3<double> a0 = ToNumbers(fibre).direction;
    const double stretch = k.FibreStretch(a0);
    const Vec9 gradient = Flatten(ToEigen(FibreStretchSquaredGradient(numbers, k, a0)));
    const double slope = FibreStress(stretch, fibre.activation) / stretch, h = 1e-5;
    const double slope_ahead = FibreStress(stretch + h, fibre.activation) / (stretch + h);
    const double slope_behind = FibreStress(stretch - h, fibre.activation) / (stretch - h);
    const FibreDerivatives<double> fibres(stretch, slope, (slope_ahead - slope_behind) / (2 * h));
    return Muscle::Tangent(F, fibre) - fibres.W44 * gradient * gradient.transpose();
  }
};

struct UnsymmetricTangent : NeoHookean {
  UnsymmetricTangent() : NeoHookean(kYoungPoisson) {}
  Mat9 Tangent(const Mat3& F, const FibreState& fibre) const {
    Mat9 tangent = NeoHookean::Tangent(F, fibre);
    tangent(1, 5) *= 1.01;
    return tangent;
  }
};

// Adds a term in the components of F themselves, with its exact derivatives.
struct NotObjective : NeoHookean {
  NotObjective() : NeoHookean(kYoungPoisson) {}
  double Energy(const Mat3& F, const FibreState& fibre) const {
    return NeoHookean::Energy(F, fibre) + 0.5 * ShearModulus() * F(0, 1) * F(0, 1);
  }
  Mat3 Stress(const Mat3& F, const FibreState& fibre) const {
    Mat3 P = NeoHookean::Stress(F, fibre);
    P(0, 1) += ShearModulus() * F(0, 1);
    return P;
  }
  Mat9 Tangent(const Mat3& F, const FibreState& fibre) const {
    Mat9 tangent = NeoHookean::Tangent(F, fibre);
    tangent(3, 3) += ShearModulus();
    return tangent;
  }
};

// Adds a function of C_11: objective, but the material x axis is distinguished.
struct NotIsotropic : NeoHookean {
  NotIsotropic() : NeoHookean(kYoungPoisson) {}
  double Energy(const Mat3& F, const FibreState& fibre) const {
    const double excess = F.col(0).squaredNorm() - 1;
    return NeoHookean::Energy(F, fibre) + 0.25 * ShearModulus() * excess * excess;
  }
  Mat3 Stress(const Mat3& F, const FibreState& fibre) const {
    Mat3 P = NeoHookean::Stress(F, fibre);
    P.col(0) += ShearModulus() * (F.col(0).squaredNorm() - 1) * F.col(0);
    return P;
  }
};

// The constant pressure that makes the rest state stress-free is missing: W + mu (J - 1).
struct StressAtRest : NeoHookean {
  StressAtRest() : NeoHookean(kYoungPoisson) {}
  double Energy(const Mat3& F, const FibreState& fibre) const {
    return NeoHookean::Energy(F, fibre) + ShearModulus() * (DeterminantOf(F, Cofactor(F)) - 1);
  }
  Mat3 Stress(const Mat3& F, const FibreState& fibre) const {
    return NeoHookean::Stress(F, fibre) + ShearModulus() * Cofactor(F);
  }
};

// The constant of integration of the energy is missing: W + mu.
struct EnergyAtRest : NeoHookean {
  EnergyAtRest() : NeoHookean(kYoungPoisson) {}
  double Energy(const Mat3& F, const FibreState& fibre) const { return NeoHookean::Energy(F, fibre) + ShearModulus(); }
};

// Reports c1 + c2 for the shear modulus.
struct WrongModulus : Muscle {
  WrongModulus() : Muscle(kMuscle) {}
  double ShearModulus() const { return 0.5 * Muscle::ShearModulus(); }
};

// Takes its volume term as k (ln J)^2 instead of k/2 (ln J)^2.
struct WrongVolumeModulus : NeoHookean {
  WrongVolumeModulus() : NeoHookean(kYoungPoisson) {}
  double VolumeModulus() const { return 0.5 * NeoHookean::VolumeModulus(); }
  WrongVolumeModulus WithVolumeModulus(double k) const {
    WrongVolumeModulus law = *this;
    static_cast<NeoHookean&>(law) = NeoHookean::WithVolumeModulus(2 * k);
    return law;
  }
};

// The largest error that each check reports.
struct Report {
  double stress = 0, tangent = 0, asymmetry = 0, objectivity = 0, symmetry = 0, rest = 0, moduli = 0;
};

template <class Law>
Report Examine(const Law& law) {
  const std::array kinks = {0.56, 0.84, 1.4, 1.96, 2.24};
  laws::Sampler sampler(3);
  Report worst;
  const auto keep = [](double& value, double error) { value = std::max(value, error); };
  for (int i = 0; i < 60; ++i) {
    const laws::Sample sample = sampler.Draw(i, 0.5);
    if (laws::NearKink(sample, kinks)) continue;
    const Mat3 Q = sampler.Rotation();
    keep(worst.stress, laws::StressError(law, sample));
    keep(worst.tangent, laws::TangentError(law, sample));
    keep(worst.asymmetry, laws::TangentAsymmetry(law, sample));
    keep(worst.objectivity, laws::ObjectivityError(law, sample, Q));
    keep(worst.symmetry, laws::SymmetryError(law, sample, Q));
    keep(worst.rest, laws::RestError(law, sample.fibre.direction));
  }
  keep(worst.moduli, laws::ModuliError(law, 0));
  return worst;
}

TEST(BrokenLaws, SoundLawsPassEveryCheck) {
  for (const Report& r :
       {Examine(NeoHookean(kYoungPoisson)), Examine(CorotatedLinear(kYoungPoisson)), Examine(Muscle(kMuscle))}) {
    for (const double error : {r.stress, r.tangent, r.asymmetry, r.objectivity, r.symmetry, r.rest, r.moduli}) {
      EXPECT_LE(error, kSound);
    }
  }
}

TEST(BrokenLaws, WrongSign) {
  const Report r = Examine(WrongSign());
  EXPECT_GT(r.stress, kFound);
  EXPECT_GT(r.tangent, kFound);
  EXPECT_LE(r.objectivity, kSound);
}

TEST(BrokenLaws, BulkModulusCountedTwice) {
  const Report r = Examine(BulkCountedTwice());
  EXPECT_GT(r.stress, kFound);
  EXPECT_GT(r.tangent, kFound);
  EXPECT_LE(r.objectivity, kSound);
  EXPECT_LE(r.rest, kSound);
}

TEST(BrokenLaws, FibreDerivativeByStretchInsteadOfItsSquare) {
  const Report r = Examine(WrongFibreDerivative());
  EXPECT_GT(r.stress, kFound);
  EXPECT_LE(r.objectivity, kSound);
  EXPECT_LE(r.symmetry, kSound);
  EXPECT_LE(r.rest, kSound);  // slack there: only a difference finds it
}

TEST(BrokenLaws, TangentThatMissesATerm) {
  for (const Report& r : {Examine(TangentWithoutGeometricTerm()), Examine(TangentWithFrozenRotation()),
                          Examine(TangentWithoutFibreCurvature())}) {
    EXPECT_GT(r.tangent, kFound);
    EXPECT_LE(r.stress, kSound);
    EXPECT_LE(r.asymmetry, kSound);
    EXPECT_LE(r.objectivity, kSound);
  }
}

TEST(BrokenLaws, UnsymmetricTangent) {
  const Report r = Examine(UnsymmetricTangent());
  EXPECT_GT(r.asymmetry, 1e-4);
  EXPECT_GT(r.tangent, 1e-4);
  EXPECT_LE(r.stress, kSound);
}

TEST(BrokenLaws, NotObjective) {
  const Report r = Examine(NotObjective());
  EXPECT_GT(r.objectivity, kFound);
  EXPECT_LE(r.stress, kSound);
  EXPECT_LE(r.tangent, kSound);
  EXPECT_LE(r.rest, kSound);
}

TEST(BrokenLaws, NotIsotropic) {
  const Report r = Examine(NotIsotropic());
  EXPECT_GT(r.symmetry, kFound);
  EXPECT_LE(r.objectivity, kSound);
  EXPECT_LE(r.stress, kSound);
  EXPECT_LE(r.rest, kSound);
}

TEST(BrokenLaws, StressAtRest) {
  const Report r = Examine(StressAtRest());
  EXPECT_GT(r.rest, kFound);
  EXPECT_LE(r.stress, kSound);
  EXPECT_LE(r.objectivity, kSound);
  EXPECT_LE(r.symmetry, kSound);
}

TEST(BrokenLaws, EnergyAtRest) {
  const Report r = Examine(EnergyAtRest());
  EXPECT_GT(r.rest, kFound);
  EXPECT_LE(r.stress, kSound);
  EXPECT_LE(r.tangent, kSound);
}

TEST(BrokenLaws, ModulusThatIsNotTheTangents) {
  const Report r = Examine(WrongModulus());
  EXPECT_GT(r.moduli, kFound);
  EXPECT_LE(r.stress, kSound);
  EXPECT_LE(r.tangent, kSound);
}

TEST(BrokenLaws, VolumeModulusThatIsNotTheTerms) {
  const laws::Sample sample = laws::Sampler(3).Draw(1, 0);
  EXPECT_LE(laws::VolumeSplitError(NeoHookean(kYoungPoisson), sample, 0), kSound);
  EXPECT_GT(laws::VolumeSplitError(WrongVolumeModulus(), sample, 0), kFound);
}

}  // namespace
}  // namespace fascicle
