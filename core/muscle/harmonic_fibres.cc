#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/geometry/faces.h"
#include "core/muscle/fibre_field.h"

namespace fascicle {
namespace {

enum class Part : std::int8_t { kFree, kOrigin, kInsertion };

// Marks the nodes of both regions.
std::optional<std::vector<Part>> MarkNodes(std::size_t node_count, std::span<const std::int32_t> origin,
                                           std::span<const std::int32_t> insertion, Problems& problems) {
  std::vector<Part> parts(node_count, Part::kFree);
  std::size_t shared = 0, missing = 0;
  const auto mark = [&](std::span<const std::int32_t> nodes, Part part) {
    for (const std::int32_t node : nodes) {
      if (node < 0 || static_cast<std::size_t>(node) >= node_count) {
        ++missing;
        continue;
      }
      Part& marked = parts[static_cast<std::size_t>(node)];
      if (marked != Part::kFree && marked != part) ++shared;
      marked = part;
    }
  };
  mark(origin, Part::kOrigin);
  mark(insertion, Part::kInsertion);
  const std::size_t before = problems.count();
  if (origin.empty()) problems.Add({}, "the fibres' origin holds no node");
  if (insertion.empty()) problems.Add({}, "the fibres' insertion holds no node");
  if (missing > 0) problems.Add({}, std::to_string(missing) + " nodes of origin and insertion are not in the mesh");
  if (shared > 0) {
    problems.Add({}, std::to_string(shared) + " nodes belong to the fibres' origin and to their insertion",
                 "choose regions at the two ends of the muscle");
  }
  if (problems.count() > before) return std::nullopt;
  return parts;
}

// Gradients of the four linear shape functions, [1/m], and the volume [m^3].
struct LinearElement {
  std::array<Vec3, 4> gradients;
  double volume;
};

LinearElement MakeElement(const TetMesh& mesh, std::size_t tetrahedron) {
  std::array<Vec3, 4> X;
  for (std::size_t a = 0; a < 4; ++a) X[a] = mesh.nodes[static_cast<std::size_t>(mesh.tetrahedra[tetrahedron][a])];
  const auto cross = [](const Vec3& a, const Vec3& b) {
    return Vec3(a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x());
  };
  const Vec3 e1 = X[1] - X[0], e2 = X[2] - X[0], e3 = X[3] - X[0];
  const Vec3 face = cross(e2, e3);
  const double six_volumes = e1.dot(face);
  LinearElement element;
  element.volume = six_volumes / 6;
  element.gradients[1] = face / six_volumes;
  element.gradients[2] = cross(e3, e1) / six_volumes;
  element.gradients[3] = cross(e1, e2) / six_volumes;
  element.gradients[0] = -(element.gradients[1] + element.gradients[2] + element.gradients[3]);
  return element;
}

// The harmonic potential at the nodes.
std::optional<std::vector<double>> SolvePotential(const TetMesh& mesh, const std::vector<Part>& parts) {
  constexpr double kTolerance = 1e-12;
  std::vector<double> potential(parts.size(), 0);
  std::vector<int> unknown(parts.size(), -1);
  int unknowns = 0;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (parts[n] == Part::kFree) unknown[n] = unknowns++;
    if (parts[n] == Part::kInsertion) potential[n] = 1;
  }
  if (unknowns == 0) return potential;

  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(16 * mesh.tetrahedra.size());
  Eigen::VectorXd load = Eigen::VectorXd::Zero(unknowns);
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const LinearElement element = MakeElement(mesh, e);
    for (std::size_t a = 0; a < 4; ++a) {
      const std::size_t node_a = static_cast<std::size_t>(mesh.tetrahedra[e][a]);
      if (unknown[node_a] < 0) continue;
      for (std::size_t b = 0; b < 4; ++b) {
        const std::size_t node_b = static_cast<std::size_t>(mesh.tetrahedra[e][b]);
        const double entry = element.volume * element.gradients[a].dot(element.gradients[b]);
        if (unknown[node_b] < 0) {
          load[unknown[node_a]] -= entry * potential[node_b];
        } else {
          entries.emplace_back(unknown[node_a], unknown[node_b], entry);
        }
      }
    }
  }
  Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  if (!laplacian.coeffs().allFinite() || !load.allFinite()) return std::nullopt;  // flat tetrahedra

  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver(laplacian);
  solver.setTolerance(kTolerance);
  const Eigen::VectorXd solution = solver.solve(load);
  if (solver.info() != Eigen::Success || !solution.allFinite()) return std::nullopt;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (unknown[n] >= 0) potential[n] = solution[unknown[n]];
  }
  return potential;
}

