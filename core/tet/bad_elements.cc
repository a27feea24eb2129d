#include "core/tet/bad_elements.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tet/points.h"

namespace fascicle {
namespace {

constexpr std::size_t kMaxBadElements = 16;

// Smallest height over a face of a tetrahedron, 3 v / area = |det Ds| / (2 area), or of a parallelepiped, v / area.
double SmallestHeight(const Mat3& Ds, bool is_tetrahedron) {
  const double product =
      std::max({Ds.col(0).cross(Ds.col(1)).norm(), Ds.col(1).cross(Ds.col(2)).norm(), Ds.col(2).cross(Ds.col(0)).norm(),
                is_tetrahedron ? (Ds.col(1) - Ds.col(0)).cross(Ds.col(2) - Ds.col(0)).norm() : 0.0});
  return std::abs(Determinant(Ds)) / product;
}

}  // namespace

BadElements FindBadElements(const TetModel& model, const FibreDrive& drive, const NodalVector& x) {
  BadElements bad;
  const auto look_at = [&]<class Element>(Element, const auto& law, std::size_t e) {
    for (int q = 0; q < Element::kPoints; ++q) {
      const Mat3 F = GradientAt<Element>(model, e, ValuesOf<Element>(model, e, x), q);
      const double J = Determinant(F);
      if (J > 0 && std::isfinite(law.Stress(F, FibreAt<Element>(model, e, drive, q)).sum())) continue;
      bad.inverted |= J <= 0;
      bad.elements.push_back(model.source_element()[e]);
      return;
    }
  };
  for (const TetGroup& group : model.groups()) {
    if (!bad.elements.empty() && group.body != bad.body) break;
    bad.body = group.body;
    model.VisitElement([&](auto element) {
      std::visit(
          [&](const auto& laws) {
            for (std::size_t e = group.tet_begin; e < group.tet_end && bad.elements.size() < kMaxBadElements; ++e) {
              look_at(element, laws[model.law_of()[e]], e);
            }
          },
          group.laws);
    });
  }
  std::sort(bad.elements.begin(), bad.elements.end());
  return bad;
}

BadElements FindElementsAt(const TetModel& model, std::size_t node) {
  BadElements around;
  while (node >= model.bodies()[around.body].node_end) ++around.body;
  for (std::int32_t k = model.node_use_begin()[node]; k < model.node_use_begin()[node + 1]; ++k) {
    if (around.elements.size() == kMaxBadElements) break;
    around.elements.push_back(model.source_element()[model.node_uses()[k] / model.nodes_per_element()]);
  }
  std::sort(around.elements.begin(), around.elements.end());
  return around;
}

BadElements FindThinnestElement(const TetModel& model, const NodalVector& x) {
  BadElements thinnest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const TetBody& body = model.bodies()[b];
    for (std::size_t e = body.tet_begin; e < body.tet_end; ++e) {
      const double height = model.VisitElement([&]<class Element>(Element) {
        return SmallestHeight(MeanEdges(ValuesOf<Element>(model, e, x)), !Element::kIsHexahedron);
      });
      if (!(height < least)) continue;
      least = height;
      thinnest.body = b;
      thinnest.elements = {model.source_element()[e]};
    }
  }
  return thinnest;
}

}  // namespace fascicle
