#include "core/tet/bad_elements.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tet/element.h"

namespace fascicle {
namespace {

constexpr std::size_t kMaxBadElements = 16;

// Smallest height over a face: 3 v / area = |det Ds| / (2 area).
double SmallestHeight(const Mat3& Ds) {
  const double twice_area =
      std::max({Ds.col(0).cross(Ds.col(1)).norm(), Ds.col(1).cross(Ds.col(2)).norm(), Ds.col(2).cross(Ds.col(0)).norm(),
                (Ds.col(1) - Ds.col(0)).cross(Ds.col(2) - Ds.col(0)).norm()});
  return std::abs(Determinant(Ds)) / twice_area;
}

}  // namespace

BadElements FindBadElements(const TetModel& model, std::span<const double> activation, const NodalVector& x) {
  BadElements bad;
  for (std::size_t b = 0; b < model.bodies().size() && bad.elements.empty(); ++b) {
    const TetBody& body = model.bodies()[b];
    bad.body = b;
    std::visit(
        [&](const auto& law) {
          for (std::size_t e = body.tet_begin; e < body.tet_end && bad.elements.size() < kMaxBadElements; ++e) {
            const Mat3 F = EdgeMatrix(x, model.corners()[e]) * model.Dm_inverse()[e];
            const Mat3 P = law.Stress(F, FibreState{model.fibres()[e], activation[b]});
            const double J = Determinant(F);
            if (J > 0 && std::isfinite(P.sum())) continue;
            bad.inverted |= J <= 0;
            bad.elements.push_back(static_cast<std::int64_t>(e - body.tet_begin));
          }
        },
        body.source->material);
  }
  return bad;
}

BadElements FindThinnestElement(const TetModel& model, const NodalVector& x) {
  BadElements thinnest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const TetBody& body = model.bodies()[b];
    for (std::size_t e = body.tet_begin; e < body.tet_end; ++e) {
      const double height = SmallestHeight(EdgeMatrix(x, model.corners()[e]));
      if (!(height < least)) continue;
      least = height;
      thinnest.body = b;
      thinnest.elements = {static_cast<std::int64_t>(e - body.tet_begin)};
    }
  }
  return thinnest;
}

}  // namespace fascicle
