// Every law of the list, with default and other parameters, against the checks of law_checks.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/materials/material.h"
#include "tests/support/law_checks.h"
#include "tests/support/law_values.h"

namespace fascicle {
namespace {

constexpr double kTolerance = 1e-6;        // differences
constexpr double kExactTolerance = 1e-10;  // identities that hold to round-off; K/mu is up to 1e4
constexpr double kRestTolerance = 1e-12;   // likewise; a fibre is up to 1e3 times stiffer than its matrix
constexpr int kSamples = 240;
constexpr int kParameterSets = 4;
constexpr std::array kActivations = {0.0, 0.3, 1.0};
constexpr double kMaxVelocity = 8;  // [1/s]

// Terms that the defaults leave out.
struct Term {
  std::string_view law, parameter;
  double value;
};
constexpr Term kOptionalTerms[] = {{"trans_iso_mooney_rivlin", "active_stress", 2e4},
                                   {"yeoh", "c2", -1e3},
                                   {"yeoh", "c3", 2e2},
                                   {"ogden", "c2", 1e3},
                                   {"ogden", "m2", 5},
                                   {"ogden", "c3", 2e3},
                                   {"ogden", "m3", -2},
                                   {"holzapfel_gasser_ogden", "kappa", 0.08},
                                   {"tabulated_muscle", "c2", -10},
                                   {"tabulated_muscle", "c3", 20}};

// Set 0: the defaults. Others: the distance to the lower end of the range, or to zero where that is no scale, changed
// by up to 40 %, and with terms that are absent by default.
std::vector<double> ParameterValues(const LawInfo& law, int set) {
  laws::Sampler sampler(1000u + static_cast<unsigned>(set));
  std::vector<double> values = testing::UsableValues(law);
  if (set == 0) return values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ParameterInfo& p = law.parameters[i];
    const double low = p.min < -1 ? 0 : p.min;
    values[i] = low + (values[i] - low) * sampler.Uniform(0.6, 1.12);
    for (const Term& term : kOptionalTerms) {
      if (term.law == law.name && term.parameter == p.name) values[i] = set * term.value;
    }
    // A low bulk modulus, so that no term of the matrix or the fibres is negligible.
    if (set == 2 && std::string_view(p.name) == "bulk_modulus") values[i] = 10 * values[0];
  }
  if (std::string_view(law.name) == "muscle") {
    // Fibres slack at rest, as in [Teran 2003]: the passive curve starts at stretch one.
    if (set == 1) values[4] = 1;
    // Fibres whose stress depends on their rate.
    if (set == 3) values[8] = kMaxVelocity;
  }
  if (std::string_view(law.name) == "tabulated_muscle") {
    // Passive fibres are slack at rest.
    values[5] = set == 1 ? 1 : 1.2;
    if (set == 3) values[6] = kMaxVelocity;
  }
  return values;
}

// The curves of the sets of parameters of the tabulated muscle.
std::shared_ptr<const MuscleCurves> CurvesOfSet(int set) {
  constexpr std::array kSets = {PublishedCurves::kThelen2003, PublishedCurves::kDeGroote2016,
                                PublishedCurves::kAlmonacid2024, PublishedCurves::kAlmonacid2024};
  return std::make_shared<const MuscleCurves>(CurvesOf(kSets.at(static_cast<std::size_t>(set))));
}

Material MaterialOf(const LawInfo& law, int set, const std::vector<double>& values) {
  if (std::string_view(law.name) == "tabulated_muscle") return TabulatedMuscle(values, CurvesOfSet(set));
  return law.make(values);
}

// Isochoric fibre stretches at which a curve has a kink, or its curvature jumps.
std::vector<double> Kinks(std::string_view law, int set, const std::vector<double>& values) {
  std::vector<double> kinks;
  if (law == "tabulated_muscle") {
    for (const double r : CurvesOfSet(set)->active_length.at()) kinks.push_back(r * values[5]);
    for (const double r : CurvesOfSet(set)->passive_length.at()) kinks.push_back(r * values[5]);
  }
  if (law == "muscle" || law == "blemker_muscle") {
    for (const double r : {0.4, 0.6, 1.0, 1.4, 1.6, values[7]}) kinks.push_back(r * values[4]);
  }
  if (law == "tendon" || law == "blemker_tendon" || law == "trans_iso_mooney_rivlin") kinks = {1.0, values[5]};
  if (law == "fung_fibre") kinks = {1.0};
  return kinks;
}

// The strains of the two families of fibres, by their definition; none for other laws.
std::vector<double> FamilyStrains(std::string_view law, const std::vector<double>& values, const laws::Sample& sample) {
  if (law != "holzapfel_gasser_ogden") return {};
  const double kappa = values[3], gamma = values[4];
  const Vec3 reference(values[5], values[6], values[7]), a0 = sample.fibre.direction;
  const Vec3 b = (reference - reference.dot(a0) * a0).normalized();
  const Mat3 isochoric = sample.F / std::cbrt(sample.F.determinant());
  std::vector<double> strains;
  for (const double side : {1.0, -1.0}) {
    const Vec3 a = std::cos(gamma) * a0 + side * std::sin(gamma) * b;
    strains.push_back(kappa * (isochoric.squaredNorm() - 3) + (1 - 3 * kappa) * ((isochoric * a).squaredNorm() - 1));
  }
  return strains;
}

struct Case {
  const LawInfo* law;
  int set;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.law->name << " with parameter set " << c.set; }

std::vector<Case> AllCases() {
  std::vector<Case> cases;
  for (const LawInfo& law : Laws()) {
    for (int set = 0; set < kParameterSets; ++set) cases.push_back({&law, set});
  }
  return cases;
}

class LawBattery : public ::testing::TestWithParam<Case> {
 protected:
  LawBattery()
      : values_(ParameterValues(*GetParam().law, GetParam().set)),
        kinks_(Kinks(GetParam().law->name, GetParam().set, values_)),
        material_(MaterialOf(*GetParam().law, GetParam().set, values_)) {}

