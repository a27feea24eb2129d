#ifndef FASCICLE_TESTS_SUPPORT_EULERIAN_SCENES_H_
#define FASCICLE_TESTS_SUPPORT_EULERIAN_SCENES_H_

#include <string>
#include <utility>
#include <vector>

#include "core/geometry/shapes.h"
#include "core/scene/scene.h"

// Small scenes of the eulerian method.
namespace fascicle::testing {

inline constexpr double kCell = 0.01;  // [m]

// The boundary of a box with one corner at the origin, with only its own nodes.
inline TriangleMesh BoxSurface(const Vec3& origin, const Vec3& size, int divisions) {
  const TetMesh mesh = MakeBox(origin, size, {divisions, divisions, divisions});
  TriangleMesh surface;
  std::vector<std::int32_t> number(mesh.nodes.size(), -1);
  for (Triangle triangle : BoundaryTriangles(mesh)) {
    for (std::int32_t& node : triangle) {
      if (number[node] < 0) {
        number[node] = static_cast<std::int32_t>(surface.nodes.size());
        surface.nodes.push_back(mesh.nodes[node]);
      }
      node = number[node];
    }
    surface.triangles.push_back(triangle);
  }
  return surface;
}

// A cube of 5 cm, off the nodes of the grid, with the regions `low` (its lowest layer of 1 cm) and `high` (the nodes of
// its upper side).
inline Body EulerianCube(const std::string& name = "cube") {
  Body body;
  body.name = name;
  body.shape = SurfaceShape{BoxSurface(Vec3::Constant(0.003), Vec3::Constant(0.05), 5), {}, {}, {}};
  body.density = 1000;
  body.material = NeoHookean(std::array{5e3, 0.3});
  TetMesh nodes;
  nodes.nodes = body.surface().mesh.nodes;
  body.regions = {
      SelectRegion(nodes, body.surface().mesh.triangles, "low", BoxSelector{Vec3::Zero(), Vec3(1, 1, 0.013)}),
      SelectRegion(nodes, body.surface().mesh.triangles, "high", SideSelector{Vec3::UnitZ(), 0.1, 0})};
  return body;
}

inline Scene EulerianScene(std::vector<Body> bodies) {
  Scene scene;
  scene.bodies = std::move(bodies);
  scene.method = Method::kEulerian;
  scene.eulerian.cell_size = kCell;
  scene.eulerian.margin = 0.6;
  scene.duration = 0.02;
  scene.output.frame_interval = 0.005;
  return scene;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_EULERIAN_SCENES_H_
