#include "core/muscle/bspline_fibres.h"

#include <Eigen/LU>
#include <algorithm>
#include <string>
#include <vector>

#include "core/muscle/fill_fibres.h"

namespace fascicle {

BsplineFibreField BsplineFibres(const TetMesh& mesh, const BsplineLocator& locator, ThreadTeam& team,
                                Problems& problems) {
  constexpr double kFlat = 1e-12;  // relative to the gradient's norm
  std::vector<Vec3> centroids;
  centroids.reserve(mesh.tetrahedra.size());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) centroids.push_back(Centroid(mesh, e));
  const std::vector<BsplineLocation> locations = locator.Locate(centroids, team);

  BsplineFibreField field;
  for (const BsplineLocation& location : locations) {
    team.ThrowIfStopped();
    const Mat3 gradients = locator.solid().At(location.parameters).gradients;
    const Vec3 along = gradients.col(2);
    field.fibres.push_back(along.norm() > kFlat * gradients.norm() ? along.normalized() : Vec3(Vec3::Zero()));
    if (gradients.determinant() <= 0) ++field.folded;
    if (location.inside) continue;
    ++field.outside;
    field.farthest = std::max(field.farthest, location.distance);
  }
  if (2 * field.outside > locations.size()) {
    problems.Add({},
                 std::to_string(field.outside) + " of " + std::to_string(locations.size()) +
                     " tetrahedra lie outside of the B-spline solid",
                 "give its control points in the coordinates and the unit of the mesh");
    field.fibres.clear();
  } else if (const std::size_t empty = FillFromNeighbours(mesh, team.stop(), field.fibres); empty > 0) {
    problems.Add({}, "the B-spline solid has no length along w in " + std::to_string(empty) + " tetrahedra",
                 "its control points must not all be equal along w");
    field.fibres.clear();
  }
  return field;
}

}  // namespace fascicle