// Unit gradients of the potential; zero where it is flat.
FibreField GradientDirections(const TetMesh& mesh, const std::vector<double>& potential) {
  constexpr double kFlat = 1e-7;  // relative to the steepest; the solver's error is well below
  FibreField gradients;
  gradients.reserve(mesh.tetrahedra.size());
  double steepest = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const LinearElement element = MakeElement(mesh, e);
    Vec3 gradient = Vec3::Zero();
    for (std::size_t a = 0; a < 4; ++a) {
      gradient += potential[static_cast<std::size_t>(mesh.tetrahedra[e][a])] * element.gradients[a];
    }
    gradients.push_back(gradient);
    steepest = std::max(steepest, gradient.norm());
  }
  for (Vec3& gradient : gradients) {
    if (gradient.norm() > kFlat * steepest) {
      gradient.normalize();
    } else {
      gradient.setZero();
    }
  }
  return gradients;
}

// Pairs of tetrahedra that share a face.
std::vector<std::pair<std::size_t, std::size_t>> Neighbours(const TetMesh& mesh) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const std::vector<Face> faces = SortedFaces(mesh.tetrahedra);
  for (std::size_t f = 1; f < faces.size(); ++f) {
    if (faces[f].nodes != faces[f - 1].nodes) continue;
    pairs.emplace_back(static_cast<std::size_t>(faces[f - 1].side / 4), static_cast<std::size_t>(faces[f].side / 4));
  }
  return pairs;
}

// Gives tetrahedra without a direction the mean of their neighbours', layer by layer. Returns how many have none left.
std::size_t FillFromNeighbours(const TetMesh& mesh, FibreField& fibres) {
  std::size_t empty =
      static_cast<std::size_t>(std::count_if(fibres.begin(), fibres.end(), [](const Vec3& a) { return a.isZero(0); }));
  if (empty == 0) return 0;
  const auto pairs = Neighbours(mesh);
  FibreField sums(fibres.size());
  for (bool progress = true; progress && empty > 0;) {
    progress = false;
    std::fill(sums.begin(), sums.end(), Vec3::Zero());
    for (const auto& [a, b] : pairs) {
      if (fibres[a].isZero(0)) sums[a] += fibres[b];
      if (fibres[b].isZero(0)) sums[b] += fibres[a];
    }
    for (std::size_t e = 0; e < fibres.size(); ++e) {
      if (!fibres[e].isZero(0) || sums[e].norm() < 1e-6) continue;
      fibres[e] = sums[e].normalized();
      --empty;
      progress = true;
    }
  }
  return empty;
}

}  // namespace

FibreField HarmonicFibres(const TetMesh& mesh, std::span<const std::int32_t> origin,
                          std::span<const std::int32_t> insertion, Problems& problems) {
  const auto parts = MarkNodes(mesh.nodes.size(), origin, insertion, problems);
  if (!parts) return {};
  const auto potential = SolvePotential(mesh, *parts);
  if (!potential) {
    problems.Add({}, "the potential between origin and insertion was not found: the solver did not converge",
                 "check the mesh for flat or inverted tetrahedra");
    return {};
  }
  FibreField fibres = GradientDirections(mesh, *potential);
  if (const std::size_t empty = FillFromNeighbours(mesh, fibres); empty > 0) {
    problems.Add({}, std::to_string(empty) + " tetrahedra have no path to both the fibres' origin and their insertion",
                 "the mesh may have separate parts, or both regions may lie at the same end");
    return {};
  }
  return fibres;
}

}  // namespace fascicle
