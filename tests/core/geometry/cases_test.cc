// Files that people have, after reports of users of other programs: the right answer for each.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/region.h"
#include "core/geometry/tetrahedralize.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// The body of most surfaces: a sphere of 20 across [mm^3]. Single precision and five digits change it slightly.
constexpr double kBody = 4047.005;

struct SurfaceCase {
  std::string file;
  double volume = kBody;    // 0: refused
  std::string says = {};    // part of a note, or of the refusal
  double tolerance = 1e-5;  // relative
};

std::vector<SurfaceCase> SurfaceCases() {
  return {
      {"surfaces/cavity_outward.obj", 2 * kBody - 4281.163, "", 1e-4},
      {"surfaces/collinear_extra.obj"},
      {"surfaces/crumb_far.obj", 4047.167},
      {"surfaces/cubes_sharing_edge.obj", 0, "more than one body"},
      {"surfaces/cubes_sharing_face.obj", 2000},
      {"surfaces/duplicate_all.obj"},
      {"surfaces/duplicate_once.obj"},
      {"surfaces/duplicate_reversed.obj"},
      {"surfaces/every_third_flipped.obj"},
      {"surfaces/far_1e5.obj", kBody, "", 1e-4},
      {"surfaces/far_float32.stl", kBody, "", 1e-3},
      {"surfaces/half.obj", 0, "a hole at (5, -3, 40.81), 28.3 across"},
      {"surfaces/inside_out.obj"},
      {"surfaces/metres.obj", 1e-9 * kBody},
      {"surfaces/nan_vertex.obj", 0, "not finite"},
      {"surfaces/one_missing.obj", 0, "a hole at (-0.6229, 4.904, 41.19)"},
      {"surfaces/overlapping_spheres.obj", 0, "intersects itself"},
      {"surfaces/second_body.obj", 0, "more than one body"},
      {"surfaces/t_junction.obj"},
      {"surfaces/unused_vertices.obj"},
      {"collinear/box_midpoint_2.obj", 8000},
      {"collinear/prism_64.obj", 6273.097},
      {"polygons/comb_0.obj", 4200},
      {"polygons/comb_4.obj", 4200},
      {"polygons/comb_9.obj", 4200},
      {"polygons/concave_0.obj", 3840},
      {"polygons/concave_1.obj", 3840},
      {"polygons/concave_2.obj", 3840},
      {"polygons/concave_3.obj", 3840},
      {"polygons/concave_3.ply", 3840},
      {"polygons/concave_4.obj", 3840},
      {"polygons/concave_5.obj", 3840},
      {"polygons/cube_quads.obj", 8000},
      {"stl/UPPER.STL"},
      {"stl/ascii.stl"},
      {"stl/binary.stl"},
      {"stl/binary_colour.stl"},
      {"stl/binary_count0.stl", kBody, "announces no triangles but has 320"},
      {"stl/binary_nan.stl"},
      {"stl/binary_short.stl", 0, "is the file complete, and is it STL?"},
      {"stl/binary_tail.stl", kBody, "the last 2 bytes"},
      {"stl/binary_tail_nl.stl", kBody, "the last 2 bytes"},
      {"stl/bom.stl"},
      {"stl/comma.stl", 0, "a decimal point, not a comma"},
      {"stl/cr.stl"},
      {"stl/crlf.stl"},
      {"stl/digits5.stl", kBody, "", 1e-4},
      {"stl/end_name_differs.stl"},
      {"stl/exp3.stl"},
      {"stl/leading_blank.stl"},
      {"stl/mixed_case.stl"},
      {"stl/nan_normals.stl"},
      {"stl/no_endsolid.stl", kBody, "ends without `endsolid`"},
      {"stl/noname.stl"},
      {"stl/tabs.stl"},
      {"stl/two_solids.stl"},
      {"stl/zero_normals.stl"},
      {"obj/bom.obj"},
      {"obj/bom_v.obj"},
      {"obj/colours.obj"},
      {"obj/continued.obj"},
      {"obj/continued_crlf.obj"},
      {"obj/cr.obj"},
      {"obj/crlf.obj"},
      {"obj/indented.obj"},
      {"obj/interleaved.obj"},
      {"obj/plain.obj"},
      {"obj/relative.obj"},
      {"obj/relative_vn.obj"},
      {"obj/v_vn.obj"},
      {"obj/v_vt.obj"},
      {"obj/v_vt_vn.obj"},
      {"obj/w.obj"},
  };
}

class SurfaceFiles : public ::testing::TestWithParam<SurfaceCase> {};

