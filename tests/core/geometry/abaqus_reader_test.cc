#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/geometry/hexahedron.h"
#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

// The two tetrahedra of tests/support/mesh_samples.h, with sets of all kinds.
constexpr const char* kModel = R"(*Heading
** a comment, and a continued keyword
*Node, NSET=all,
 SYSTEM=R
  1, 0., 0., 0.
  2, 1.0, 0, 0
  3, 0, 1, 0
  4, 0, 0, 1e0
 15, 1, 1, 1
*ELEMENT, type=C3D4H, ELSET=Belly
 10, 1, 2,
     3, 4
*Element, TYPE=C3D4
 11, 2, 3, 4, 15
*Elset, elset=tendon, generate
 11, 11, 1
*Elset, elset="both of them"
 belly, Tendon
*Nset, nset=ends
 1, Part-1-1.15
*Surface, type=ELEMENT, name=base
 belly, S1
*Surface, name=skin
 "both of them",
*Material, name=m
*Elastic
 1e4, 0.3
*Step
*End Step
)";

struct AbaqusResult {
  std::optional<TetMesh> mesh;
  MeshRemarks remarks;
  std::string problems;
};

AbaqusResult ReadAbaqus(const std::string& bytes, bool split = false) {
  AbaqusResult result;
  Problems problems;
  result.mesh = ReadMesh({.name = "m.inp", .bytes = bytes, .solids = split ? Solids::kSplit : Solids::kKeep}, problems,
                         {}, &result.remarks);
  EXPECT_EQ(result.mesh.has_value(), problems.empty());
  result.problems = problems.ToString();
  return result;
}

std::int32_t TagOf(const AbaqusResult& result, const std::string& name, int dimension) {
  for (const TagName& tag : result.remarks.names) {
    if (tag.name == name && tag.dimension == dimension) return tag.tag;
  }
  ADD_FAILURE() << "there is no " << name;
  return 0;
}

TEST(AbaqusReaderTest, SetsBecomeTags) {
  const AbaqusResult result = ReadAbaqus(kModel);
  ASSERT_TRUE(result.mesh) << result.problems;
  const TetMesh& mesh = *result.mesh;
  EXPECT_EQ(mesh.nodes, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}));
  EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
  const std::int32_t belly = TagOf(result, "Belly", 3), tendon = TagOf(result, "tendon", 3),
                     both = TagOf(result, "both of them", 3);
  std::vector<std::array<std::int32_t, 2>> tags = mesh.further_tags;
  for (std::int32_t t = 0; t < 2; ++t) tags.push_back({t, mesh.tetrahedron_tags[static_cast<std::size_t>(t)]});
  using Pair = std::array<std::int32_t, 2>;
  EXPECT_THAT(tags, UnorderedElementsAre(Pair{0, belly}, Pair{0, both}, Pair{1, tendon}, Pair{1, both}));
  const std::int32_t ends = TagOf(result, "ends", 0), base = TagOf(result, "base", 2), skin = TagOf(result, "skin", 2);
  std::vector<std::int32_t> nodes;
  for (std::size_t p = 0; p < mesh.node_tags.size(); ++p) {
    if (mesh.node_tags[p] == ends) nodes.push_back(mesh.tagged_nodes[p]);
  }
  EXPECT_THAT(nodes, ElementsAre(0, 4));
  EXPECT_EQ(std::count(mesh.node_tags.begin(), mesh.node_tags.end(), TagOf(result, "all", 0)), 5);
  for (std::size_t i = 0; i < mesh.triangle_tags.size(); ++i) {
    if (mesh.triangle_tags[i] == base) {
      EXPECT_EQ(mesh.tagged_triangles[i], (Triangle{0, 2, 1}));
    }
  }
  EXPECT_EQ(std::count(mesh.triangle_tags.begin(), mesh.triangle_tags.end(), base), 1);
  EXPECT_EQ(std::count(mesh.triangle_tags.begin(), mesh.triangle_tags.end(), skin), 6) << "all but the common side";
}

