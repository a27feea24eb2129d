#include "core/scene/output_fields.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/von_mises.h"

namespace fascicle {
namespace {

constexpr auto kMotion = FieldSource::kMotion;
constexpr auto kDeformation = FieldSource::kDeformation;
constexpr auto kStress = FieldSource::kStress;
constexpr auto kFibre = FieldSource::kFibreStress;

constexpr std::array<bool, 3> kEvery = {true, true, true};
constexpr std::array<bool, 3> kWithFibres = {true, false, true};
constexpr std::array<bool, 3> kTetOnly = {true, false, false};

constexpr std::array kTable = {
    OutputFieldInfo{OutputField::kVelocity, "velocity", "m/s", 3, kMotion},
    OutputFieldInfo{OutputField::kCauchyStress, "cauchy_stress", "Pa", 6, kStress},
    OutputFieldInfo{OutputField::kVonMisesStress, "von_mises_stress", "Pa", 1, kStress},
    OutputFieldInfo{OutputField::kPressure, "pressure", "Pa", 1, kStress},
    OutputFieldInfo{OutputField::kVolumeRatio, "volume_ratio", "1", 1, kDeformation},
    OutputFieldInfo{OutputField::kFibreStretch, "fibre_stretch", "1", 1, kDeformation, kWithFibres, true},
    OutputFieldInfo{OutputField::kFibreDirection, "fibre_direction", "1", 3, kDeformation, kWithFibres, true, true},
    OutputFieldInfo{OutputField::kGreenLagrangeStrain, "green_lagrange_strain", "1", 6, kDeformation},
    OutputFieldInfo{OutputField::kLogarithmicStrain, "logarithmic_strain", "1", 6, kDeformation},
    OutputFieldInfo{OutputField::kPrincipalStrains, "principal_strains", "1", 3, kDeformation, kEvery, false, false,
                    OutputField::kLogarithmicStrain},
    OutputFieldInfo{OutputField::kPrincipalStresses, "principal_stresses", "Pa", 3, kStress, kEvery, false, false,
                    OutputField::kCauchyStress},
    OutputFieldInfo{OutputField::kPrincipalStressDirections, "principal_stress_directions", "1", 9, kStress, kEvery,
                    false, false, OutputField::kCauchyStress},
    OutputFieldInfo{OutputField::kStrainEnergyDensity, "strain_energy_density", "J/m^3", 1, FieldSource::kEnergy},
    OutputFieldInfo{OutputField::kFibreStress, "fibre_stress", "Pa", 1, kFibre, kWithFibres, true},
    OutputFieldInfo{OutputField::kActiveFibreStress, "active_fibre_stress", "Pa", 1, kFibre, kWithFibres, true},
    OutputFieldInfo{OutputField::kPassiveFibreStress, "passive_fibre_stress", "Pa", 1, kFibre, kWithFibres, true},
    OutputFieldInfo{OutputField::kInternalForce, "internal_force", "N", 3, FieldSource::kNodalForce, kTetOnly},
    OutputFieldInfo{OutputField::kReactionForce, "reaction_force", "N", 3, FieldSource::kNodalForce, kTetOnly},
    OutputFieldInfo{OutputField::kPennationAngle, "pennation_angle", "rad", 1, kDeformation, kWithFibres, true},
};

constexpr bool IsInOrder() {
  for (std::size_t i = 0; i < kTable.size(); ++i) {
    if (static_cast<std::size_t>(kTable[i].field) != i || kTable[i].components > kMostComponents) return false;
  }
  return true;
}
static_assert(IsInOrder());

void PutTensor(const Mat3& t, double* values) {
  for (const double value : {t(0, 0), t(1, 1), t(2, 2), t(0, 1), t(1, 2), t(0, 2)}) *values++ = value;
}

Mat3 Tensor(const double* s) { return (Mat3() << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]).finished(); }

// Solved by iteration: the closed form loses half of the digits where principal values repeat.
using Principal = Eigen::SelfAdjointEigenSolver<Mat3>;

void PutPrincipalValues(const Mat3& tensor, double* values) {
  const Principal principal(tensor, Eigen::EigenvaluesOnly);
  for (int k = 0; k < 3; ++k) values[k] = principal.eigenvalues()[2 - k];
}

void PutPrincipalDirections(const Mat3& tensor, double* values) {
  const Principal principal(tensor);
  for (int k = 0; k < 3; ++k) Eigen::Map<Vec3>(values + 3 * k) = principal.eigenvectors().col(2 - k);
}

// ln V of V^2 = F F^T.
Mat3 LogarithmicStrain(const Mat3& F) {
  const Principal squares(F * F.transpose());
  const Vec3 logs = 0.5 * squares.eigenvalues().array().log();
  return squares.eigenvectors() * logs.asDiagonal() * squares.eigenvectors().transpose();
}

// The stress along the fibre beyond the mean of those across it; 0 without a fibre.
double StressAlongFibre(const Mat3& sigma, const Mat3& F, const Vec3& a0) {
  const Vec3 a = (F * a0).stableNormalized();
  const double along = a.dot(sigma * a);
  return a.isZero(0) ? 0 : along - (sigma.trace() - along) / 2;
}

// Between lines, so at most pi / 2; 0 without a fibre.
double PennationAngle(const Vec3& fibre, const Vec3& line) {
  return std::atan2(fibre.cross(line).norm(), std::abs(fibre.dot(line)));
}

}  // namespace

