// Hexahedra: trilinear coordinates, the boundary, regions, and the built-in shapes made of them.
#include "core/geometry/hexahedron.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>
#include <set>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/mesh_writer.h"
#include "core/geometry/refinement.h"
#include "core/geometry/region.h"
#include "core/geometry/shapes.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

HexahedronNodes RandomHexahedron(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.15, 0.15);
  HexahedronNodes nodes;
  for (int a = 0; a < 8; ++a) {
    nodes[static_cast<std::size_t>(a)] = NodeCoordinates(a) + Vec3(shift(random), shift(random), shift(random));
  }
  return nodes;
}

// Hexahedra of all kinds that a scene can have.
std::vector<TetMesh> Shapes() {
  return {MakeBox(Vec3(0.1, 0, 0), Vec3(0.03, 0.02, 0.01), {4, 3, 2}, Cells::kHexahedra),
          MakeFusiform({.length = 0.1, .belly_radius = 0.02, .end_radius = 0.01}, Cells::kHexahedra),
          MakeTorus({.major_radius = 0.05, .minor_radius = 0.01}, Cells::kHexahedra),
          MakeSphere(0.02, 6, Cells::kHexahedra)};
}

TEST(HexahedronTest, NodesAreInTheOrderOfVtk) {
  const std::array<Vec3, 8> expected = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0),
                                        Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(1, 1, 1), Vec3(0, 1, 1)};
  for (int a = 0; a < 8; ++a) {
    EXPECT_EQ(NodeCoordinates(a), expected[static_cast<std::size_t>(a)]);
    for (int b = 0; b < 8; ++b) EXPECT_EQ(TrilinearWeight(a, NodeCoordinates(b)), a == b ? 1 : 0);
  }
  for (std::size_t c = 0; c < 8; ++c) {
    const Vec3 corner(c & 1, c >> 1 & 1, c >> 2);
    EXPECT_EQ(NodeCoordinates(kBrickOrder[c]), corner);
  }
}

// Slopes against differences, and coordinates of points back.
TEST(HexahedronTest, CoordinatesAreFoundAgain) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> within(-0.2, 1.2);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const HexahedronNodes nodes = RandomHexahedron(seed);
    for (int i = 0; i < 10; ++i) {
      const Vec3 x(within(random), within(random), within(random));
      const Mat3 slopes = TrilinearSlopes(nodes, x);
      for (int d = 0; d < 3; ++d) {
        // Linear along each axis: a difference of any length is exact.
        const Vec3 difference =
            TrilinearValue(nodes, x + 0.5 * Vec3::Unit(d)) - TrilinearValue(nodes, x - 0.5 * Vec3::Unit(d));
        EXPECT_LT((slopes.col(d) - difference).norm(), 1e-14);
      }
      const auto found = CoordinatesIn(nodes, TrilinearValue(nodes, x));
      ASSERT_TRUE(found);
      EXPECT_LT((*found - x).norm(), 1e-12);
    }
  }
}

// Each side of the boundary is two triangles of the boundary of the tetrahedra, which is otherwise the same.
TEST(HexahedronTest, BoundarySidesAreThoseOfTheTetrahedra) {
  for (const TetMesh& mesh : Shapes()) {
    const HexahedralBoundary boundary = BoundaryOfHexahedra(mesh);
    const std::vector<Triangle> surface = BoundaryTriangles(mesh);
    ASSERT_FALSE(surface.empty());
    std::set<Triangle> all(surface.begin(), surface.end());
    ASSERT_EQ(2 * boundary.quads.size(), surface.size());
    for (std::size_t i = 0; i < boundary.quads.size(); ++i) {
      const Quad& q = boundary.quads[i];
      Vec3 of_triangles = Vec3::Zero();
      for (const Triangle& t : boundary.triangles[i]) {
        EXPECT_EQ(all.erase(t), 1u);
        of_triangles += 0.5 * (mesh.nodes[t[1]] - mesh.nodes[t[0]]).cross(mesh.nodes[t[2]] - mesh.nodes[t[0]]);
      }
      const Vec3 of_quad = 0.5 * (mesh.nodes[q[2]] - mesh.nodes[q[0]]).cross(mesh.nodes[q[3]] - mesh.nodes[q[1]]);
      EXPECT_LT((of_quad - of_triangles).norm(), 1e-12 * of_quad.norm());
    }
    EXPECT_TRUE(all.empty());
  }
}