  // The largest of check(law, sample) over all samples and activations.
  template <class Check>
  double Worst(const Check& check) {
    laws::Sampler sampler(7);
    return std::visit(
        [&](const auto& law) {
          double worst = 0;
          for (const double activation : kActivations) {
            for (int i = 0; i < kSamples; ++i) {
              const laws::Sample sample = Draw(sampler, i, activation);
              const double error = check(law, sample, sampler);
              if (!(error <= worst)) worst = error;  // keeps a NaN
              if (std::isnan(worst)) return worst;
            }
          }
          RecordProperty("worst", ::testing::PrintToString(worst));
          return worst;
        },
        material_);
  }

  // Away from kinks, for fibres that depend on the rate: from standstill to faster than the largest speed of
  // shortening, and lengthening.
  laws::Sample Draw(laws::Sampler& sampler, int index, double activation) const {
    for (;;) {
      laws::Sample sample = sampler.Draw(index, activation);
      const double stretch = (sample.F * sample.fibre.direction).norm() / std::cbrt(sample.F.determinant());
      sample.fibre.previous_stretch = stretch * sampler.Uniform(0.6, 1.4);
      sample.fibre.inverse_step = kMaxVelocity * sampler.Uniform(1, 4);
      std::vector<double> kinks = kinks_;
      const bool is_tabulated = std::string_view(GetParam().law->name) == "tabulated_muscle";
      if (is_tabulated && values_[6] > 0) {
        for (const double v : CurvesOfSet(GetParam().set)->force_velocity.at()) {
          kinks.push_back(sample.fibre.previous_stretch + v * values_[5] * values_[6] / sample.fibre.inverse_step);
        }
      }
      if (std::string_view(GetParam().law->name) == "muscle" && values_[8] > 0) {
        const double last_pull = sample.fibre.previous_stretch - values_[4] * values_[8] / sample.fibre.inverse_step;
        kinks.insert(kinks.end(), {sample.fibre.previous_stretch, last_pull});
      }
      // Families begin to pull at zero strain.
      const std::vector<double> strains = FamilyStrains(GetParam().law->name, values_, sample);
      const auto near_zero = [](double strain) { return std::abs(strain) < 0.01; };
      if (std::any_of(strains.begin(), strains.end(), near_zero)) continue;
      if (!laws::NearKink(sample, kinks)) return sample;
    }
  }

