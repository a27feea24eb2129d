#include "core/muscle/laplace.h"

#include <Eigen/Geometry>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include "core/base/stop.h"

namespace fascicle {
namespace {

// The diagonal preconditioner. Conjugate gradients apply it once per iteration, where a stop request can be checked;
// Eigen has no other place for that.
class StoppablePreconditioner : public Eigen::DiagonalPreconditioner<double> {
 public:
  void SetStop(const std::stop_token& stop) { stop_ = stop; }

  template <class Vector>
  auto solve(const Eigen::MatrixBase<Vector>& vector) const {
    ThrowIfStopped(stop_);
    return Eigen::DiagonalPreconditioner<double>::solve(vector);
  }

 private:
  std::stop_token stop_;
};

}  // namespace

LinearElement MakeLinearElement(const TetMesh& mesh, std::size_t tetrahedron) {
  std::array<Vec3, 4> X;
  for (std::size_t a = 0; a < 4; ++a) X[a] = mesh.nodes[static_cast<std::size_t>(mesh.tetrahedra[tetrahedron][a])];
  const Vec3 e1 = X[1] - X[0], e2 = X[2] - X[0], e3 = X[3] - X[0];
  const Vec3 face = e2.cross(e3);
  const double six_volumes = e1.dot(face);
  LinearElement element;
  element.volume = six_volumes / 6;
  element.gradients[1] = face / six_volumes;
  element.gradients[2] = e3.cross(e1) / six_volumes;
  element.gradients[3] = e1.cross(e2) / six_volumes;
  element.gradients[0] = -(element.gradients[1] + element.gradients[2] + element.gradients[3]);
  return element;
}

std::optional<Eigen::MatrixXd> SolveLaplace(const TetMesh& mesh, const std::vector<bool>& fixed, Eigen::MatrixXd values,
                                            const std::stop_token& stop) {
  constexpr double kTolerance = 1e-12;
  std::vector<int> unknown(fixed.size(), -1);
  int unknowns = 0;
  for (std::size_t n = 0; n < fixed.size(); ++n) {
    if (!fixed[n]) unknown[n] = unknowns++;
  }
  if (unknowns == 0) return values;

  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(16 * mesh.tetrahedra.size());
  Eigen::MatrixXd load = Eigen::MatrixXd::Zero(unknowns, values.cols());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    ThrowIfStopped(stop);
    const LinearElement element = MakeLinearElement(mesh, e);
    for (std::size_t a = 0; a < 4; ++a) {
      const std::size_t node_a = static_cast<std::size_t>(mesh.tetrahedra[e][a]);
      if (unknown[node_a] < 0) continue;
      for (std::size_t b = 0; b < 4; ++b) {
        const std::size_t node_b = static_cast<std::size_t>(mesh.tetrahedra[e][b]);
        const double entry = element.volume * element.gradients[a].dot(element.gradients[b]);
        if (unknown[node_b] < 0) {
          load.row(unknown[node_a]) -= entry * values.row(static_cast<Eigen::Index>(node_b));
        } else {
          entries.emplace_back(unknown[node_a], unknown[node_b], entry);
        }
      }
    }
  }
  Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  if (!laplacian.coeffs().allFinite() || !load.allFinite()) return std::nullopt;  // flat tetrahedra

  ThrowIfStopped(stop);
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper, StoppablePreconditioner> solver(
      laplacian);
  solver.setTolerance(kTolerance);
  solver.preconditioner().SetStop(stop);
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    const Eigen::VectorXd solution = solver.solve(load.col(column));
    if (solver.info() != Eigen::Success || !solution.allFinite()) return std::nullopt;
    for (std::size_t n = 0; n < fixed.size(); ++n) {
      if (unknown[n] >= 0) values(static_cast<Eigen::Index>(n), column) = solution[unknown[n]];
    }
  }
  return values;
}

}  // namespace fascicle
