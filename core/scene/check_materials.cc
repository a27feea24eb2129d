#include <cmath>

#include "core/scene/check_parts.h"
#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

// Small-strain elasticity has no second Piola-Kirchhoff stress, which branches follow.
void CheckSeries(const PronySeries& series, const Material& material, const std::string& path, Problems& problems) {
  if (series.terms.empty()) return;
  const std::string where = JoinPath(path, "viscoelasticity");
  if (series.terms.size() > PronySeries::kMostTerms) {
    problems.Add(where, "has " + std::to_string(series.terms.size()) + " terms",
                 "at most " + std::to_string(PronySeries::kMostTerms));
  }
  for (std::size_t i = 0; i < series.terms.size(); ++i) {
    const PronyTerm& term = series.terms[i];
    if (!(term.strength > 0 && std::isfinite(term.strength))) {
      problems.Add(JoinPath(where, IndexPath("strengths", i)), "must be a finite number above 0", "omit the term");
    }
    if (!(term.time > 0 && std::isfinite(term.time))) {
      problems.Add(JoinPath(where, IndexPath("times", i)), "must be a finite time above 0 s");
    }
  }
  if (std::holds_alternative<LinearElastic>(material)) {
    problems.Add(where, "linear_elastic is for small strains without rotation, and not viscoelastic",
                 "use corotated_linear or another law");
  }
}

void CheckShape(const TetShape& shape, const std::string& path, Problems& problems) {
  CheckParts(shape.materials, ElementCount(shape.mesh), path, problems);
  const std::size_t parts = shape.materials.more.size();
  if (!shape.viscoelasticity.empty() && shape.viscoelasticity.size() != parts) {
    problems.Add(path, std::to_string(shape.viscoelasticity.size()) + " viscoelasticities for " +
                           std::to_string(parts) + " materials");
    return;
  }
  for (std::size_t k = 0; k < shape.viscoelasticity.size(); ++k) {
    CheckSeries(shape.viscoelasticity[k], shape.materials.more[k], path + "[" + std::to_string(k) + "].material",
                problems);
  }
}

void CheckShape(const VoxelShape& shape, const std::string& path, Problems& problems) {
  CheckParts(shape.materials, shape.mesh.bricks.size(), path, problems);
}

void CheckShape(const SurfaceShape&, const std::string&, Problems&) {}

}  // namespace

void CheckMaterials(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const std::string path = JoinPath(IndexPath("bodies", i), "region_materials");
    std::visit([&](const auto& shape) { CheckShape(shape, path, problems); }, scene.bodies[i].shape);
    CheckSeries(scene.bodies[i].viscoelasticity, scene.bodies[i].material, JoinPath(IndexPath("bodies", i), "material"),
                problems);
  }
}

void RefuseViscoelasticity(const Body& body, const std::string& method, const std::string& path, Problems& problems) {
  if (body.viscoelasticity.terms.empty()) return;
  problems.Add(JoinPath(path, "material.viscoelasticity"), "the " + method + " method has no viscoelastic materials",
               "omit it, or use the tet method");
}

}  // namespace fascicle::scene_checks
