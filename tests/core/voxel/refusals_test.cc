// Each mistake alone, and all of them at once: refused with a field path and a plain message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/voxel/check_problem.h"
#include "core/voxel/free_motions.h"
#include "tests/support/voxel_scenes.h"

namespace fascicle {
namespace {

using ::testing::AllOf;
using testing::BoxGrid;
using ::testing::HasSubstr;

struct Body {
  VoxelGrid grid = BoxGrid({4, 4, 4}, Vec3::Constant(1e-3));
  std::vector<VoxelMaterial> materials = {{3e4, 0.45}};
  std::vector<VoxelSupport> supports = {{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}};
  VoxelLoads loads;

  std::string Problem() const {
    Problems problems;
    CheckVoxelProblem(grid, materials, supports, loads, problems);
    return problems.ToString();
  }
};

TEST(Refusals, AGoodProblemHasNone) { EXPECT_EQ(Body().Problem(), ""); }

TEST(Refusals, EmptyGrids) {
  Body body;
  body.grid = MakeVoxelGrid({4, 4, 4}, Vec3::Ones());
  EXPECT_THAT(body.Problem(), HasSubstr("grid: no voxel is solid"));
  body.grid = MakeVoxelGrid({0, 4, 4}, Vec3::Ones());
  EXPECT_THAT(body.Problem(), HasSubstr("grid.size: the grid has no voxels"));
}

TEST(Refusals, SenselessGrids) {
  Body body;
  body.grid.size = {10000, 10000, 10000};
  EXPECT_THAT(body.Problem(), HasSubstr("more than 2^31 - 1"));
  body = Body();
  body.grid.spacing[1] = 0;
  EXPECT_THAT(body.Problem(), HasSubstr("grid.spacing"));
  body = Body();
  body.grid.stiffness.assign(body.grid.voxels(), 1);
  body.grid.stiffness[5] = 0;
  EXPECT_THAT(body.Problem(), AllOf(HasSubstr("grid.stiffness: 1 solid voxels"), HasSubstr("(1, 1, 0)")));
  body = Body();
  body.grid.material.pop_back();
  EXPECT_THAT(body.Problem(), HasSubstr("differ from the number of voxels"));
}

TEST(Refusals, ModuliOutOfRange) {
  for (const double nu : {0.5, 0.6, -1.0, std::nan("")}) {
    Body body;
    body.materials[0].poisson_ratio = nu;
    EXPECT_THAT(body.Problem(), AllOf(HasSubstr("materials[0].poisson_ratio: must be above -1 and below 0.5"),
                                      HasSubstr("mean dilatation")));
  }
  Body body;
  body.materials[0].young_modulus = 0;
  EXPECT_THAT(body.Problem(), HasSubstr("materials[0].young_modulus"));
  body.grid.material[3] = 2;
  EXPECT_THAT(body.Problem(),
              HasSubstr("1 voxels have a material that is not listed, the first is (3, 0, 0) with material 2"));
}

TEST(Refusals, SupportsThatDoNotExistOrContradict) {
  Body body;
  body.supports.push_back({{{0, 0, 0}, {9, 0, 0}, {0, -1, 0}}});
  EXPECT_THAT(body.Problem(),
              HasSubstr("supports[1].nodes: 2 of 3 nodes are not corners of a solid voxel, the first is (9, 0, 0)"));
  body = Body();
  body.supports.push_back({{{4, 0, 0}}, {false, true, false}, Vec3(0, 1e-3, 0)});
  EXPECT_THAT(body.Problem(),
              HasSubstr("supports[1].displacement: 1 components have a different value in an earlier support"));
  body = Body();
  body.supports.push_back({{{4, 0, 0}}, {false, false, false}});
  EXPECT_THAT(body.Problem(), HasSubstr("supports[1].components"));
}

TEST(Refusals, LoadsThatDoNotExist) {
  Body body;
  body.loads.nodal_forces = {{{{0, 0, 5}}, Vec3(1, 0, 0)}, {{}, Vec3(1, 0, 0)}};
  body.loads.tractions = {{{{{4, 0, 0}, 1}}, Vec3(std::nan(""), 0, 0)}};
  EXPECT_THAT(body.Problem(), AllOf(HasSubstr("loads.nodal_forces[0].nodes"), HasSubstr("loads.nodal_forces[1].nodes"),
                                    HasSubstr("loads.tractions[0].faces"), HasSubstr("loads.tractions[0].traction")));
}

TEST(Refusals, AnIslandThatNothingHolds) {
  Body body;
  body.grid = BoxGrid({9, 4, 4}, Vec3::Constant(1e-3));
  ForVoxels(body.grid, [&](std::size_t v, const GridIndex& at) {
    if (at[0] >= 4 && at[0] < 7) body.grid.material[v] = 0;
  });
  EXPECT_THAT(body.Problem(), HasSubstr("no support holds the island of 32 voxels that starts at (7, 0, 0): it moves "
                                        "along i, j and k, turns about i, j and k"));
}

TEST(Refusals, ABodyMayFlyInTime) {
  Body body;
  body.supports = {};
  Problems problems;
  CheckVoxelProblem(body.grid, body.materials, body.supports, body.loads, problems, /*may_fly=*/true);
  EXPECT_EQ(problems.ToString(), "");
}

TEST(Refusals, RigidModesAreNamed) {
  Body body;
  body.supports = {};
  EXPECT_THAT(body.Problem(), HasSubstr("moves along i, j and k, turns about i, j and k"));
  body.supports = {{{{2, 2, 0}}}};  // a point
  EXPECT_THAT(body.Problem(), HasSubstr("it turns about i, j and k"));
  body.supports = {{{{0, 2, 0}, {4, 2, 0}}}};  // a hinge
  EXPECT_THAT(body.Problem(), HasSubstr("it turns about i ("));
  body.supports = {{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {false, false, true}}};  // a table
  EXPECT_THAT(body.Problem(), HasSubstr("it moves along i and j, turns about k"));
  body.supports = {{{{0, 0, 0}, {4, 4, 0}}}};  // along a diagonal
  EXPECT_THAT(body.Problem(), HasSubstr("turns about an axis that is not one of the grid's"));
}

// Two cubes that share an edge form a hinge; with supports on both sides of it they do not.
TEST(Refusals, IslandsThatTouchInAnEdgeAreAHinge) {
  Body body;
  body.grid = MakeVoxelGrid({8, 8, 4}, Vec3::Constant(1e-3));
  ForVoxels(body.grid,
            [&](std::size_t v, const GridIndex& at) { body.grid.material[v] = at[0] / 4 == at[1] / 4 ? 1 : 0; });
  EXPECT_THAT(body.Problem(), HasSubstr("the island of 64 voxels that starts at (4, 4, 0): it turns about k ("));
  body.supports.push_back({{{8, 8, 0}}, {true, false, false}});
  EXPECT_EQ(body.Problem(), "");
}

}  // namespace
}  // namespace fascicle
