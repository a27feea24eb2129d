#ifndef FASCICLE_TESTS_CORE_TET_PLAIN_STIFFNESS_H_
#define FASCICLE_TESTS_CORE_TET_PLAIN_STIFFNESS_H_

#include "core/materials/spd.h"
#include "core/tet/points.h"
#include "core/tet/potential.h"

namespace fascicle::testing {

// The matrix of AssembleStiffness, or its change by projection, point by point from the laws' tangents.
inline BlockValues PlainStiffness(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                                  std::span<const double> acting, const BlockPattern& pattern, bool is_change) {
  BlockValues values(pattern.blocks(), Mat3::Zero());
  model.VisitElement([&]<class Element>(Element) {
    for (const TetGroup& group : model.groups()) {
      std::visit(
          [&]<class Law>(const std::vector<Law>& laws) {
            for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
              const auto nodes = model.NodesOf<Element>(e);
              for (int q = 0; q < Element::kPoints; ++q) {
                const Mat3 F = GradientAt<Element>(model, e, ValuesOf<Element>(model, e, x), q);
                Mat9 H = PointTangent<Element, Law>(potential, model, model.bodies()[group.body],
                                                    laws[model.law_of()[e]], e, q)
                             .At(F);
                AddCofactorTangent(PatchPressure<Element>(model.patches(), acting, e, q), F, H);
                if (is_change) H = (NearestPositive(H) - H).eval();
                const auto G = ShapeGradients<Element>(model, e, q);
                const double volume = model.rest_volume()[Element::kPoints * e + q];
                for (int a = 0; a < Element::kNodes; ++a) {
                  for (int b = 0; b < Element::kNodes; ++b) {
                    Mat3& block = values[pattern.PlaceOf(nodes[a], nodes[b])];
                    for (int j = 0; j < 3; ++j) {
                      for (int l = 0; l < 3; ++l) block += volume * G(j, a) * G(l, b) * H.block<3, 3>(3 * j, 3 * l);
                    }
                  }
                }
              }
            }
          },
          group.laws);
    }
  });
  return values;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CORE_TET_PLAIN_STIFFNESS_H_
