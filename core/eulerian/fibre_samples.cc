#include "core/eulerian/fibre_samples.h"

#include <Eigen/LU>

#include <atomic>
#include <utility>

namespace fascicle {
namespace {

constexpr double kRoundOff = 1e-9;  // of barycentric coordinates

// Calls body(number) for the nodes of the grid within a tetrahedron.
template <class Body>
void ForNodesIn(const TetMesh& mesh, const Tetrahedron& tet, const EulerianGrid& grid, const Body& body) {
  const Vec3& origin = mesh.nodes[tet[0]];
  Mat3 edges;
  Vec3 lowest = origin, highest = origin;
  for (int c = 1; c < 4; ++c) {
    edges.col(c - 1) = mesh.nodes[tet[c]] - origin;
    lowest = lowest.cwiseMin(mesh.nodes[tet[c]]);
    highest = highest.cwiseMax(mesh.nodes[tet[c]]);
  }
  const Mat3 inverse = edges.inverse();
  const GridIndex first = grid.PlaceOf(lowest).cell, last = grid.PlaceOf(highest).cell;
  for (std::int32_t k = first[2]; k <= last[2] + 1; ++k) {
    for (std::int32_t j = first[1]; j <= last[1] + 1; ++j) {
      for (std::int32_t i = first[0]; i <= last[0] + 1; ++i) {
        const Vec3 part = inverse * (grid.NodePosition({i, j, k}) - origin);
        if (part.minCoeff() >= -kRoundOff && part.sum() <= 1 + kRoundOff) body(grid.NodeNumber({i, j, k}));
      }
    }
  }
}

// The mean direction of the neighbours that have one; zero if none has.
Vec3 MeanOfNeighbours(const EulerianGrid& grid, const std::vector<Vec3>& direction, std::size_t n) {
  const GridIndex at = grid.NodeAt(n);
  Vec3 sum = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      GridIndex other = at;
      other[axis] += side;
      if (grid.HasNode(other)) sum += direction[grid.NodeNumber(other)];
    }
  }
  return sum.norm() < kRoundOff ? Vec3(Vec3::Zero()) : Vec3(sum.normalized());
}

// Gives nodes without a direction that of neighbours with one, until all have one.
void Spread(const EulerianGrid& grid, ThreadTeam& team, std::vector<Vec3>& direction) {
  std::atomic<bool> any = true;
  while (any) {
    any = false;
    std::vector<Vec3> next = direction;
    team.For(direction.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        if (!direction[n].isZero(0)) continue;
        next[n] = MeanOfNeighbours(grid, direction, n);
        if (!next[n].isZero(0)) any = true;
      }
    });
    direction = std::move(next);
  }
}

}  // namespace

FibreSamples::FibreSamples(const TetMesh& mesh, const FibreField& fibres, const EulerianGrid& samples, ThreadTeam& team)
    : samples_(samples), direction_(samples.node_count(), Vec3::Zero()) {
  if (mesh.tetrahedra.empty()) {
    direction_.assign(direction_.size(), fibres.front());
    return;
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    ForNodesIn(mesh, mesh.tetrahedra[t], samples_, [&](std::size_t number) { direction_[number] = fibres[t]; });
  }
  Spread(samples_, team, direction_);
}

Vec3 FibreSamples::At(const Vec3& X) const {
  const EulerianGrid::Place place = samples_.PlaceOf(X);
  Vec3 sum = Vec3::Zero(), nearest = sum;
  double most = -1;
  for (int c = 0; c < 8; ++c) {
    const double weight = CornerWeight(c, place.within);
    const Vec3& direction = direction_[samples_.Corner(place.cell, c)];
    sum += weight * direction;
    if (weight > most) {
      most = weight;
      nearest = direction;
    }
  }
  return sum.norm() > 0.1 ? sum.normalized() : nearest;
}

}  // namespace fascicle