// Each side of each shape is outward, so the sides together enclose the element's volume.
TEST(AbaqusReaderTest, SidesOfHexahedraWedgesAndPyramids) {
  struct Sample {
    std::string type, nodes, element;
    int sides;
    double volume;
  };
  const std::string cube =
      "1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n9,.5,0,0\n10,.5,.5,1\n";
  for (const Sample& sample :
       {Sample{"C3D8R", cube, "1,2,3,4,5,6,7,8", 6, 1.0}, Sample{"C3D6", cube, "1,2,3,5,6,7", 5, 0.5},
        Sample{"C3D5", cube, "1,2,3,4,10", 5, 1.0 / 3},
        Sample{"C3D20", cube, "1,2,3,4,5,6,7,8,\n9,9,9,9,9,9,9,9,9,9,9,9", 6, 1.0}}) {
    std::string text = "*NODE\n" + sample.nodes + "*ELEMENT, TYPE=" + sample.type + ", ELSET=e\n1," + sample.element +
                       "\n*SURFACE, NAME=all\n";
    for (int s = 1; s <= sample.sides; ++s) text += "1, S" + std::to_string(s) + "\n";
    const AbaqusResult kept = ReadAbaqus(text);
    ASSERT_TRUE(kept.mesh) << kept.problems;
    ASSERT_EQ(kept.mesh->hexahedra.size(), 1u);
    EXPECT_EQ(BoundaryOfHexahedra(*kept.mesh).quads.size(), static_cast<std::size_t>(sample.sides));
    EXPECT_DOUBLE_EQ(TotalVolume(*kept.mesh), sample.volume) << sample.type;
    const AbaqusResult result = ReadAbaqus(text, true);
    ASSERT_TRUE(result.mesh) << result.problems;
    EXPECT_DOUBLE_EQ(TotalVolume(*result.mesh), sample.volume) << sample.type;
    EXPECT_DOUBLE_EQ(EnclosedVolume({result.mesh->nodes, result.mesh->tagged_triangles}), sample.volume) << sample.type;
    EXPECT_THAT(result.remarks.notes.at(0), HasSubstr("split into tetrahedra"));
    // The triangles are those of the tetrahedra.
    std::vector<Triangle> boundary = BoundaryTriangles(*result.mesh), tagged = result.mesh->tagged_triangles;
    for (std::vector<Triangle>* list : {&boundary, &tagged}) {
      for (Triangle& t : *list) std::sort(t.begin(), t.end());
      std::sort(list->begin(), list->end());
    }
    EXPECT_EQ(tagged, boundary) << sample.type;
  }
}

TEST(AbaqusReaderTest, TenNodes) {
  const std::string text =
      "*NODE\n1,0,0,0\n2,2,0,0\n3,0,2,0\n4,0,0,2\n5,1,0,0\n6,1,1,0.25\n7,0,1,0\n8,0,0,1\n9,1,0,1\n10,0,1,1\n"
      "*ELEMENT, TYPE=C3D10M\n1,1,2,3,4,5,6,7,8,9,10\n";
  const AbaqusResult result = ReadAbaqus(text);
  ASSERT_TRUE(result.mesh) << result.problems;
  ASSERT_EQ(result.mesh->curved_edges.size(), 1u);
  EXPECT_EQ(result.mesh->curved_edges[0].ends, (std::array<std::int32_t, 2>{1, 2}));
  EXPECT_EQ(result.mesh->curved_edges[0].middle, Vec3(1, 1, 0.25));
}

TEST(AbaqusReaderTest, WhatIsWrongIsSaidWithItsLine) {
  const std::string text = kModel;
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return ReadAbaqus(changed).problems;
  };
  EXPECT_THAT(ReadAbaqus("").problems, HasSubstr("no keywords"));
  EXPECT_THAT(refusal("2, 1.0, 0, 0", "2, one, 0, 0"), HasSubstr("line 6: expected a coordinate but found `one`"));
  EXPECT_THAT(refusal("2, 1.0, 0, 0", "2, 1.0"), HasSubstr("line 6: a node has a number and three coordinates"));
  EXPECT_THAT(refusal("     3, 4\n", ""), HasSubstr("has 4 nodes, not 2"));
  EXPECT_THAT(refusal(" 11, 2, 3, 4, 15", " 10, 2, 3, 4, 15"), HasSubstr("element 10 is given twice"));
  EXPECT_THAT(refusal(" 11, 2, 3, 4, 15", " 11, 2, 3, 4, 16"), HasSubstr("refers to node 16"));
  EXPECT_THAT(refusal(" belly, Tendon", " belly, tendons"), HasSubstr("there is no set `TENDONS`"));
  EXPECT_THAT(refusal(" belly, S1", " belly, S9"), HasSubstr("expected a side such as S1"));
  EXPECT_THAT(refusal(" belly, S1", " belly, S5"), HasSubstr("element 10 has no side S5"));
  EXPECT_THAT(refusal("SYSTEM=R", "SYSTEM=C"), HasSubstr("not supported"));
  EXPECT_THAT(refusal("*Heading", "*Include, input=other.inp"), HasSubstr("*INCLUDE"));
  EXPECT_THAT(refusal("*Heading", "*Part, name=a\n*End Part\n*Part, name=b"), HasSubstr("a second *PART"));
  EXPECT_THAT(refusal("C3D4\n", "C3D7\n"), HasSubstr("1 volume elements of the file are of kinds"));
  EXPECT_THAT(refusal(" 11, 11, 1", " 11, 2000000000, 1"), HasSubstr("too many numbers"));
}

TEST(AbaqusReaderTest, AnyDamageIsSafe) {
  const std::string text = kModel;
  for (std::size_t at = 0; at < text.size(); ++at) {
    for (const char byte : {'9', '*', ',', '\n', '\0', '\xff', '='}) {
      std::string damaged = text;
      damaged[at] = byte;
      const AbaqusResult result = ReadAbaqus(damaged, true);
      if (!result.mesh) continue;
      for (const auto& [t, tag] : result.mesh->further_tags) {
        ASSERT_LT(static_cast<std::size_t>(t), result.mesh->tetrahedra.size());
      }
      for (const std::int32_t n : result.mesh->tagged_nodes) {
        ASSERT_LT(static_cast<std::size_t>(n), result.mesh->nodes.size());
      }
    }
    ReadAbaqus(text.substr(0, at), true);
  }
}

}  // namespace
}  // namespace fascicle
