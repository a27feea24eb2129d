#include "core/geometry/near_region.h"

#include <gtest/gtest.h>

#include "core/geometry/mesh_io.h"
#include "core/geometry/mesh_writer.h"
#include "surface_samples.h"

namespace fascicle {
namespace {

// The top of a box beneath a plate.
TEST(NearRegionTest, TrianglesNearAPlate) {
  const TetMesh box = MakeBox({0, 0, 0}, {1, 1, 1}, {4, 4, 4});
  const TriangleMesh plate{{{-1, -1, 1.1}, {3, -1, 1.1}, {-1, 3, 1.1}}, {{0, 1, 2}}};
  const TriangleTree tree(plate);
  const std::vector<Triangle> surface = BoundaryTriangles(box);
  const Region none = SelectNear(box, surface, "r", tree, 0.09);
  EXPECT_TRUE(none.triangles.empty() && none.nodes.empty());
  const Region top = SelectNear(box, surface, "r", tree, 0.11);
  EXPECT_EQ(top.triangles.size(), 32u);
  EXPECT_EQ(top.nodes.size(), 25u);
  for (const std::int32_t n : top.nodes) EXPECT_EQ(box.nodes[n].z(), 1);
  const Region rim = SelectNear(box, surface, "r", tree, 0.36);
  EXPECT_EQ(rim.triangles.size(), 32u + 32u);
}

// Overlapping regions keep all their triangles in the file.
TEST(MeshWriterTest, TagsComeBackAsTheRegionsThatTheyWere) {
  TetMesh mesh = MakeSphere(0.3, 6);
  mesh.nodes[5] += Vec3(1e-17, 1.0 / 3, 0.1) * 1e-3;
  const std::vector<Triangle> surface = BoundaryTriangles(mesh);
  const Region up = SelectRegion(mesh, surface, "up", SideSelector{{0, 0, 1}, 1, 0});
  const Region right = SelectRegion(mesh, surface, "right", SideSelector{{1, 0, 0}, 1, 0});
  std::int32_t tag = 0;
  for (const Region* region : {&up, &right}) {
    ++tag;
    for (const Triangle& triangle : region->triangles) {
      mesh.tagged_triangles.push_back(triangle);
      mesh.triangle_tags.push_back(tag);
    }
  }
  ASSERT_GT(Intersection(up, right).triangles.size(), 0u);
  mesh.tetrahedron_tags.assign(mesh.tetrahedra.size(), 3);
  const std::string text = GmshText(mesh, {{2, 1, "up"}, {2, 2, "right"}, {3, 3, "body"}});
  EXPECT_NE(text.find("$PhysicalNames\n3\n2 1 \"up\"\n2 2 \"right\"\n3 3 \"body\"\n"), std::string::npos);
  Problems problems;
  const auto read = ReadMesh({"m.msh", text, {}}, problems);
  ASSERT_TRUE(read) << problems.ToString();
  EXPECT_EQ(read->nodes, mesh.nodes);
  EXPECT_EQ(read->tetrahedra, mesh.tetrahedra);
  EXPECT_EQ(read->tetrahedron_tags, mesh.tetrahedron_tags);
  for (const auto& [region, number] : {std::pair(&up, 1), std::pair(&right, 2)}) {
    const Region back = SelectRegion(*read, BoundaryTriangles(*read), "r", TagSelector{number});
    EXPECT_EQ(back.nodes, region->nodes);
    EXPECT_EQ(back.triangles, region->triangles);
    EXPECT_TRUE(back.elements.empty());
  }
}

}  // namespace
}  // namespace fascicle
