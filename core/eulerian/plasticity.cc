#include "core/eulerian/plasticity.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>

#include "core/base/von_mises.h"
#include "core/eulerian/elasticity.h"
#include "core/eulerian/interpolation.h"
#include "core/eulerian/surface.h"

namespace fascicle {
namespace {

// Nodes farther outside than this are never interpolated from [spacings].
constexpr double kAverageReach = 1.8;

// The plastic increment of an elastic gradient: V (S / det(S)^(1/3))^-gamma V^T.
Mat3 FlowOf(const Mat3& Fe, double gamma) {
  const Eigen::SelfAdjointEigenSolver<Mat3> squares(Fe.transpose() * Fe);
  const Vec3 s = squares.eigenvalues().cwiseSqrt();
  const Vec3 powers = (s / std::cbrt(s.prod())).array().pow(-gamma);
  return squares.eigenvectors() * powers.asDiagonal() * squares.eigenvectors().transpose();
}

Mat3 Unimodular(const Mat3& A) { return A / std::cbrt(A.determinant()); }

}  // namespace

EulerianGrid PlasticGrid(const EulerianBody& body) { return body.shape.MaterialGrid(body.grid.spacing); }

Mat3 PlasticInverse(const EulerianGrid& samples, const std::vector<Mat3>& plastic, const Vec3& X) {
  const EulerianGrid::Place place = samples.PlaceOf(X);
  Mat3 sum = Mat3::Zero();
  for (int c = 0; c < 8; ++c) sum += CornerWeight(c, place.within) * plastic[samples.Corner(place.cell, c)];
  return Unimodular(sum);
}

void FlowPlastically(const EulerianBody& body, const BodyControls& controls, double dt, ThreadTeam& team,
                     EulerianState& state) {
  const EulerianGrid samples = PlasticGrid(body);
  const double part = body.plasticity->relaxation_time > 0 ? -std::expm1(-dt / body.plasticity->relaxation_time) : 1;
  const KnownField map = {&state.X, &state.known};
  const auto flow_at = [&](const auto& law, std::size_t n) {
    const Vec3 X = samples.NodePosition(samples.NodeAt(n));
    if (body.shape.Distance(X) > kAverageReach * samples.spacing) return;
    FindPoint(body.grid, map, X, state.plastic_places[n]);
    const auto here = InterpolateWithGradient(body.grid, map, state.plastic_places[n]);
    if (!here || !(here->gradient.determinant() > 0)) return;
    const Mat3 Fe = here->gradient.inverse() * state.plastic[n];
    const double stress = VonMises(CauchyStress(law, Fe, body.FibreAt(X, controls)));
    if (!(stress > body.plasticity->yield_stress)) return;
    const double gamma = (1 - body.plasticity->yield_stress / stress) * part;
    state.plastic[n] = Unimodular(state.plastic[n] * FlowOf(Fe, gamma));
  };
  std::visit(
      [&](const auto& law) {
        team.For(state.plastic.size(), 64, [&](std::size_t begin, std::size_t end) {
          for (std::size_t n = begin; n < end; ++n) flow_at(law, n);
        });
      },
      body.material);
}

}  // namespace fascicle