std::span<const OutputFieldInfo> OutputFields() { return kTable; }

const OutputFieldInfo& InfoOf(OutputField field) { return kTable.at(static_cast<std::size_t>(field)); }

const OutputFieldInfo* FindOutputField(std::string_view name) {
  const auto* found = std::find_if(kTable.begin(), kTable.end(), [&](const auto& info) { return info.name == name; });
  return found == kTable.end() ? nullptr : found;
}

void PutField(OutputField field, const MaterialPoint& at, double* values) {
  switch (field) {
    case OutputField::kVelocity:
      std::copy(at.v.begin(), at.v.end(), values);
      return;
    case OutputField::kCauchyStress:
      PutTensor(at.sigma, values);
      return;
    case OutputField::kVonMisesStress:
      *values = VonMises(at.sigma);
      return;
    case OutputField::kPressure:
      *values = at.sigma.trace() / 3;
      return;
    case OutputField::kVolumeRatio:
      *values = at.J;
      return;
    case OutputField::kFibreStretch:
      *values = (at.F * at.a0).norm();
      return;
    case OutputField::kFibreDirection: {
      const Vec3 a = at.F * at.a0;
      std::copy(a.begin(), a.end(), values);
      return;
    }
    case OutputField::kGreenLagrangeStrain:
      PutTensor(0.5 * (at.F.transpose() * at.F - Mat3::Identity()), values);
      return;
    case OutputField::kLogarithmicStrain:
      PutTensor(LogarithmicStrain(at.F), values);
      return;
    case OutputField::kPrincipalStrains:
      PutPrincipalValues(LogarithmicStrain(at.F), values);
      return;
    case OutputField::kPrincipalStresses:
      PutPrincipalValues(at.sigma, values);
      return;
    case OutputField::kPrincipalStressDirections:
      PutPrincipalDirections(at.sigma, values);
      return;
    case OutputField::kStrainEnergyDensity:
      *values = at.energy_density;
      return;
    case OutputField::kFibreStress:
      *values = StressAlongFibre(at.sigma, at.F, at.a0);
      return;
    case OutputField::kActiveFibreStress:
      *values = StressAlongFibre(at.sigma - at.passive_sigma, at.F, at.a0);
      return;
    case OutputField::kPassiveFibreStress:
      *values = StressAlongFibre(at.passive_sigma, at.F, at.a0);
      return;
    case OutputField::kInternalForce:
    case OutputField::kReactionForce:
      std::copy(at.force.begin(), at.force.end(), values);
      return;
    case OutputField::kPennationAngle:
      *values = PennationAngle(at.F * at.a0, at.line_of_action);
      return;
  }
}

void PutFromMean(OutputField field, const double* mean, double* values) {
  const OutputFieldInfo& info = InfoOf(field);
  if (field == OutputField::kPrincipalStressDirections) {
    PutPrincipalDirections(Tensor(mean), values);
  } else if (info.mean_of != field) {
    PutPrincipalValues(Tensor(mean), values);
  } else {
    std::copy_n(mean, info.components, values);
    if (info.is_direction) NormalizeDirections({values, info.components});
  }
}

void NormalizeDirections(std::span<double> values) {
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) Eigen::Map<Vec3>(&values[i]).normalize();
}

FieldLocation LocationOf(const OutputFieldInfo& info, const Shape& shape) {
  struct OfElements {
    FieldLocation operator()(const TetShape& s) const {
      return s.mesh.hexahedra.empty() ? FieldLocation::kTetrahedron : FieldLocation::kBrick;
    }
    FieldLocation operator()(const VoxelShape&) const { return FieldLocation::kBrick; }
    FieldLocation operator()(const SurfaceShape&) const { return FieldLocation::kNode; }
  };
  return IsNodal(info) ? FieldLocation::kNode : std::visit(OfElements{}, shape);
}

std::size_t PlacesOf(const OutputFieldInfo& info, const Shape& shape) {
  struct Elements {
    std::size_t operator()(const TetShape& s) const { return ElementCount(s.mesh); }
    std::size_t operator()(const VoxelShape& s) const { return s.mesh.bricks.size(); }
    std::size_t operator()(const SurfaceShape& s) const { return s.mesh.nodes.size(); }
  };
  if (IsNodal(info)) return std::visit([](const auto& s) { return s.mesh.nodes.size(); }, shape);
  return std::visit(Elements{}, shape);
}

void CheckOutputField(OutputField field, std::span<const OutputField> before, const FieldMeans& scene,
                      const std::string& path, Problems& problems) {
  const OutputFieldInfo& info = InfoOf(field);
  if (std::find(before.begin(), before.end(), field) != before.end()) {
    problems.Add(path, "is listed twice", "list each field once");
  } else if (const auto m = static_cast<std::size_t>(scene.method); !info.methods.at(m)) {
    problems.Add(path, std::string("the ") + kMethodNames.at(m) + " method does not provide " + info.name,
                 "omit the field, or use another method");
  } else if (info.needs_fibres && !scene.fibres) {
    problems.Add(path, "no body has fibres", "give a body `fibres`, or omit the field");
  } else if (field == OutputField::kPennationAngle && !scene.line_of_action) {
    problems.Add(path, "there is no line of action to which the angle refers",
                 "give output.line_of_action, a direction such as [0, 0, 1]");
  }
}

}  // namespace fascicle
