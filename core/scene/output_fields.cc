#include "core/scene/output_fields.h"

#include <algorithm>
#include <array>

#include "core/base/von_mises.h"

namespace fascicle {
namespace {

constexpr auto kMotion = FieldSource::kMotion;
constexpr auto kDeformation = FieldSource::kDeformation;
constexpr auto kStress = FieldSource::kStress;

constexpr std::array<bool, 3> kWithFibres = {true, false, true};

constexpr std::array kTable = {
    OutputFieldInfo{OutputField::kVelocity, "velocity", "m/s", 3, kMotion},
    OutputFieldInfo{OutputField::kCauchyStress, "cauchy_stress", "Pa", 6, kStress},
    OutputFieldInfo{OutputField::kVonMisesStress, "von_mises_stress", "Pa", 1, kStress},
    OutputFieldInfo{OutputField::kPressure, "pressure", "Pa", 1, kStress},
    OutputFieldInfo{OutputField::kVolumeRatio, "volume_ratio", "1", 1, kDeformation},
    OutputFieldInfo{OutputField::kFibreStretch, "fibre_stretch", "1", 1, kDeformation, kWithFibres, true},
    OutputFieldInfo{OutputField::kFibreDirection, "fibre_direction", "1", 3, kDeformation, kWithFibres, true, true},
};

constexpr bool IsInOrder() {
  for (std::size_t i = 0; i < kTable.size(); ++i) {
    if (static_cast<std::size_t>(kTable[i].field) != i || kTable[i].components > kMostComponents) return false;
  }
  return true;
}
static_assert(IsInOrder());

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
    case OutputField::kCauchyStress: {
      const Mat3& s = at.sigma;
      for (const double value : {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)}) *values++ = value;
      return;
    }
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
  }
}

void NormalizeDirections(std::span<double> values) {
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) Eigen::Map<Vec3>(&values[i]).normalize();
}

FieldLocation LocationOf(const OutputFieldInfo& info, Method method) {
  if (info.from == FieldSource::kMotion) return FieldLocation::kNode;
  switch (method) {
    case Method::kTet:
      return FieldLocation::kTetrahedron;
    case Method::kVoxel:
      return FieldLocation::kBrick;
    case Method::kEulerian:
      return FieldLocation::kNode;
  }
  return FieldLocation::kNode;
}

std::size_t PlacesOf(const OutputFieldInfo& info, const Shape& shape) {
  struct Elements {
    std::size_t operator()(const TetShape& s) const { return s.mesh.tetrahedra.size(); }
    std::size_t operator()(const VoxelShape& s) const { return s.mesh.bricks.size(); }
    std::size_t operator()(const SurfaceShape& s) const { return s.mesh.nodes.size(); }
  };
  if (info.from == FieldSource::kMotion) return std::visit([](const auto& s) { return s.mesh.nodes.size(); }, shape);
  return std::visit(Elements{}, shape);
}

void CheckOutputField(OutputField field, std::span<const OutputField> before, Method method, bool fibres,
                      const std::string& path, Problems& problems) {
  const OutputFieldInfo& info = InfoOf(field);
  if (std::find(before.begin(), before.end(), field) != before.end()) {
    problems.Add(path, "is listed twice", "list each field once");
  } else if (const auto m = static_cast<std::size_t>(method); !info.methods.at(m)) {
    problems.Add(path, std::string("the ") + kMethodNames.at(m) + " method does not provide " + info.name,
                 "omit the field, or use another method");
  } else if (info.needs_fibres && !fibres) {
    problems.Add(path, "no body has fibres", "give a body `fibres`, or omit the field");
  }
}

}  // namespace fascicle
