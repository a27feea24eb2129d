#include "core/muscle/muscle_solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/muscle/cross_sections.h"
#include "core/muscle/harmonic_potential.h"
#include "core/muscle/laplace.h"

namespace fascicle {
namespace {

constexpr double kMostMissed = 0.05;  // largest rms distance of a fit, relative to the diagonal; muscles have 0.005

// Whether all nodes of a cell have the potential of one region (0 or 1).
template <class Cell>
bool InsideOfARegion(const Cell& cell, const std::vector<double>& potential) {
  const auto all = [&](double value) {
    return std::all_of(cell.begin(), cell.end(),
                       [&](std::int32_t node) { return potential[static_cast<std::size_t>(node)] == value; });
  };
  return all(0) || all(1);
}

// Nodes of the boundary between the regions.
std::vector<bool> LateralNodes(const TetMesh& mesh, const std::vector<double>& potential, const std::stop_token& stop) {
  std::vector<bool> lateral(mesh.nodes.size(), false);
  for (const Triangle& triangle : BoundaryTriangles(mesh, stop)) {
    if (InsideOfARegion(triangle, potential)) continue;
    for (const std::int32_t node : triangle) lateral[static_cast<std::size_t>(node)] = true;
  }
  return lateral;
}

// Nodes of tetrahedra between the regions; a block of nodes within one region has no length.
std::vector<bool> NodesBetween(const TetMesh& mesh, const std::vector<double>& potential) {
  std::vector<bool> between(mesh.nodes.size(), false);
  for (const Tetrahedron& tetrahedron : mesh.tetrahedra) {
    if (InsideOfARegion(tetrahedron, potential)) continue;
    for (const std::int32_t node : tetrahedron) between[static_cast<std::size_t>(node)] = true;
  }
  return between;
}

// Parameters u and v of the nodes.
std::optional<Eigen::MatrixXd> ParametersAcross(const TetMesh& mesh, const std::vector<double>& potential,
                                                const CrossSections& sections, const std::stop_token& stop) {
  const std::vector<bool> lateral = LateralNodes(mesh, potential, stop);
  Eigen::MatrixXd given = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(mesh.nodes.size()), 2);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (!lateral[n]) continue;
    const Eigen::Vector2d radius = sections.Across(mesh.nodes[n], potential[n]).stableNormalized();
    given.row(static_cast<Eigen::Index>(n)) = (Eigen::Vector2d::Constant(0.5) + 0.5 * radius).transpose();
  }
  return SolveLaplace(mesh, lateral, std::move(given), stop);
}

std::vector<SolidSample> MakeSamples(const TetMesh& mesh, const std::vector<double>& potential,
                                     const CrossSections& sections, const Eigen::MatrixXd& across) {
  const std::vector<bool> between = NodesBetween(mesh, potential);
  std::vector<SolidSample> samples;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (!between[n]) continue;
    const auto row = static_cast<Eigen::Index>(n);
    samples.push_back({{across(row, 0), across(row, 1), sections.Along(potential[n])}, mesh.nodes[n]});
  }
  return samples;
}

double Diagonal(const TetMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& X : mesh.nodes) box.extend(X);
  return box.diagonal().norm();
}

std::string Rounded(double value) {
  std::ostringstream text;
  text << std::setprecision(2) << value;
  return text.str();
}

// Keeps at most kMost evenly spaced samples: more would need memory and change nothing.
void Thin(std::vector<SolidSample>& samples) {
  constexpr std::size_t kMost = 100'000;
  const std::size_t stride = (samples.size() + kMost - 1) / kMost;
  if (stride <= 1) return;
  for (std::size_t s = 0; s * stride < samples.size(); ++s) samples[s] = samples[s * stride];
  samples.resize((samples.size() + stride - 1) / stride);
}

std::optional<SolidFit> FitAlong(const TetMesh& mesh, const std::vector<double>& potential,
                                 const MuscleSolidOptions& options, const std::stop_token& stop) {
  const auto sections = CrossSections::Make(mesh, potential);
  if (!sections) return std::nullopt;
  const auto across = ParametersAcross(mesh, potential, *sections, stop);
  if (!across) return std::nullopt;
  std::vector<SolidSample> samples = MakeSamples(mesh, potential, *sections, *across);
  Thin(samples);
  const auto basis = [&](std::size_t d) { return BsplineBasis::Uniform(options.degrees[d], options.controls[d]); };
  return FitBsplineSolid({basis(0), basis(1), basis(2)}, samples, options.smoothing, stop);
}

}  // namespace

std::optional<SolidFit> FitMuscleSolid(const TetMesh& mesh, std::span<const std::int32_t> origin,
                                       std::span<const std::int32_t> insertion, const MuscleSolidOptions& options,
                                       Problems& problems, const std::stop_token& stop) {
  const auto harmonic = SolveHarmonicPotential(mesh, origin, insertion, problems, stop);
  if (!harmonic) return std::nullopt;
  auto fit = FitAlong(mesh, harmonic->values, options, stop);
  if (!fit) {
    problems.Add({}, "no B-spline solid could be fitted to the mesh",
                 "choose regions at the two ends of the muscle, with a surface between them");
  } else if (fit->rms > kMostMissed * Diagonal(mesh)) {
    problems.Add(
        {}, "the fitted B-spline solid is not close to the mesh: its nodes are " + Rounded(fit->rms) + " m off (rms)",
        "refine the mesh along the muscle, or choose regions at its two ends");
    fit.reset();
  }
  return fit;
}

}  // namespace fascicle
