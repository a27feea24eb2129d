#include <algorithm>
#include <map>
#include <utility>

#include "core/geometry/quadratic_hexahedron.h"
#include "core/geometry/solid_cells.h"
#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

bool IsViscoelastic(const Body& body) {
  const auto has_terms = [](const PronySeries& series) { return !series.terms.empty(); };
  const auto* tet = std::get_if<TetShape>(&body.shape);
  return has_terms(body.viscoelasticity) ||
         (tet != nullptr && std::any_of(tet->viscoelasticity.begin(), tet->viscoelasticity.end(), has_terms));
}

using MiddleOfEdge = std::map<std::pair<std::int32_t, std::int32_t>, Vec3>;

// The nodes of a hexahedron of twenty-seven nodes.
QuadraticHexahedronNodes QuadraticNodesOf(const TetMesh& mesh, std::size_t h, const MiddleOfEdge& curved) {
  QuadraticHexahedronNodes X;
  for (std::size_t a = 0; a < 8; ++a) X[a] = mesh.nodes[static_cast<std::size_t>(mesh.hexahedra[h][a])];
  for (std::size_t k = 0; k < 12; ++k) {
    const auto [a, b] = kHexEdges[k];
    const auto at = curved.find(
        std::minmax(mesh.hexahedra[h][static_cast<std::size_t>(a)], mesh.hexahedra[h][static_cast<std::size_t>(b)]));
    X[8 + k] =
        at != curved.end() ? at->second : Vec3(0.5 * (X[static_cast<std::size_t>(a)] + X[static_cast<std::size_t>(b)]));
  }
  FillSidesAndCentre(X);
  return X;
}

// Elements of twenty-seven nodes have more points than those at which meshes are checked.
void CheckQuadraticHexahedra(const TetMesh& mesh, const std::string& path, Problems& problems) {
  constexpr std::size_t kExamples = 5;
  MiddleOfEdge curved;
  for (const CurvedEdge& edge : mesh.curved_edges) curved[std::minmax(edge.ends[0], edge.ends[1])] = edge.middle;
  const auto wedges = std::count_if(mesh.hexahedra.begin(), mesh.hexahedra.end(), [](const Hexahedron& nodes) {
    const auto solid = SolidOf(nodes);
    return !solid || solid->shape != SolidShape::kHexahedron;
  });
  if (wedges > 0) {
    problems.Add(path, "has " + std::to_string(wedges) + " wedges and pyramids, which cannot have 27 nodes",
                 "set `tet.element` to HEXAHEDRAL");
    return;
  }
  std::size_t count = 0;
  std::string examples;
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    if (IsUsable(QuadraticNodesOf(mesh, h, curved))) continue;
    if (++count <= kExamples) examples += (count > 1 ? ", " : "") + std::to_string(h);
  }
  if (count == 0) return;
  problems.Add(path,
               "has " + std::to_string(count) + " hexahedra too distorted for 27 nodes: " + examples +
                   (count > kExamples ? ", ..." : "") + " (counted from 0)",
               "mesh the body again, or set `tet.element` to HEXAHEDRAL");
}

// Hexahedral elements need hexahedra; other elements need meshes whose values are those of tetrahedra.
void CheckElements(const Scene& scene, Problems& problems) {
  const bool wanted = IsHexahedral(scene.tet.element);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto* shape = std::get_if<TetShape>(&scene.bodies[i].shape);
    if (shape == nullptr || shape->mesh.tetrahedra.empty()) continue;
    const std::string path = JoinPath(IndexPath("bodies", i), "mesh");
    if (shape->mesh.hexahedra.empty() != wanted) {
      const bool is_quadratic = scene.tet.element == ElementOrder::kHexahedralQuadratic;
      if (is_quadratic) CheckQuadraticHexahedra(shape->mesh, path, problems);
      continue;
    }
    if (wanted) {
      problems.Add(path, "has tetrahedra, but the scene's elements are hexahedral",
                   "give a mesh of hexahedra, or omit `tet.element`");
    } else {
      problems.Add(path, "has hexahedra, but the scene's elements are tetrahedra", "set `tet.element` to HEXAHEDRAL");
    }
  }
}

// Rigid bodies are obstacles without friction here, whose motion bodies do not change.
void CheckObstacles(const Scene& scene, Problems& problems) {
  for (std::size_t k = 0; k < scene.rigid_bodies.size(); ++k) {
    const std::string path = IndexPath("rigid_bodies", k);
    if (scene.rigid_bodies[k].free) {
      problems.Add(JoinPath(path, "free"), "the tet method does not support rigid bodies that move freely",
                   "prescribe its motion");
    }
    if (scene.rigid_bodies[k].friction > 0) {
      problems.Add(JoinPath(path, "friction"), "the tet method does not support friction", "omit it");
    }
  }
}

}  // namespace

void CheckTet(const Scene& scene, Problems& problems) {
  if (scene.method != Method::kTet) return;
  const TetMethod& method = scene.tet;
  CheckElements(scene, problems);
  CheckObstacles(scene, problems);
  if (method.precision == Precision::kSingle && method.stepping != Stepping::kExplicit &&
      method.stepping != Stepping::kMixed) {
    problems.Add("tet.precision", "implicit steps need double precision", "omit it, or use explicit or mixed stepping");
  }
  if (method.precision == Precision::kSingle && std::any_of(scene.bodies.begin(), scene.bodies.end(), IsViscoelastic)) {
    problems.Add("tet.precision", "viscoelastic materials need double precision", "omit it");
  }
}

}  // namespace fascicle::scene_checks
