#include "core/voxel/free_motions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/base/stop.h"

namespace fascicle {
namespace {

constexpr std::size_t kMostJoined = 60;
constexpr double kZero = 1e-10;  // relative to the largest possible eigenvalue

// Displacement at a place due to the six rigid body modes about `centre`; lengths in units of `unit`.
Eigen::Matrix<double, 3, 6> RigidMotions(const Vec3& place, const Vec3& centre, double unit) {
  const Vec3 r = (place - centre) / unit;
  Eigen::Matrix<double, 3, 6> motions;
  motions << 1, 0, 0, 0, r[2], -r[1],  //
      0, 1, 0, -r[2], 0, r[0],         //
      0, 0, 1, r[1], -r[0], 0;
  return motions;
}

// A supported node, or one shared by several islands.
struct Tie {
  Vec3 place;                         // [m]
  std::uint8_t fixed = 0;             // bits of prescribed components
  std::vector<std::int32_t> islands;  // one for a support, two or more for a shared node
};

struct Island {
  GridIndex first_voxel = {};
  std::int64_t voxels = 0;
  Vec3 centre = Vec3::Zero();  // centre of its ties
  std::vector<std::int32_t> ties;
  std::int32_t joined = 0;  // representative of all islands connected by nodes
};

struct Structure {
  std::vector<Island> islands;
  std::vector<Tie> ties;
  double unit = 1;  // [m]
};

std::int32_t Root(std::vector<Island>& islands, std::int32_t island) {
  while (islands[island].joined != island) island = islands[island].joined = islands[islands[island].joined].joined;
  return island;
}

Structure FindStructure(const VoxelGrid& grid, const VoxelMesh& mesh, const FixedComponents& fixed,
                        const std::stop_token& stop) {
  const Islands found = FindIslands(grid, stop);
  Structure s;
  s.islands.resize(found.voxels.size());
  for (std::size_t a = 0; a < s.islands.size(); ++a) {
    s.islands[a].voxels = found.voxels[a];
    s.islands[a].joined = static_cast<std::int32_t>(a);
  }
  std::int32_t known = 0;
  const auto note_first = [&](std::size_t v, const GridIndex& at) {
    if (found.island[v] == known) s.islands[known++].first_voxel = at;
  };
  ForVoxels(grid, note_first, stop);
  std::int32_t node = 0;
  for (const GridIndex& at : mesh.NodePlaces()) {
    ThrowIfStopped(stop);
    const std::uint8_t fixed_here = fixed.empty() ? 0 : fixed[node];
    ++node;
    Tie tie = {grid.spacing.cwiseProduct(Vec3(at[0], at[1], at[2])), fixed_here, {}};
    for (int c = 0; c < 8; ++c) {
      const GridIndex voxel = {at[0] - (c & 1), at[1] - (c >> 1 & 1), at[2] - (c >> 2)};
      if (grid.MaterialAt(voxel) == 0) continue;
      const std::int32_t island = found.island[grid.IndexOf(voxel)];
      if (std::find(tie.islands.begin(), tie.islands.end(), island) == tie.islands.end()) tie.islands.push_back(island);
    }
    if (fixed_here == 0 && tie.islands.size() < 2) continue;
    const auto number = static_cast<std::int32_t>(s.ties.size());
    for (const std::int32_t island : tie.islands) {
      s.islands[island].ties.push_back(number);
      s.islands[Root(s.islands, island)].joined = Root(s.islands, tie.islands[0]);
    }
    s.ties.push_back(std::move(tie));
  }
  s.unit = grid.spacing.maxCoeff();
  for (Island& island : s.islands) {
    for (const std::int32_t t : island.ties) island.centre += s.ties[t].place / static_cast<double>(island.ties.size());
  }
  return s;
}

std::string Join(const std::string& axes) {
  std::string text;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    if (k > 0) text += k + 1 == axes.size() ? " and " : ", ";
    text += axes[k];
  }
  return text;
}

// Describes the motions spanned by the columns of `motions` (6 rows for one island).
std::string Describe(const Eigen::MatrixXd& motions) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(motions);
  const Eigen::MatrixXd basis = Eigen::MatrixXd(qr.householderQ()).leftCols(qr.rank());
  std::string along, about;
  for (int m = 0; m < 6; ++m) {
    if (basis.row(m).squaredNorm() < 1 - 1e-6) continue;
    (m < 3 ? along : about) += "ijk"[m % 3];
  }
  std::string text;
  if (!along.empty()) text = "moves along " + Join(along);
  if (!about.empty()) text += (text.empty() ? "" : ", ") + ("turns about " + Join(about));
  return text.empty() ? "turns about an axis that is not one of the grid's" : text;
}

