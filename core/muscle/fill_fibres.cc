#include "core/muscle/fill_fibres.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/stop.h"
#include "core/geometry/faces.h"

namespace fascicle {
namespace {

// Pairs of tetrahedra that share a face.
std::vector<std::pair<std::size_t, std::size_t>> Neighbours(const TetMesh& mesh, const std::stop_token& stop) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const std::vector<Face> faces = SortedFaces(mesh.tetrahedra, stop);
  for (std::size_t f = 1; f < faces.size(); ++f) {
    if (faces[f].nodes != faces[f - 1].nodes) continue;
    pairs.emplace_back(static_cast<std::size_t>(faces[f - 1].side / 4), static_cast<std::size_t>(faces[f].side / 4));
  }
  return pairs;
}

}  // namespace

std::size_t FillFromNeighbours(const TetMesh& mesh, const std::stop_token& stop, FibreField& fibres) {
  std::size_t empty =
      static_cast<std::size_t>(std::count_if(fibres.begin(), fibres.end(), [](const Vec3& a) { return a.isZero(0); }));
  if (empty == 0) return 0;
  const auto pairs = Neighbours(mesh, stop);
  FibreField sums(fibres.size());
  for (bool progress = true; progress && empty > 0;) {
    ThrowIfStopped(stop);
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

}  // namespace fascicle