  // The same law in a body that is turned by Q^T at rest.
  template <class Law>
  Law Turned(const Law& law, const Mat3& Q) const {
    if constexpr (requires { law.ReferenceDirection(); }) {
      std::vector<double> values = values_;
      const Vec3 reference = Q.transpose() * law.ReferenceDirection();
      std::copy_n(reference.data(), 3, values.begin() + 5);
      return Law(values);
    } else {
      return law;
    }
  }

  bool IsLinear() const { return std::string_view(GetParam().law->name) == "linear_elastic"; }

  // Laws with ln J have a separable volume term, and are not finite where J <= 0.
  bool HasLogarithm() const {
    const std::string_view name = GetParam().law->name;
    return name != "linear_elastic" && name != "st_venant_kirchhoff" && name != "corotated_linear";
  }

  std::vector<double> values_;
  std::vector<double> kinks_;
  Material material_;
};

TEST_P(LawBattery, StressIsTheDerivativeOfTheEnergy) {
  EXPECT_LE(Worst([](const auto& law, const auto& s, auto&) { return laws::StressError(law, s); }), kTolerance);
}

TEST_P(LawBattery, TangentIsTheDerivativeOfTheStress) {
  EXPECT_LE(Worst([](const auto& law, const auto& s, auto&) { return laws::TangentError(law, s); }), kTolerance);
}

TEST_P(LawBattery, TangentIsSymmetric) {
  EXPECT_LE(Worst([](const auto& law, const auto& s, auto&) { return laws::TangentAsymmetry(law, s); }), 1e-14);
}

TEST_P(LawBattery, ObjectiveUnderRotation) {
  const double worst = Worst(
      [](const auto& law, const auto& s, auto& sampler) { return laws::ObjectivityError(law, s, sampler.Rotation()); });
  if (IsLinear()) {
    // Small strain is not objective; SmallStrain below tests its counterpart.
    EXPECT_GT(worst, 0.1);
  } else {
    EXPECT_LE(worst, kExactTolerance);
  }
}

TEST_P(LawBattery, KnowsNoDirectionButTheFibre) {
  if (IsLinear()) {
    // For a small-strain law both sides rotate: W(Q^T F Q) = W(F).
    EXPECT_LE(Worst([](const auto& law, const auto& s, auto& sampler) {
                const Mat3 Q = sampler.Rotation();
                const double W = law.Energy(s.F, s.fibre);
                return std::abs(law.Energy(Q.transpose() * s.F * Q, s.fibre) - W) / std::max(W, law.ShearModulus());
              }),
              kExactTolerance);
    return;
  }
  EXPECT_LE(Worst([&](const auto& law, const auto& s, auto& sampler) {
              const Mat3 Q = sampler.Rotation();
              return laws::SymmetryError(law, Turned(law, Q), s, Q);
            }),
            kExactTolerance);
}

TEST_P(LawBattery, VolumeTermIsReplacedAlone) {
  const double k = std::visit([](const auto& law) { return law.VolumeModulus(); }, material_);
  EXPECT_EQ(k != 0, HasLogarithm());
  for (const double other : {0.0, 0.3 * k, 20 * k, -2 * k}) {
    const double changed =
        std::visit([&](const auto& law) { return law.WithVolumeModulus(other).VolumeModulus(); }, material_);
    EXPECT_EQ(changed, HasLogarithm() ? other : 0);
    EXPECT_LE(Worst([&](const auto& law, const auto& s, auto&) { return laws::VolumeSplitError(law, s, other); }),
              kExactTolerance);
  }
}

TEST_P(LawBattery, NoStressAndNoEnergyAtRest) {
  EXPECT_LE(Worst([](const auto& law, const auto& s, auto&) { return laws::RestError(law, s.fibre.direction); }),
            kRestTolerance);
}

TEST_P(LawBattery, NoStressWhenMerelyRotated) {
  const double worst = Worst([](const auto& law, const auto& s, auto& sampler) {
    FibreState passive = s.fibre;
    passive.activation = 0;
    return law.Stress(sampler.Rotation(), passive).norm() / laws::ModulusOf(law);
  });
  if (IsLinear()) {
    EXPECT_GT(worst, 0.1);
  } else {
    EXPECT_LE(worst, kRestTolerance);
  }
}

TEST_P(LawBattery, SmallStrainModuliAreThoseStated) {
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(std::visit([&](const auto& law) { return laws::ModuliError(law, axis); }, material_), kExactTolerance);
  }
}