// Adds the free motions of connected islands, given the ties to consider.
void AddFreeMotions(const Structure& s, const std::vector<std::int32_t>& members, bool shared_nodes_hold,
                    std::vector<FreeMotion>& free) {
  const auto size = static_cast<Eigen::Index>(6 * members.size());
  const auto place_of = [&](std::int32_t island) {
    return 6 * (std::lower_bound(members.begin(), members.end(), island) - members.begin());
  };
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(size, size);
  std::vector<std::int32_t> ties;
  for (const std::int32_t a : members) ties.insert(ties.end(), s.islands[a].ties.begin(), s.islands[a].ties.end());
  std::sort(ties.begin(), ties.end());
  ties.erase(std::unique(ties.begin(), ties.end()), ties.end());
  for (const std::int32_t t : ties) {
    const Tie& tie = s.ties[t];
    const std::int32_t a = shared_nodes_hold ? tie.islands[0] : members[0];
    const Eigen::Matrix<double, 3, 6> of_a = RigidMotions(tie.place, s.islands[a].centre, s.unit);
    for (int d = 0; d < 3; ++d) {
      if (tie.fixed >> d & 1) N.block<6, 6>(place_of(a), place_of(a)) += of_a.row(d).transpose() * of_a.row(d);
    }
    for (std::size_t k = 1; shared_nodes_hold && k < tie.islands.size(); ++k) {
      const std::int32_t b = tie.islands[k];
      const Eigen::Matrix<double, 3, 6> of_b = RigidMotions(tie.place, s.islands[b].centre, s.unit);
      N.block<6, 6>(place_of(a), place_of(a)) += of_a.transpose() * of_a;
      N.block<6, 6>(place_of(b), place_of(b)) += of_b.transpose() * of_b;
      N.block<6, 6>(place_of(a), place_of(b)) -= of_a.transpose() * of_b;
      N.block<6, 6>(place_of(b), place_of(a)) -= of_b.transpose() * of_a;
    }
  }
  Eigen::VectorXd scale(size);
  for (Eigen::Index k = 0; k < size; ++k) scale[k] = N(k, k) > 0 ? 1 / std::sqrt(N(k, k)) : 1;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * N * scale.asDiagonal());
  const Eigen::Index count = (eigen.eigenvalues().array() < kZero * static_cast<double>(size)).count();
  if (count == 0) return;
  const Eigen::MatrixXd null = scale.asDiagonal() * eigen.eigenvectors().leftCols(count);
  for (const std::int32_t a : members) {
    const Eigen::MatrixXd motions = null.middleRows(place_of(a), 6);
    if (motions.norm() < 1e-6 * null.norm()) continue;
    free.push_back({s.islands[a].first_voxel, s.islands[a].voxels, Describe(motions)});
  }
}

}  // namespace

std::vector<FreeMotion> FindFreeMotions(const VoxelGrid& grid, const VoxelMesh& mesh, const FixedComponents& fixed,
                                        const std::stop_token& stop) {
  Structure s = FindStructure(grid, mesh, fixed, stop);
  std::vector<std::vector<std::int32_t>> members(s.islands.size());
  for (std::size_t a = 0; a < s.islands.size(); ++a) {
    members[Root(s.islands, static_cast<std::int32_t>(a))].push_back(static_cast<std::int32_t>(a));
  }
  std::vector<FreeMotion> free;
  for (const std::vector<std::int32_t>& joined : members) {
    if (joined.empty()) continue;
    if (joined.size() <= kMostJoined) {
      AddFreeMotions(s, joined, true, free);
    } else {
      for (const std::int32_t a : joined) AddFreeMotions(s, {a}, false, free);
    }
  }
  return free;
}

}  // namespace fascicle
