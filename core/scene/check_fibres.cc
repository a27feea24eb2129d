#include <algorithm>
#include <cmath>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

bool Needs(const Material& material) {
  return std::visit([](const auto& law) { return law.kNeedsFibres; }, material);
}

// The law of an element. CheckMaterials reports parts that do not exist.
const Material& MaterialAt(const Material& own, const Parts<Material>& parts, std::size_t element) {
  const std::int32_t part = element < parts.of.size() ? parts.of[element] : 0;
  return part > 0 && static_cast<std::size_t>(part) <= parts.more.size() ? parts.more[part - 1] : own;
}

// Whether a law with two families of fibres has them where the fibre direction is a0; true for other laws.
bool HasFamiliesAt(const Material& material, const Vec3& a0) {
  return std::visit(
      [&](const auto& law) {
        if constexpr (requires { law.HasFamiliesAt(a0); }) {
          return law.HasFamiliesAt(a0);
        } else {
          return true;
        }
      },
      material);
}

void CheckFamilies(const FibreField& fibres, const Material& own, const Parts<Material>& parts, const std::string& path,
                   Problems& problems) {
  for (std::size_t e = 0; e < fibres.size(); ++e) {
    if (HasFamiliesAt(MaterialAt(own, parts, e), fibres[e])) continue;
    problems.Add(path,
                 "the fibre direction of element " + std::to_string(e) +
                     " and the material's reference direction span no plane for the two families of fibres",
                 "give reference_x, reference_y and reference_z of a direction that is nowhere parallel to the fibres");
    return;
  }
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
    problems.Add(path, std::to_string(fibres.size()) + " fibre directions for " + std::to_string(count) + " elements");
    return;
  }
  for (std::size_t e = 0; e < fibres.size(); ++e) {
    // Rounding leaves unit vectors within some 1e-16 of length 1; 1e-6 also accepts those stored as floats.
    if (std::abs(fibres[e].norm() - 1) < 1e-6) continue;
    problems.Add(path, "the fibre direction of element " + std::to_string(e) + " is not a unit vector");
    return;
  }
}

void CheckShape(const TetShape& shape, const Material& own, const std::string& path, Problems& problems) {
  const auto& more = shape.materials.more;
  const bool needed = Needs(own) || std::any_of(more.begin(), more.end(), Needs);
  CheckField(shape.fibres, needed, ElementCount(shape.mesh), path, problems);
  CheckFamilies(shape.fibres, own, shape.materials, path, problems);
}

// CheckVoxel reports materials with fibres.
void CheckShape(const VoxelShape&, const Material&, const std::string&, Problems&) {}

void CheckShape(const SurfaceShape& shape, const Material& own, const std::string& path, Problems& problems) {
  const std::size_t tetrahedra = shape.filling.tetrahedra.size();
  CheckField(shape.fibres, Needs(own), tetrahedra > 0 ? tetrahedra : 1, path, problems);
  CheckFamilies(shape.fibres, own, {}, path, problems);
}

}  // namespace

void CheckFibres(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string path = JoinPath(IndexPath("bodies", i), "fibres");
    std::visit([&](const auto& shape) { CheckShape(shape, body.material, path, problems); }, body.shape);
  }
}

}  // namespace fascicle::scene_checks
