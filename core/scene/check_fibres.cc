#include <algorithm>
#include <cmath>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

bool Needs(const Material& material) {
  return std::visit([](const auto& law) { return law.kNeedsFibres; }, material);
}

//   needed  whether the body's own law needs fibres
//   count   required number of directions, if there are any
void CheckField(const FibreField& fibres, bool needed, std::size_t count, const std::string& path, Problems& problems) {
  if (fibres.empty()) {
    if (needed) {
      problems.Add(path, "this material needs fibre directions",
                   "give constant, file, harmonic or bspline fibres, or choose an isotropic material");
    }
    return;
  }
  if (fibres.size() != count) {
    problems.Add(path,
                 std::to_string(fibres.size()) + " fibre directions for " + std::to_string(count) + " tetrahedra");
    return;
  }
  for (std::size_t e = 0; e < fibres.size(); ++e) {
    // Rounding leaves unit vectors within some 1e-16 of length 1; 1e-6 also accepts those stored as floats.
    if (std::abs(fibres[e].norm() - 1) < 1e-6) continue;
    problems.Add(path, "the fibre direction of tetrahedron " + std::to_string(e) + " is not a unit vector");
    return;
  }
}

void CheckShape(const TetShape& shape, bool needed, const std::string& path, Problems& problems) {
  needed |= std::any_of(shape.materials.more.begin(), shape.materials.more.end(), Needs);
  CheckField(shape.fibres, needed, shape.mesh.tetrahedra.size(), path, problems);
}

// CheckVoxel reports materials with fibres.
void CheckShape(const VoxelShape&, bool, const std::string&, Problems&) {}

void CheckShape(const SurfaceShape& shape, bool needed, const std::string& path, Problems& problems) {
  const std::size_t tetrahedra = shape.filling.tetrahedra.size();
  CheckField(shape.fibres, needed, tetrahedra > 0 ? tetrahedra : 1, path, problems);
}

}  // namespace

void CheckFibres(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string path = JoinPath(IndexPath("bodies", i), "fibres");
    std::visit([&](const auto& shape) { CheckShape(shape, Needs(body.material), path, problems); }, body.shape);
  }
}

}  // namespace fascicle::scene_checks
