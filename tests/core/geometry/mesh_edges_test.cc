#include "core/geometry/mesh_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/geometry/shapes.h"

namespace fascicle {
namespace {

TEST(MeshEdgesTest, AreNumberedAsTetrahedraReferToThem) {
  const TetMesh mesh = MakeBox(Vec3::Zero(), Vec3(1, 2, 3), {3, 2, 2});
  const MeshEdges edges = NumberEdges(mesh);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> numbers;
  ASSERT_EQ(edges.of_tetrahedra.size(), mesh.tetrahedra.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (std::size_t k = 0; k < 6; ++k) {
      const std::int32_t i = mesh.tetrahedra[t][static_cast<std::size_t>(kTetEdges[k][0])],
                         j = mesh.tetrahedra[t][static_cast<std::size_t>(kTetEdges[k][1])];
      const auto number = numbers.try_emplace(std::minmax(i, j), static_cast<std::int32_t>(numbers.size())).first;
      ASSERT_EQ(edges.of_tetrahedra[t][k], number->second);
      ASSERT_EQ(edges.Between(j, i), number->second);
    }
  }
  EXPECT_EQ(edges.ends.size(), numbers.size());
  for (const auto& [ends, number] : numbers) {
    EXPECT_EQ(edges.ends[static_cast<std::size_t>(number)], (std::array<std::int32_t, 2>{ends.first, ends.second}));
  }
  // Opposite corners of the box have no edge between them.
  EXPECT_EQ(edges.Between(0, static_cast<std::int32_t>(mesh.nodes.size()) - 1), -1);
  EXPECT_EQ(NumberEdges(TetMesh{}).Between(0, 1), -1);
}

TEST(MeshEdgesTest, MiddlesAreThoseOfCurvedEdges) {
  TetMesh mesh = MakeBox(Vec3::Zero(), Vec3::Ones(), {1, 1, 1});
  const MeshEdges edges = NumberEdges(mesh);
  const auto [i, j] = edges.ends[4];
  mesh.curved_edges = {{{j, i}, Vec3(7, 8, 9)}};
  const std::vector<Vec3> middles = EdgeMiddles(mesh, edges);
  ASSERT_EQ(middles.size(), edges.ends.size());
  EXPECT_EQ(middles[4], Vec3(7, 8, 9));
  const auto [a, b] = edges.ends[5];
  EXPECT_EQ(middles[5], 0.5 * (mesh.nodes[a] + mesh.nodes[b]));
}

// A side has the edges between its nodes.
TEST(MeshEdgesTest, AreWithinSidesAndElements) {
  const TetMesh mesh = MakeBox(Vec3::Zero(), Vec3(3, 3, 1), {3, 3, 1});
  const MeshEdges edges = NumberEdges(mesh);
  const std::vector<Triangle> boundary = BoundaryTriangles(mesh);
  std::vector<std::int32_t> lower;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() == 0) lower.push_back(static_cast<std::int32_t>(n));
  }
  const std::vector<bool> within = EdgesWithin(mesh, edges, boundary, lower);
  std::size_t count = 0;
  for (std::size_t edge = 0; edge < within.size(); ++edge) {
    const auto [i, j] = edges.ends[edge];
    EXPECT_EQ(within[edge], mesh.nodes[i].z() == 0 && mesh.nodes[j].z() == 0);
    count += within[edge];
  }
  EXPECT_EQ(count, 3u * 4 + 4 * 3 + 9);  // along x, along y, diagonals
  // All nodes: with all corners of every tetrahedron inside, every edge is.
  std::vector<std::int32_t> all(mesh.nodes.size());
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<std::int32_t>(n);
  const std::vector<bool> everywhere = EdgesWithin(mesh, edges, boundary, all);
  EXPECT_EQ(std::count(everywhere.begin(), everywhere.end(), true), static_cast<std::ptrdiff_t>(edges.ends.size()));
}

}  // namespace
}  // namespace fascicle
