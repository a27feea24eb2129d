#include "core/muscle/pennation.h"

#include <cmath>
#include <string>

namespace fascicle {
namespace {

// The direction in which the fibre of an element is tilted: 1 towards the normal, -1 away from it, 0 not at all.
double Side(const TetMesh& mesh, std::size_t element, const Pennation& pennation) {
  if (!pennation.mirror_point) return 1;
  const double distance = (ElementCentroid(mesh, element) - *pennation.mirror_point).dot(pennation.normal);
  return distance > 0 ? 1 : distance < 0 ? -1 : 0;
}

}  // namespace

void Pennate(const TetMesh& mesh, const Pennation& pennation, FibreField& fibres, Problems& problems) {
  constexpr double kLeast = 1e-6;  // sine of the angle between fibre and normal
  const Vec3 normal = pennation.normal.stableNormalized();
  const double cosine = std::cos(pennation.angle), sine = std::sin(pennation.angle);
  std::size_t along = 0;
  for (std::size_t e = 0; e < fibres.size(); ++e) {
    Vec3& fibre = fibres[e];
    const Vec3 across = normal - normal.dot(fibre) * fibre;
    const double side = Side(mesh, e, pennation);
    if (across.norm() < kLeast) {
      ++along;
    } else if (side != 0) {
      fibre = (cosine * fibre + side * sine * across.normalized()).normalized();
    }
  }
  if (along > 0) {
    problems.Add("normal", "the fibres of " + std::to_string(along) + " elements are parallel to it",
                 "give a direction across the fibres");
  }
}

}  // namespace fascicle
