#include "core/eulerian/wave_speed.h"

#include <cmath>

#include "core/eulerian/elasticity.h"

namespace fascicle {
namespace {

// rho c^2 J of waves along a direction n in space: the largest eigenvalue of Q_ij = n_k F_kl A_iljm F_pm n_p, bounded
// by its Frobenius norm, up to a factor of sqrt(3). A: dP/dF, with columns in the column-major order of F.
double Stiffness(const Mat9& A, const Mat3& F, const Vec3& n) {
  const Vec3 N = F.transpose() * n;
  Mat3 Q = Mat3::Zero();
  for (int l = 0; l < 3; ++l) {
    for (int m = 0; m < 3; ++m) Q += N[l] * N[m] * A.block<3, 3>(3 * l, 3 * m);
  }
  return Q.norm();
}

// In a material of that stiffness A at Fe, along the fibre and along the axes.
double FastestIn(const Mat9& A, const Mat3& Fe, const FibreState& fibre, double density) {
  double most = 0;
  for (int axis = 0; axis < 3; ++axis) most = std::max(most, Stiffness(A, Fe, Vec3::Unit(axis)));
  const Vec3 along = Fe * fibre.direction;
  if (along.squaredNorm() > 0) most = std::max(most, Stiffness(A, Fe, along.normalized()));
  return std::sqrt(most / density);
}

}  // namespace

double WaveSpeedAtRest(const EulerianBody& body) {
  return std::visit(
      [&](const auto& law) { return std::sqrt((law.BulkModulus() + 4.0 / 3 * law.ShearModulus()) / body.density); },
      body.material);
}

double FastestWave(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                   const EulerianCells& cells, ThreadTeam& team) {
  // The speed of waves in space grows with the stretch of the material.
  double longest = 1;
  for (const std::size_t c : cells.solid) longest = std::max(longest, cells.F[c].norm() / std::sqrt(3.0));
  double fastest = longest * WaveSpeedAtRest(body);
  std::vector<double> of_cell;
  std::visit(
      [&]<class Law>(const Law& law) {
        if (!Law::kStiffens) return;
        of_cell.resize(cells.solid.size());
        team.For(of_cell.size(), 64, [&](std::size_t begin, std::size_t end) {
          for (std::size_t c = begin; c < end; ++c) {
            const Mat3 Fe = ElasticGradient(body, state, cells, cells.solid[c]);
            const FibreState fibre = FibreOf(body, state, controls, body.grid.CellAt(cells.solid[c]));
            of_cell[c] = FastestIn(law.Tangent(Fe, fibre), Fe, fibre, body.density);
          }
        });
      },
      body.material);
  for (const double wave : of_cell) fastest = std::max(fastest, wave);
  return fastest;
}

}  // namespace fascicle