TEST(HexahedronTest, BuiltInShapesAreSound) {
  for (const TetMesh& mesh : Shapes()) {
    ASSERT_EQ(mesh.tetrahedra.size(), 6 * mesh.hexahedra.size());
    EXPECT_EQ(ElementCount(mesh), mesh.hexahedra.size());
    Problems problems;
    CheckMesh(mesh, problems);
    EXPECT_EQ(problems.ToString(), "");
  }
}

TEST(HexahedronTest, ChecksFindFoldedAndForeignHexahedra) {
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3(0.03, 0.02, 0.01), {3, 2, 1}, Cells::kHexahedra);
  const auto problems_of = [](const TetMesh& mesh) {
    Problems problems;
    CheckMesh(mesh, problems);
    return problems.ToString();
  };
  TetMesh folded = box;
  std::rotate(folded.hexahedra[2].begin(), folded.hexahedra[2].begin() + 4, folded.hexahedra[2].end());
  EXPECT_THAT(problems_of(folded), HasSubstr("1 hexahedron is inverted or folded: 2"));
  TetMesh foreign = box;
  std::swap(foreign.hexahedra[0], foreign.hexahedra[5]);
  EXPECT_THAT(problems_of(foreign), HasSubstr("2 hexahedra have other nodes than their tetrahedra: 0, 5"));
  TetMesh fewer = box;
  fewer.hexahedra.pop_back();
  EXPECT_THAT(problems_of(fewer), HasSubstr("36 tetrahedra for 5 hexahedra"));
}

TEST(HexahedronTest, OrientsHexahedraWithTheirTetrahedra) {
  TetMesh mirrored = MakeBox(Vec3::Zero(), Vec3(0.03, 0.02, 0.01), {3, 2, 1}, Cells::kHexahedra);
  for (Vec3& x : mirrored.nodes) x[0] = -x[0];
  EXPECT_TRUE(OrientConsistently(mirrored));
  Problems problems;
  CheckMesh(mirrored, problems);
  EXPECT_EQ(problems.ToString(), "");
}

// Sides, their triangles and elements of regions of a box of 4 x 3 x 2.
TEST(HexahedronTest, RegionsHaveSides) {
  const TetMesh mesh = MakeBox(Vec3::Zero(), Vec3(0.04, 0.03, 0.02), {4, 3, 2}, Cells::kHexahedra);
  const HexahedralBoundary boundary = BoundaryOfHexahedra(mesh);
  const Region end = SelectRegion(mesh, boundary, "end", PlaneSelector{Vec3(0.04, 0, 0), Vec3::UnitX()});
  EXPECT_EQ(end.nodes.size(), 12u);
  EXPECT_EQ(end.sides.size(), 6u);
  EXPECT_EQ(end.triangles.size(), 12u);
  EXPECT_TRUE(end.elements.empty());
  const Region half = SelectRegion(mesh, boundary, "half", BoxSelector{Vec3::Zero(), Vec3(0.021, 0.03, 0.02)});
  EXPECT_EQ(half.elements.size(), 12u);
  const Region top = SelectRegion(mesh, boundary, "top", SideSelector{Vec3::UnitZ(), 0.7, 0.011});
  EXPECT_EQ(top.sides.size(), 12u);
  EXPECT_EQ(top.triangles.size(), 24u);
  EXPECT_EQ(top.elements.size(), 12u);
  const Region corner = Intersection(top, half);
  EXPECT_EQ(corner.sides.size(), 6u);
  EXPECT_EQ(corner.triangles.size(), 12u);
  EXPECT_EQ(corner.elements.size(), 6u);
  for (const Triangle& t : corner.triangles) {
    for (const std::int32_t n : t) EXPECT_LE(mesh.nodes[static_cast<std::size_t>(n)].x(), 0.0201);
  }
}

