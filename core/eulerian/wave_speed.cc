#include "core/eulerian/wave_speed.h"

#include <cmath>

#include "core/eulerian/forces.h"

namespace fascicle {
namespace {

bool NeedsFibres(const Material& material) {
  return std::visit([](const auto& law) { return std::decay_t<decltype(law)>::kNeedsFibres; }, material);
}

// rho c^2 J of waves along n, a direction in space: the largest component of Q_ij = n_k F_kl A_iljm F_pm n_p bounds it,
// up to a factor of 3, by its trace. A: dP/dF, columns by column-major components of F.
double Stiffness(const Mat9& A, const Mat3& F, const Vec3& n) {
  const Vec3 N = F.transpose() * n;
  Mat3 Q = Mat3::Zero();
  for (int l = 0; l < 3; ++l) {
    for (int m = 0; m < 3; ++m) Q += N[l] * N[m] * A.block<3, 3>(3 * l, 3 * m);
  }
  return Q.norm();
}

double WaveIn(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells, std::size_t cell) {
  const Mat3 Fe = ElasticGradient(body, state, cells, cell);
  const FibreState fibre = FibreOf(body, state, body.grid.CellAt(cell));
  const Mat9 A = std::visit([&](const auto& law) { return law.Tangent(Fe, fibre); }, body.material);
  double most = 0;
  for (int axis = 0; axis < 3; ++axis) most = std::max(most, Stiffness(A, Fe, Vec3::Unit(axis)));
  const Vec3 along = Fe * fibre.direction;
  if (along.squaredNorm() > 0) most = std::max(most, Stiffness(A, Fe, along.normalized()));
  return std::sqrt(most / body.density);
}

}  // namespace

double WaveSpeedAtRest(const EulerianBody& body) {
  return std::visit(
      [&](const auto& law) { return std::sqrt((law.BulkModulus() + 4.0 / 3 * law.ShearModulus()) / body.density); },
      body.material);
}

double FastestWave(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells, ThreadTeam& team) {
  // Waves are as many times faster in space as the material is stretched.
  double longest = 1;
  for (const std::size_t c : cells.solid) longest = std::max(longest, cells.F[c].norm() / std::sqrt(3.0));
  double fastest = longest * WaveSpeedAtRest(body);
  if (!NeedsFibres(body.material)) return fastest;
  std::vector<double> of_cell(cells.solid.size());
  team.For(of_cell.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) of_cell[c] = WaveIn(body, state, cells, cells.solid[c]);
  });
  for (const double wave : of_cell) fastest = std::max(fastest, wave);
  return fastest;
}

}  // namespace fascicle
