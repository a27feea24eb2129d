#include "core/eulerian/plasticity.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>

#include "core/base/von_mises.h"
#include "core/eulerian/forces.h"
#include "core/eulerian/interpolation.h"
#include "core/eulerian/surface.h"

namespace fascicle {
namespace {

// Nodes further outside than that are not asked for [spacings].
constexpr double kReach = 1.8;

// What flows away of an elastic gradient: V (S / det(S)^(1/3))^-gamma V^T.
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

void FlowPlastically(const EulerianBody& body, double dt, ThreadTeam& team, EulerianState& state) {
  const EulerianGrid samples = PlasticGrid(body);
  const double part = body.plasticity->relaxation_time > 0 ? -std::expm1(-dt / body.plasticity->relaxation_time) : 1;
  const KnownField map = {&state.X, &state.known};
  team.For(state.plastic.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const Vec3 X = samples.NodePosition(samples.NodeAt(n));
      if (body.shape.Distance(X) > kReach * samples.spacing) continue;
      CarryPoint(body.grid, map, X, state.plastic_places[n]);
      const auto here = InterpolateWithGradient(body.grid, map, state.plastic_places[n]);
      if (!here || !(here->gradient.determinant() > 0)) continue;
      const Mat3 Fe = here->gradient.inverse() * state.plastic[n];
      const FibreState fibre = body.fibre ? body.fibre(X, state.time) : FibreState{};
      const double stress = VonMises(CauchyStress(body, Fe, fibre));
      if (!(stress > body.plasticity->yield_stress)) continue;
      const double gamma = (1 - body.plasticity->yield_stress / stress) * part;
      state.plastic[n] = Unimodular(state.plastic[n] * FlowOf(Fe, gamma));
    }
  });
}

}  // namespace fascicle
