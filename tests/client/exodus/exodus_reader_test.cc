// Files written by the format's own library.
#include "client/exodus/exodus_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtk_exodusII.h>

#include <map>
#include <string>
#include <vector>

#include "core/base/stop.h"
#include "core/geometry/mesh_checks.h"
#include "tests/support/files.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

struct Block {
  std::string name;  // empty: none
  std::string type;
  int nodes = 0;
  std::vector<int> connectivity;  // counted from 1
};

// A file with blocks, a side set of two sides, and a node set.
std::string WriteExodus(const std::string& path, const std::vector<Vec3>& nodes, const std::vector<Block>& blocks,
                        const std::vector<int>& side_elements, const std::vector<int>& sides,
                        const std::vector<int>& set_nodes) {
  int word = 8, file_word = 8, elements = 0;
  for (const Block& block : blocks) elements += static_cast<int>(block.connectivity.size()) / block.nodes;
  const int file = ex_create(path.c_str(), EX_CLOBBER, &word, &file_word);
  EXPECT_GE(file, 0);
  EXPECT_EQ(
      ex_put_init(file, "a body", 3, static_cast<int>(nodes.size()), elements, static_cast<int>(blocks.size()), 1, 1),
      0);
  std::vector<double> x, y, z;
  for (const Vec3& node : nodes) {
    x.push_back(node.x());
    y.push_back(node.y());
    z.push_back(node.z());
  }
  EXPECT_EQ(ex_put_coord(file, x.data(), y.data(), z.data()), 0);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Block& block = blocks[b];
    const int id = 10 * (static_cast<int>(b) + 1);
    const int count = static_cast<int>(block.connectivity.size()) / block.nodes;
    EXPECT_EQ(ex_put_block(file, EX_ELEM_BLOCK, id, block.type.c_str(), count, block.nodes, 0, 0, 0), 0);
    EXPECT_EQ(ex_put_conn(file, EX_ELEM_BLOCK, id, block.connectivity.data(), nullptr, nullptr), 0);
    if (!block.name.empty()) {
      EXPECT_EQ(ex_put_name(file, EX_ELEM_BLOCK, id, block.name.c_str()), 0);
    }
  }
  EXPECT_EQ(ex_put_set_param(file, EX_SIDE_SET, 5, static_cast<int>(sides.size()), 0), 0);
  EXPECT_EQ(ex_put_set(file, EX_SIDE_SET, 5, side_elements.data(), sides.data()), 0);
  EXPECT_EQ(ex_put_name(file, EX_SIDE_SET, 5, "origin"), 0);
  EXPECT_EQ(ex_put_set_param(file, EX_NODE_SET, 6, static_cast<int>(set_nodes.size()), 0), 0);
  EXPECT_EQ(ex_put_set(file, EX_NODE_SET, 6, set_nodes.data(), nullptr), 0);
  EXPECT_EQ(ex_close(file), 0);
  return path;
}

std::optional<TetMesh> Read(const std::string& path, bool split, MeshRemarks& remarks,
                            std::string* problems = nullptr) {
  Problems own;
  auto mesh = client::ReadExodus(path, split, own, {}, remarks);
  EXPECT_EQ(mesh.has_value(), own.empty());
  if (problems == nullptr) {
    EXPECT_TRUE(mesh) << own.ToString();
  } else {
    *problems = own.ToString();
  }
  return mesh;
}

const std::vector<Vec3> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};

TEST(ExodusReaderTest, Names) {
  EXPECT_TRUE(client::IsExodusName("a/b.e") && client::IsExodusName("b.EXO") && client::IsExodusName("b.g"));
  EXPECT_FALSE(client::IsExodusName("b.msh") || client::IsExodusName("e"));
}

