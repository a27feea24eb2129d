#include "core/voxel/coarse_and_fine.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.h"

namespace fascicle {
namespace {

// Squared distance of a point, in coarse spacings, from voxel `at`: zero inside.
double SquaredDistance(const Vec3& point, const GridIndex& at) {
  double sum = 0;
  for (int d = 0; d < 3; ++d) {
    const double outside = std::max({at[d] - point[d], point[d] - at[d] - 1, 0.0});
    sum += outside * outside;
  }
  return sum;
}

// The solid voxel nearest to a point, among the voxel that contains it and its neighbours; the first of several.
const VoxelRun* NearestVoxel(const VoxelMesh& mesh, const Vec3& point, GridIndex& nearest) {
  const VoxelRun* found = nullptr;
  double least = std::numeric_limits<double>::infinity();
  GridIndex home;
  for (int d = 0; d < 3; ++d) home[d] = static_cast<std::int32_t>(std::floor(point[d]));
  for (int c = 0; c < 27; ++c) {
    const GridIndex at = {home[0] + c % 3 - 1, home[1] + c / 3 % 3 - 1, home[2] + c / 9 - 1};
    const double distance = SquaredDistance(point, at);
    if (distance >= least) continue;
    const VoxelRun* const run = mesh.RunAt(at);
    if (run == nullptr) continue;
    found = run;
    nearest = at;
    least = distance;
  }
  return found;
}

}  // namespace

InterpolatedField InterpolateToFine(const VoxelMesh& coarse, const VoxelField<double>& u, const VoxelMesh& fine,
                                    int ratio) {
  FASCICLE_CHECK(ratio >= 1 && u.nodes() == coarse.nodes(), "displacements of a coarser level");
  InterpolatedField interpolated = {VoxelField<double>(fine.nodes()), std::vector<bool>(fine.nodes(), false)};
  std::int32_t node = 0;
  for (const GridIndex& place : fine.NodePlaces()) {
    const std::int32_t n = node++;
    const Vec3 point = Vec3(place[0], place[1], place[2]) / ratio;
    GridIndex at = {};
    const VoxelRun* const run = NearestVoxel(coarse, point, at);
    if (run == nullptr) continue;
    interpolated.defined[n] = true;
    for (int c = 0; c < 8; ++c) {
      double weight = 1;
      for (int d = 0; d < 3; ++d) {
        const double part = point[d] - at[d];
        weight *= (c >> d & 1) != 0 ? part : 1 - part;
      }
      interpolated.values.Add(n, weight * u.At(run->node[c >> 1] + at[0] - run->i + (c & 1)));
    }
  }
  return interpolated;
}

CoarseError ErrorOfCoarse(const InterpolatedField& interpolated, const VoxelField<double>& fine) {
  CoarseError error;
  error.field = VoxelField<double>(fine.nodes());
  double squares = 0, of_fine = 0;
  for (std::int32_t n = 0; n < fine.nodes(); ++n) {
    if (!interpolated.defined[n]) {
      ++error.left_out;
      continue;
    }
    const Vec3 difference = interpolated.values.At(n) - fine.At(n);
    error.field.Add(n, difference);
    error.largest = std::max(error.largest, difference.norm());
    squares += difference.squaredNorm();
    of_fine += fine.At(n).squaredNorm();
  }
  error.relative = of_fine > 0 ? std::sqrt(squares / of_fine) : 0;
  return error;
}

}  // namespace fascicle