// Refined: sound, with the same volume and the parts of every tag; a trilinear map remains what it was.
TEST(HexahedronTest, IsRefined) {
  for (TetMesh mesh : Shapes()) {
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) mesh.tetrahedron_tags.push_back(t / 6 % 3 == 0 ? 5 : 6);
    const HexahedralBoundary boundary = BoundaryOfHexahedra(mesh);
    for (std::size_t i = 0; i < boundary.quads.size(); i += 2) {
      for (const Triangle& t : boundary.triangles[i]) mesh.tagged_triangles.push_back(t);
      mesh.triangle_tags.insert(mesh.triangle_tags.end(), 2, 7);
    }
    mesh.tagged_nodes = {mesh.hexahedra[0].begin(), mesh.hexahedra[0].end()};
    mesh.node_tags.assign(8, 9);
    const RefinedHexahedra refined = RefinedIntoHexahedra(mesh);
    const TetMesh& fine = refined.mesh;
    ASSERT_EQ(fine.hexahedra.size(), 8 * mesh.hexahedra.size());
    ASSERT_EQ(fine.tetrahedra.size(), 48 * mesh.hexahedra.size());
    ASSERT_EQ(fine.nodes.size(), mesh.nodes.size() + refined.between.size());
    std::vector<double> of_parents(mesh.hexahedra.size()), of_parts(mesh.hexahedra.size());
    for (std::size_t h = 0; h < fine.hexahedra.size(); ++h) {
      for (const double v : NodeVolumes(NodesOfHexahedron(fine, h))) of_parts[h / 8] += v;
      if (h < mesh.hexahedra.size()) {
        for (const double v : NodeVolumes(NodesOfHexahedron(mesh, h))) of_parents[h] += v;
      }
      EXPECT_EQ(fine.tetrahedron_tags[6 * h], mesh.tetrahedron_tags[6 * (h / 8)]);
    }
    for (std::size_t h = 0; h < of_parents.size(); ++h) EXPECT_NEAR(of_parts[h], of_parents[h], 1e-12 * of_parents[h]);
    const HexahedralBoundary surface = BoundaryOfHexahedra(fine);
    EXPECT_EQ(surface.quads.size(), 4 * boundary.quads.size());
    EXPECT_EQ(SelectRegion(fine, surface, "sides", TagSelector{7}).sides.size(), 4 * ((boundary.quads.size() + 1) / 2));
    EXPECT_EQ(SelectRegion(fine, surface, "nodes", TagSelector{9}).nodes.size(), 27u);
  }
}

// A mesh with tags is written and read as it was: quads of the file become sides of a region.
TEST(HexahedronTest, AFileKeepsThem) {
  TetMesh mesh = MakeBox(Vec3::Zero(), Vec3(0.04, 0.03, 0.02), {4, 3, 2}, Cells::kHexahedra);
  SplitHexahedra(mesh);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) mesh.tetrahedron_tags.push_back(t < 72 ? 1 : 2);
  const HexahedralBoundary boundary = BoundaryOfHexahedra(mesh);
  const Region end = SelectRegion(mesh, boundary, "end", PlaneSelector{Vec3(0.04, 0, 0), Vec3::UnitX()});
  mesh.tagged_triangles = end.triangles;
  mesh.triangle_tags.assign(end.triangles.size(), 7);
  Problems problems;
  const std::string text = GmshText(mesh, {});
  const auto read = ReadMesh({.name = "m.msh", .bytes = text}, problems);
  ASSERT_TRUE(read) << problems.ToString();
  EXPECT_EQ(read->nodes, mesh.nodes);
  EXPECT_EQ(read->hexahedra, mesh.hexahedra);
  EXPECT_EQ(read->tetrahedra, mesh.tetrahedra);
  EXPECT_EQ(read->tetrahedron_tags, mesh.tetrahedron_tags);
  const HexahedralBoundary again = BoundaryOfHexahedra(*read);
  EXPECT_EQ(SelectRegion(*read, again, "end", TagSelector{7}).sides, end.sides);
  EXPECT_EQ(SelectRegion(*read, again, "end", TagSelector{7}).triangles, end.triangles);
  EXPECT_EQ(SelectRegion(*read, again, "first", TagSelector{1}).elements.size(), 12u);
  EXPECT_EQ(SelectRegion(*read, again, "first", TagSelector{1}).sides.size(), 12u + 2 * 4 + 3 * 2);
  const auto split = ReadMesh({.name = "m.msh", .bytes = text, .solids = Solids::kSplit}, problems);
  ASSERT_TRUE(split);
  EXPECT_TRUE(split->hexahedra.empty());
  EXPECT_EQ(split->tetrahedra, mesh.tetrahedra);
}

}  // namespace
}  // namespace fascicle