// P(I + t H) = C : t H + O(t^2) with Hooke's C of the stated moduli: halving t divides the error by four. For the
// linear law it is zero at every t. Fibres are slack: they are perpendicular to the growth of volume, or strains that
// stretch one of two families are left out.
TEST_P(LawBattery, SmallStrain) {
  std::visit(
      [&](const auto& law) {
        laws::Sampler sampler(11);
        int strains = 0;
        for (int i = 0; i < 1000 && strains < 20; ++i) {
          Mat3 H = sampler.Matrix(1);
          H.col(2).setZero();
          H.row(2).setZero();
          if (H.trace() < 0) H = -H;
          const FibreState fibre{Vec3::UnitZ(), 0};
          const std::vector<double> pull =
              FamilyStrains(GetParam().law->name, values_, {Mat3::Identity() + 1e-4 * H, fibre});
          if (std::any_of(pull.begin(), pull.end(), [](double strain) { return strain > -1e-6; })) continue;
          ++strains;
          const Mat3 hooke = laws::SmallStrainStress(law, Mat3(0.5 * (H + H.transpose())), 2);
          const auto error = [&](double t) {
            return (law.Stress(Mat3::Identity() + t * H, fibre) - t * hooke).norm() / (t * hooke.norm());
          };
          if (IsLinear()) {
            EXPECT_LE(error(0.5), 1e-14);
          } else {
            EXPECT_NEAR(error(1e-4) / error(5e-5), 2, 0.01);
          }
        }
        EXPECT_EQ(strains, 20);
      },
      material_);
}

TEST_P(LawBattery, NeverTrapsOnInvertedOrBrokenGradients) {
  const bool finite_when_inverted = !HasLogarithm();
  std::visit(
      [&](const auto& law) {
        const FibreState fibre{Vec3::UnitX(), 0.5};
        const Mat3 inverted = Vec3(1.1, -0.9, 1.2).asDiagonal();
        EXPECT_EQ(std::isfinite(law.Energy(inverted, fibre)), finite_when_inverted);
        EXPECT_EQ(law.Stress(inverted, fibre).allFinite(), finite_when_inverted);
        EXPECT_EQ(law.Tangent(inverted, fibre).allFinite(), finite_when_inverted);
        for (const Mat3& collapsed : {Mat3(Mat3::Zero()), Mat3(Vec3(1, 1, 0).asDiagonal())}) {
          EXPECT_EQ(std::isfinite(law.Energy(collapsed, fibre)), finite_when_inverted);
          EXPECT_EQ(law.Stress(collapsed, fibre).allFinite(), finite_when_inverted);
        }
        Mat3 broken = Mat3::Identity();
        broken(1, 2) = std::numeric_limits<double>::quiet_NaN();
        EXPECT_FALSE(std::isfinite(law.Energy(broken, fibre)));
        EXPECT_FALSE(law.Stress(broken, fibre).allFinite());
        broken(1, 2) = std::numeric_limits<double>::infinity();
        EXPECT_FALSE(std::isfinite(law.Energy(broken, fibre)));
        EXPECT_FALSE(law.Stress(broken, fibre).allFinite());
      },
      material_);
}

INSTANTIATE_TEST_SUITE_P(AllLaws, LawBattery, ::testing::ValuesIn(AllCases()), [](const auto& instance) {
  return std::string(instance.param.law->name) + "_" + std::to_string(instance.param.set);
});

}  // namespace
}  // namespace fascicle
