#include "core/muscle/harmonic_potential.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/muscle/fill_fibres.h"
#include "core/muscle/laplace.h"

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
  if (origin.empty()) problems.Add({}, "the fibres' origin contains no node");
  if (insertion.empty()) problems.Add({}, "the fibres' insertion contains no node");
  if (missing > 0) problems.Add({}, std::to_string(missing) + " nodes of origin and insertion are not in the mesh");
  if (shared > 0) {
    problems.Add({}, std::to_string(shared) + " nodes belong to the fibres' origin and to their insertion",
                 "choose regions at the two ends of the muscle");
  }
  if (problems.count() > before) return std::nullopt;
  return parts;
}

// Solves for the potential at the nodes.
std::optional<std::vector<double>> SolvePotential(const TetMesh& mesh, const std::vector<Part>& parts,
                                                  const std::stop_token& stop) {
  std::vector<bool> fixed;
  Eigen::VectorXd given = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parts.size()));
  for (const Part part : parts) {
    if (part == Part::kInsertion) given[static_cast<Eigen::Index>(fixed.size())] = 1;
    fixed.push_back(part != Part::kFree);
  }
  const auto potential = SolveLaplace(mesh, fixed, given, stop);
  if (!potential) return std::nullopt;
  return std::vector<double>(potential->data(), potential->data() + potential->size());
}

// Unit gradients of the potential; zero where the gradient is negligible.
FibreField GradientDirections(const TetMesh& mesh, const std::vector<double>& potential) {
  constexpr double kFlat = 1e-7;  // relative to the largest gradient; the solver's error is well below
  FibreField gradients;
  gradients.reserve(mesh.tetrahedra.size());
  double steepest = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const LinearElement element = MakeLinearElement(mesh, e);
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

}  // namespace

std::optional<HarmonicPotential> SolveHarmonicPotential(const TetMesh& mesh, std::span<const std::int32_t> origin,
                                                        std::span<const std::int32_t> insertion, Problems& problems,
                                                        const std::stop_token& stop) {
  const auto parts = MarkNodes(mesh.nodes.size(), origin, insertion, problems);
  if (!parts) return std::nullopt;
  auto potential = SolvePotential(mesh, *parts, stop);
  if (!potential) {
    problems.Add({}, "the potential between origin and insertion was not found: the solver did not converge",
                 "check the mesh for flat or inverted tetrahedra");
    return std::nullopt;
  }
  FibreField directions = GradientDirections(mesh, *potential);
  if (const std::size_t empty = FillFromNeighbours(mesh, stop, directions); empty > 0) {
    problems.Add({}, std::to_string(empty) + " tetrahedra have no path to both the fibres' origin and their insertion",
                 "the mesh may have separate parts, or both regions may lie at the same end");
    return std::nullopt;
  }
  return HarmonicPotential{std::move(*potential), std::move(directions)};
}

FibreField HarmonicFibres(const TetMesh& mesh, std::span<const std::int32_t> origin,
                          std::span<const std::int32_t> insertion, Problems& problems, const std::stop_token& stop) {
  auto potential = SolveHarmonicPotential(mesh, origin, insertion, problems, stop);
  return potential ? std::move(potential->directions) : FibreField();
}

}  // namespace fascicle