TEST_P(SurfaceFiles, AreRightOrRefused) {
  const SurfaceCase& expected = GetParam();
  const fs::path path = testing::CasesFolder() / expected.file;
  if (!fs::exists(path)) GTEST_SKIP() << path << " is not there; set FASCICLE_CASES";
  Problems problems;
  std::vector<std::string> notes;
  auto surface = ReadSurface(path.string(), testing::ReadFile(path), problems, {}, &notes);
  std::optional<MeshingResult> result;
  ThreadTeam team(1);
  if (surface) {
    MeshingOptions options;
    options.tetrahedra = 2000;
    result = Tetrahedralize(*surface, options, team, problems);
  }
  if (expected.volume == 0) {
    EXPECT_FALSE(result);
    EXPECT_THAT(problems.ToString(), HasSubstr(expected.says));
    return;
  }
  ASSERT_TRUE(result) << problems.ToString();
  EXPECT_NEAR(result->report.surface_volume / expected.volume, 1, expected.tolerance);
  // The negligible part of crumb_far.obj is left out.
  EXPECT_NEAR(result->report.volume / expected.volume, 1, std::max(expected.tolerance, 2e-4));
  ASSERT_EQ(notes.size(), expected.says.empty() ? 0u : 1u);
  if (!notes.empty()) {
    EXPECT_THAT(notes[0], HasSubstr(expected.says));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, SurfaceFiles, ::testing::ValuesIn(SurfaceCases()), [](const auto& test) {
  std::string name = test.param.file;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
});

struct MeshCase {
  std::string file;
  std::string note = {};  // part of it; empty: none
  bool twice = false;     // all tetrahedra are in group 7, too
};

class MeshFiles : public ::testing::TestWithParam<MeshCase> {};

// A bar of 10 x 10 x 40: the belly (1) below, the tendon (2) above, its ends 11 and 12.
TEST_P(MeshFiles, AreReadWithAllTheirGroups) {
  const fs::path path = testing::CasesFolder() / GetParam().file;
  if (!fs::exists(path)) GTEST_SKIP() << path << " is not there; set FASCICLE_CASES";
  Problems problems;
  MeshRemarks remarks;
  auto mesh = ReadMesh({.name = path.string(), .bytes = testing::ReadFile(path)}, problems, {}, &remarks);
  ASSERT_TRUE(mesh) << problems.ToString();
  ASSERT_EQ(remarks.notes.size(), GetParam().note.empty() ? 0u : 1u);
  if (!remarks.notes.empty()) {
    EXPECT_THAT(remarks.notes[0], HasSubstr(GetParam().note));
  }
  for (Vec3& node : mesh->nodes) node *= 1e-3;
  OrientConsistently(*mesh);
  EXPECT_EQ(mesh->nodes.size(), 63u);
  const MeshReport report = CheckMesh(*mesh, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  EXPECT_NEAR(report.volume, 4e-6, 1e-15);
  EXPECT_EQ(report.components, 1);
  const std::vector<Triangle> surface = BoundaryTriangles(*mesh);
  const auto volume_of = [&](std::int32_t tag) {
    double volume = 0;
    for (const std::int32_t t : SelectRegion(*mesh, surface, "r", TagSelector{tag}).elements) {
      volume += SignedVolume(*mesh, static_cast<std::size_t>(t));
    }
    return volume;
  };
  EXPECT_NEAR(volume_of(1), 2e-6, 1e-15);
  EXPECT_NEAR(volume_of(2), 2e-6, 1e-15);
  EXPECT_NEAR(volume_of(7), GetParam().twice ? 4e-6 : 0, 1e-15);
  for (const auto& [tag, height] : {std::pair(11, 0.0), std::pair(12, 0.04)}) {
    const Region end = SelectRegion(*mesh, surface, "r", TagSelector{tag});
    EXPECT_NEAR(Area({mesh->nodes, end.triangles}), 1e-4, 1e-15);
    EXPECT_EQ(end.nodes.size(), 9u);
    for (const std::int32_t n : end.nodes) EXPECT_DOUBLE_EQ(mesh->nodes[n].z(), height);
  }
  if (path.extension() == ".msh") {
    ASSERT_EQ(remarks.names.size(), 4u);
    EXPECT_EQ(remarks.names[1].name, "upper end (insertion)");
    EXPECT_EQ(remarks.names[3].name, "tendon $End");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, MeshFiles,
    ::testing::Values(MeshCase{"gmsh/twophysical41.msh", "", true},
                      MeshCase{"gmsh/twice22.msh", "144 volume elements repeat another one", true},
                      MeshCase{"gmsh/orphan22.msh", "1 node belongs to no tetrahedron and is left out: 64"},
                      MeshCase{"gmsh/orphan41.msh", "1 node belongs to no tetrahedron and is left out: 64"},
                      MeshCase{"gmsh/partitioned22.msh", ""}, MeshCase{"gmsh/parametric41.msh", ""},
                      MeshCase{"gmsh/sparse41.msh", ""}, MeshCase{"medit/no_end.mesh", ""}),
    [](const auto& test) {
      std::string name = test.param.file;
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
      return name;
    });

}  // namespace
}  // namespace fascicle
