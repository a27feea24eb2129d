// Rigid motions of a part about its centre c: x -> u + w x (x - c), as vectors of six components (u, w), with lengths
// in units of the part's radius. Those that move no prescribed component are the null space of the sum of outer
// products of rows, one row for each prescribed component.
#include "core/scene/free_motions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/base/vector_text.h"

namespace fascicle {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Motions = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Constrained motions have eigenvalues above this, relative to the largest. A support whose extent is below its root,
// relative to the part's, counts as a point or a line.
constexpr double kNone = 1e-10;
constexpr double kAligned = 1e-6;

// The part of each node, by the lowest of its nodes.
std::vector<std::int32_t> PartsOfNodes(const TetMesh& mesh) {
  std::vector<std::int32_t> parent(mesh.nodes.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t n) {
    while (parent[n] != n) n = parent[n] = parent[parent[n]];
    return n;
  };
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (int c = 1; c < 4; ++c) {
      const std::int32_t a = root(t[0]), b = root(t[c]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::size_t n = 0; n < parent.size(); ++n) parent[n] = root(static_cast<std::int32_t>(n));
  return parent;
}

struct Part {
  std::size_t tetrahedra = 0, nodes = 0;
  Vec3 centre = Vec3::Zero();
  double radius = 0;
  std::vector<std::pair<std::int32_t, int>> held;  // node and axis
};

// By the lowest node of each part.
std::vector<Part> PartsOf(const Body& body, const std::vector<std::int32_t>& part_of) {
  const TetMesh& mesh = body.tet().mesh;
  std::vector<Part> parts(mesh.nodes.size());
  for (const Tetrahedron& t : mesh.tetrahedra) ++parts[part_of[t[0]]].tetrahedra;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    Part& part = parts[part_of[n]];
    ++part.nodes;
    part.centre += (mesh.nodes[n] - part.centre) / static_cast<double>(part.nodes);
  }
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    Part& part = parts[part_of[n]];
    part.radius = std::max(part.radius, (mesh.nodes[n] - part.centre).norm());
  }
  for (const Constraint& constraint : body.constraints) {
    for (const std::int32_t n : body.regions[constraint.region].nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        if (constraint.axes[axis]) parts[part_of[n]].held.emplace_back(n, axis);
      }
    }
  }
  for (const Load& load : body.loads) {
    const auto* springs = std::get_if<Springs>(&load.kind);
    if (springs == nullptr) continue;
    for (const std::int32_t n : body.regions[load.region].nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        if (springs->stiffness[axis] > 0) parts[part_of[n]].held.emplace_back(n, axis);
      }
    }
  }
  return parts;
}

Motions FreeMotionsOf(const Part& part, const std::vector<Vec3>& nodes) {
  Mat6 sum = Mat6::Zero();
  for (const auto& [node, axis] : part.held) {
    const Vec3 unit = Vec3::Unit(axis), r = (nodes[node] - part.centre) / part.radius;
    Vec6 row;
    row << unit, r.cross(unit);  // unit . (u + w x r)
    sum += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat6> eigen(sum);
  const Eigen::Index count = (eigen.eigenvalues().array() <= kNone * eigen.eigenvalues()[5]).count();
  return eigen.eigenvectors().leftCols(count);
}

// An orthonormal basis of the columns' span.
Eigen::MatrixXd BasisOf(const Eigen::MatrixXd& columns) {
  if (columns.cols() == 0) return columns;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(columns, Eigen::ComputeThinU);
  const Eigen::Index rank = (svd.singularValues().array() > kAligned).count();
  return svd.matrixU().leftCols(rank);
}

std::string TextOf(Vec3 v) {
  for (double& x : v) x = std::abs(x) < 1e-12 ? 0 : x;
  return VectorText(v);
}

// The axes of a span of directions, such as "x and y"; the directions themselves if it is not aligned with axes.
std::string Names(const Eigen::MatrixXd& span) {
  std::vector<std::string> names;
  for (int axis = 0; axis < 3; ++axis) {
    if (span.row(axis).squaredNorm() > 1 - kAligned) names.emplace_back(1, "xyz"[axis]);
  }
  if (static_cast<Eigen::Index>(names.size()) != span.cols()) {
    names.clear();
    for (Eigen::Index k = 0; k < span.cols(); ++k) names.push_back(TextOf(span.col(k)));
  }
  std::string text = names[0];
  for (std::size_t k = 1; k < names.size(); ++k) text += (k + 1 == names.size() ? " and " : ", ") + names[k];
  return text;
}

// The motions' translations: those without rotation.
Eigen::MatrixXd TranslationsOf(const Motions& free) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(free.bottomRows(3), Eigen::ComputeFullV);
  const Eigen::Index rank = (svd.singularValues().array() > kAligned).count();
  const Eigen::MatrixXd none = svd.matrixV().rightCols(free.cols() - rank);
  return BasisOf(free.topRows(3) * none);
}

// The point nearest to the centre that all of the motions leave at rest, if there is one.
std::optional<Vec3> FixedPoint(const Part& part, const Motions& free) {
  Eigen::MatrixXd A(3 * free.cols(), 3);
  Eigen::VectorXd b(3 * free.cols());
  for (Eigen::Index k = 0; k < free.cols(); ++k) {
    const Vec3 u = free.col(k).head<3>(), w = free.col(k).tail<3>();
    for (int axis = 0; axis < 3; ++axis) A.block<3, 1>(3 * k, axis) = w.cross(Vec3::Unit(axis));
    b.segment<3>(3 * k) = -u;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Vec3 r = svd.solve(b);
  if ((A * r - b).norm() > kAligned) return std::nullopt;
  return part.centre + part.radius * r;
}

std::string Describe(const Part& part, const Motions& free) {
  const Eigen::MatrixXd along = TranslationsOf(free), about = BasisOf(free.bottomRows(3));
  std::string text;
  if (along.cols() > 0) text = "moves along " + Names(along);
  if (about.cols() == 0) return text;
  if (along.cols() > 0) return text + ", turns about " + Names(about);
  const std::optional<Vec3> point = FixedPoint(part, free);
  if (!point) return "turns about " + Names(about);
  if (about.cols() == 1) return "turns about the line through " + TextOf(*point) + " m along " + Names(about);
  return "turns about the point " + TextOf(*point) + " m";
}

}  // namespace

std::vector<FreePart> FindFreeParts(const Body& body) {
  const std::vector<Vec3>& nodes = body.tet().mesh.nodes;
  const std::vector<std::int32_t> part_of = PartsOfNodes(body.tet().mesh);
  const std::vector<Part> parts = PartsOf(body, part_of);
  std::vector<FreePart> found;
  std::size_t count = 0;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (parts[n].nodes == 0) continue;
    ++count;
    const Motions free = FreeMotionsOf(parts[n], nodes);
    if (free.cols() > 0) found.push_back({parts[n].tetrahedra, 1, nodes[n], Describe(parts[n], free)});
  }
  for (FreePart& part : found) part.parts = count;
  return found;
}

}  // namespace fascicle
