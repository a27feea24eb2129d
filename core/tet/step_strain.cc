#include "core/tet/step_strain.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/tet/points.h"

namespace fascicle {
namespace {

// F maps the edges before to those after; the stretches are the roots of the eigenvalues of F^T F.
double StrainBetween(const Mat3& before, const Mat3& after) {
  const Mat3 F = after * before.inverse();
  Eigen::SelfAdjointEigenSolver<Mat3> eigen;
  eigen.computeDirect(F.transpose() * F, Eigen::EigenvaluesOnly);
  return 0.5 * eigen.eigenvalues().array().max(1e-300).log().abs().maxCoeff();
}

constexpr double kShare = 0.01;

struct ElementStrain {
  double strain = 0, volume = 0;
  std::int64_t element = -1;
};

// Reorders the elements: by strain.
StepStrain ExceededByAShare(std::size_t body, std::vector<ElementStrain>& elements) {
  double whole = 0, above = 0;
  for (const ElementStrain& e : elements) whole += e.volume;
  std::sort(elements.begin(), elements.end(), [](const ElementStrain& a, const ElementStrain& b) {
    return std::pair(b.strain, a.element) < std::pair(a.strain, b.element);
  });
  for (const ElementStrain& e : elements) {
    above += e.volume;
    if (above >= kShare * whole) return {e.strain, body, e.element};
  }
  return {};
}

}  // namespace

StepStrain LargestStepStrain(const TetModel& model, const NodalVector& before, const NodalVector& after) {
  StepStrain largest;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const TetBody& body = model.bodies()[b];
    std::vector<ElementStrain> elements;
    elements.reserve(body.tet_end - body.tet_begin);
    for (std::size_t e = body.tet_begin; e < body.tet_end; ++e) {
      model.VisitElement([&]<class Element>(Element) {
        const Mat3 edges = MeanEdges(ValuesOf<Element>(model, e, before));
        elements.push_back({StrainBetween(edges, MeanEdges(ValuesOf<Element>(model, e, after))),
                            std::abs(edges.determinant()) / 6, model.source_element()[e]});
      });
    }
    const StepStrain of_body = ExceededByAShare(b, elements);
    if (of_body.value > largest.value) largest = of_body;
  }
  return largest;
}

}  // namespace fascicle
