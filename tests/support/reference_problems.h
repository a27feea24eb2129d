#ifndef FASCICLE_TESTS_SUPPORT_REFERENCE_PROBLEMS_H_
#define FASCICLE_TESTS_SUPPORT_REFERENCE_PROBLEMS_H_

#include <cmath>
#include <numbers>
#include <set>

#include "core/tet/element.h"
#include "tests/support/tet_scenes.h"

// The bodies of the FEBio reference problems, with the same loads and supports over one second.
namespace fascicle::testing {

inline MooneyRivlin NearlyIncompressible() { return MooneyRivlin(std::array{0.03e6, 0.01e6, 80e6}); }  // K/mu = 1000

// 10 x 1 x 1 mm, clamped at x = 0, with a downward dead load on the other end [N]; 10 n x n x n hexahedra.
inline Body CantileverBody(int n, const Material& law, double force, const Curve& scale,
                           Cells cells = Cells::kTetrahedra) {
  Body body = BoxBody(Vec3(0.01, 0.001, 0.001), {10 * n, n, n}, law, cells);
  body.constraints = {Fix(kX0)};
  body.loads.push_back({kX1, Traction{Vec3(0, 0, -force / 1e-6)}, scale, {}});
  return body;
}
// Problem a.
inline Body NeoHookeanCantilever(int n, const Curve& scale, Cells cells = Cells::kTetrahedra) {
  return CantileverBody(n, NeoHookean(std::array{1e9, 0.3}), 1, scale, cells);
}
// Problem f.
inline Body LockingCantilever(int n, const Curve& scale, Cells cells = Cells::kTetrahedra) {
  return CantileverBody(n, NearlyIncompressible(), 5e-4, scale, cells);
}
inline const Vec3 kCantileverTip(0.01, 0.0005, 0.0005);

// Problem b: a cube of 10 mm whose top is displaced upwards along `lift` [m]; n^3 hexahedra.
inline Body ClampedCube(int n, const Material& law, const Curve& lift, Cells cells = Cells::kTetrahedra) {
  Body body = BoxBody(Vec3::Constant(0.01), {n, n, n}, law, cells);
  Constraint top = Fix(kZ1);
  top.motion.translation[2] = lift;
  body.constraints = {Fix(kZ0), top};
  return body;
}

// Maps a mesh from parameter space, including its mid-edge nodes.
template <class Map>
void Place(const Map& place, TetMesh& mesh) {
  std::set<std::array<std::int32_t, 2>> edges;
  const auto add = [&](std::int32_t a, std::int32_t b) {
    const auto [i, j] = std::minmax(a, b);
    if (!edges.insert({i, j}).second) return;
    mesh.curved_edges.push_back({{i, j}, place(0.5 * (mesh.nodes[i] + mesh.nodes[j]))});
  };
  for (const Hexahedron& hexahedron : mesh.hexahedra) {
    for (const auto& [a, b] : kHexEdges) add(hexahedron[a], hexahedron[b]);
  }
  if (mesh.hexahedra.empty()) {
    for (const Tetrahedron& tet : mesh.tetrahedra) {
      for (const auto& [a, b] : kTetEdges) add(tet[a], tet[b]);
    }
  }
  for (Vec3& X : mesh.nodes) X = place(X);
}

// Problem d: a muscle with rounded-square cross-section and fixed ends, n x n x lengthwise hexahedra of parameter
// space.
inline Body ReferenceMuscle(int n, int lengthwise, const Curve& activation, Cells cells = Cells::kTetrahedra) {
  const auto place = [](const Vec3& p) {
    const double radius = 0.006 + 0.008 * std::pow(std::sin(std::numbers::pi * p[2]), 2);  // [m]
    return Vec3(radius * p[0] * std::sqrt(1 - 0.3 * p[1] * p[1]), radius * p[1] * std::sqrt(1 - 0.3 * p[0] * p[0]),
                0.1 * p[2]);
  };
  TetMesh mesh = MakeBox(Vec3(-1, -1, 0), Vec3(2, 2, 1), {n, n, lengthwise}, cells);
  FibreField fibres;
  for (std::size_t e = 0; e < ElementCount(mesh); ++e) {
    const Vec3 centroid = ElementCentroid(mesh, e), along(0, 0, 1e-6);
    fibres.push_back((place(centroid + along) - place(centroid - along)).normalized());
  }
  Place(place, mesh);
  Body body = MakeBody("muscle", std::move(mesh), Muscle(std::array{0.03e6, 0.01e6, 8e6, 0.3e6, 1.0, 0.05, 6.6, 1.4}));
  body.tet().fibres = std::move(fibres);
  body.constraints = {Fix(kZ0), Fix(kZ1)};
  body.activation = activation;
  return body;
}
inline Body ReferenceMuscle(int n, const Curve& activation, Cells cells = Cells::kTetrahedra) {
  return ReferenceMuscle(n, 4 * n, activation, cells);
}
inline const Vec3 kMuscleBelly(0.014, 0, 0.05);

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_REFERENCE_PROBLEMS_H_
