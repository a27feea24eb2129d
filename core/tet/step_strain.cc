#include "core/tet/step_strain.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/tet/element.h"

namespace fascicle {
namespace {

// F maps the edges before to those after; the stretches are the roots of the eigenvalues of F^T F.
double StrainBetween(const Mat3& before, const Mat3& after) {
  const Mat3 F = after * before.inverse();
  Eigen::SelfAdjointEigenSolver<Mat3> eigen;
  eigen.computeDirect(F.transpose() * F, Eigen::EigenvaluesOnly);
  return 0.5 * eigen.eigenvalues().array().max(1e-300).log().abs().maxCoeff();
}

}  // namespace

StepStrain LargestStepStrain(const TetModel& model, const NodalVector& before, const NodalVector& after) {
  StepStrain largest;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const TetBody& body = model.bodies()[b];
    for (std::size_t e = body.tet_begin; e < body.tet_end; ++e) {
      const Tetrahedron& corners = model.corners()[e];
      const double strain = StrainBetween(EdgeMatrix(before, corners), EdgeMatrix(after, corners));
      if (strain > largest.value) largest = {strain, b, model.source_tetrahedron()[e]};
    }
  }
  return largest;
}

}  // namespace fascicle
