#include "core/geometry/bspline_solid.h"

#include <utility>

#include "core/base/check.h"

namespace fascicle {

BsplineSolid::BsplineSolid(Bases bases, std::vector<Vec3> controls)
    : bases_(std::move(bases)), controls_(std::move(controls)) {
  std::size_t expected = 1;
  for (const BsplineBasis& basis : bases_) expected *= static_cast<std::size_t>(basis.size());
  FASCICLE_CHECK(controls_.size() == expected, "one control point for each product of basis functions");
}

BsplineSolid::Point BsplineSolid::At(const Vec3& parameters) const {
  const BsplineBasis::Local u = bases_[0].At(parameters[0]), v = bases_[1].At(parameters[1]),
                            w = bases_[2].At(parameters[2]);
  const auto functions = [&](int direction) { return static_cast<std::size_t>(bases_[direction].degree()) + 1; };
  const std::size_t nu = static_cast<std::size_t>(bases_[0].size()), nv = static_cast<std::size_t>(bases_[1].size());
  Point point{Vec3::Zero(), Mat3::Zero()};
  for (std::size_t k = 0; k < functions(2); ++k) {
    for (std::size_t j = 0; j < functions(1); ++j) {
      const std::size_t row =
          nu * (static_cast<std::size_t>(v.first) + j + nv * (static_cast<std::size_t>(w.first) + k));
      Vec3 position = Vec3::Zero(), along = Vec3::Zero();
      for (std::size_t i = 0; i < functions(0); ++i) {
        const Vec3& q = controls_[row + static_cast<std::size_t>(u.first) + i];
        position += u.value[i] * q;
        along += u.slope[i] * q;
      }
      point.position += v.value[j] * w.value[k] * position;
      point.gradients.col(0) += v.value[j] * w.value[k] * along;
      point.gradients.col(1) += v.slope[j] * w.value[k] * position;
      point.gradients.col(2) += v.value[j] * w.slope[k] * position;
    }
  }
  return point;
}

}  // namespace fascicle