TEST(ExodusReaderTest, BlocksAndSetsBecomeTags) {
  const testing::TemporaryFolder folder;
  MeshRemarks remarks;
  const auto mesh =
      Read(WriteExodus(folder / "m.e", kCorners,
                       {{"belly", "TETRA4", 4, {1, 2, 3, 4}}, {"", "TETRA4", 4, {2, 3, 4, 5}}}, {1}, {4}, {2, 5}),
           false, remarks);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->nodes, kCorners);
  EXPECT_EQ(mesh->tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
  EXPECT_EQ(mesh->tetrahedron_tags, (std::vector<std::int32_t>{1, 2}));
  ASSERT_EQ(remarks.names.size(), 4u);
  EXPECT_EQ(remarks.names[0].name, "belly");
  EXPECT_EQ(remarks.names[1].name, "block_20");
  EXPECT_EQ(remarks.names[2].name, "origin");
  EXPECT_EQ(remarks.names[3].name, "node_set_6");
  // Side 4 of a tetrahedron is that of its first three nodes.
  ASSERT_EQ(mesh->tagged_triangles.size(), 1u);
  Triangle side = mesh->tagged_triangles[0];
  std::sort(side.begin(), side.end());
  EXPECT_EQ(side, (Triangle{0, 1, 2}));
  EXPECT_EQ(mesh->triangle_tags, (std::vector<std::int32_t>{3}));
  EXPECT_EQ(mesh->tagged_nodes, (std::vector<std::int32_t>{1, 4}));
  EXPECT_EQ(mesh->node_tags, (std::vector<std::int32_t>{4, 4}));
}

TEST(ExodusReaderTest, SolidsAreKeptOrSplit) {
  const testing::TemporaryFolder folder;
  const std::vector<Vec3> nodes = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1},    {1, 0, 1},
                                   {1, 1, 1}, {0, 1, 1}, {2, 0, 0}, {2, 0, 1}, {0.5, 0.5, 2}};
  const std::string path = WriteExodus(folder / "m.exo", nodes,
                                       {{"cube", "HEX8", 8, {1, 2, 3, 4, 5, 6, 7, 8}},
                                        {"wedge", "WEDGE6", 6, {2, 9, 3, 6, 10, 7}},
                                        {"top", "PYRAMID5", 5, {5, 6, 7, 8, 11}}},
                                       {1}, {4}, {1});
  MeshRemarks remarks;
  const auto kept = Read(path, false, remarks);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->hexahedra.size(), 3u) << "wedges and pyramids are hexahedra with repeated nodes";
  const auto mesh = Read(path, true, remarks);
  ASSERT_TRUE(mesh);
  std::map<std::int32_t, double> volumes;
  for (std::size_t t = 0; t < mesh->tetrahedra.size(); ++t)
    volumes[mesh->tetrahedron_tags[t]] += SignedVolume(*mesh, t);
  EXPECT_DOUBLE_EQ(volumes[1], 1);
  EXPECT_DOUBLE_EQ(volumes[2], 0.5);
  EXPECT_DOUBLE_EQ(volumes[3], 1.0 / 3);
  Problems own;
  EXPECT_EQ(CheckMesh(*mesh, own).components, 1);
  EXPECT_TRUE(own.empty()) << own.ToString();
  EXPECT_EQ(mesh->tagged_triangles.size(), 2u);
}

TEST(ExodusReaderTest, TenNodes) {
  const testing::TemporaryFolder folder;
  const std::vector<Vec3> nodes = {{0, 0, 0},    {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0},
                                   {1, 1, 0.25}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  MeshRemarks remarks;
  const auto mesh =
      Read(WriteExodus(folder / "m.ex2", nodes, {{"b", "TETRA10", 10, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}}}, {1}, {4}, {1}),
           false, remarks);
  ASSERT_TRUE(mesh);
  ASSERT_EQ(mesh->curved_edges.size(), 1u);
  EXPECT_EQ(mesh->curved_edges[0].ends, (std::array<std::int32_t, 2>{1, 2}));
  EXPECT_EQ(mesh->curved_edges[0].middle, Vec3(1, 1, 0.25));
}

TEST(ExodusReaderTest, OtherFilesAreRefused) {
  const testing::TemporaryFolder folder;
  MeshRemarks remarks;
  std::string problems;
  Read(folder.Write("m.e", "nothing"), false, remarks, &problems);
  EXPECT_THAT(problems, HasSubstr("the file can't be read"));
  const std::string whole = testing::ReadFile(
      WriteExodus(folder / "w.e", kCorners, {{"belly", "TETRA4", 4, {1, 2, 3, 4}}, {"", "TETRA4", 4, {2, 3, 4, 5}}},
                  {1}, {4}, {2}));
  Read(folder.Write("cut.e", whole.substr(0, whole.size() / 2)), false, remarks, &problems);
  EXPECT_THAT(problems, HasSubstr("is the file complete?"));
  std::stop_source source;
  source.request_stop();
  Problems own;
  EXPECT_THROW(client::ReadExodus(folder / "w.e", false, own, source.get_token(), remarks), Stopped);
}

}  // namespace
}  // namespace fascicle
