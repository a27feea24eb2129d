// Against ParOSol's solutions (shared/reference/voxel), units mm, N, MPa; the values are those of its README's table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <numbers>
#include <sstream>

#include "core/voxel/static_solver.h"
#include "tests/support/label_volume.h"
#include "tests/support/paths.h"
#include "tests/support/voxel_scenes.h"

namespace fascicle {
namespace {

using testing::BoxGrid;
using testing::LabelVolumePath;
using testing::ReadLabel;

std::string ReferencePath() { return testing::ReferenceFolder() / "voxel/README.md"; }

struct Row {
  std::string model;
  double nu = 0;
  std::vector<double> reaction;  // R_z (R_x, R_y)
  std::vector<double> energy, largest;
};

std::vector<double> NumbersIn(std::string cell) {
  for (char& c : cell) {
    if (c == '(' || c == ')' || c == ',') c = ' ';
  }
  std::istringstream words(cell);
  std::vector<double> numbers;
  for (double x; words >> x;) numbers.push_back(x);
  return numbers;
}

std::vector<Row> ReadRows() {
  std::ifstream file(ReferencePath());
  std::vector<Row> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::vector<std::string> cell;
    for (std::string text; std::getline(cells, text, '|');) cell.push_back(text);
    if (cell.size() < 6 || NumbersIn(cell[2]).empty()) continue;
    std::istringstream(cell[1]) >> std::ws >> cell[1];
    rows.push_back({cell[1], NumbersIn(cell[2])[0], NumbersIn(cell[3]), NumbersIn(cell[4]), NumbersIn(cell[5])});
  }
  return rows;
}

VoxelGrid Gyroid() {
  VoxelGrid grid = MakeVoxelGrid({48, 48, 48}, Vec3::Constant(64.0 / 48));
  const double k = 2 * std::numbers::pi * 2 / 64;
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
    const double x = k * (at[0] + 0.5) * 64 / 48, y = k * (at[1] + 0.5) * 64 / 48, z = k * (at[2] + 0.5) * 64 / 48;
    grid.material[v] = std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x) > 0.5 ? 1 : 0;
  });
  return grid;
}

// Cropped, padded to even sizes (as Coarsen does), and coarsened where at least half is solid.
VoxelGrid BicepsOf2mm(const VoxelGrid& label) {
  VoxelGrid grid = Coarsen(CropToSolid(label), 0.5);
  KeepLargestIsland(grid);
  grid.spacing = Vec3::Constant(2);
  return grid;
}

// Nodes within `layers` of the bottom and of the top.
struct Ends {
  std::vector<GridIndex> bottom, top;
};
Ends EndsOf(const VoxelMesh& mesh, std::int32_t layers) {
  const std::int32_t all = 1 << 20, lowest = mesh.node_runs().front().k, highest = mesh.node_runs().back().k;
  return {NodesInBox(mesh, {0, 0, 0}, {all, all, lowest + layers}),
          NodesInBox(mesh, {0, 0, highest - layers}, {all, all, all})};
}

void Compare(const Row& row, const VoxelGrid& grid, double young, const Vec3& top, std::int32_t layers) {
  SCOPED_TRACE(row.model);
  const VoxelModel model(grid, {{young, row.nu}}, Dilatation::kFull);
  const Ends ends = EndsOf(model.mesh(), layers);
  ThreadTeam team(1);
  const std::clock_t start = std::clock();
  VoxelStaticSolver solver(model, {{ends.bottom}, {ends.top, {true, true, true}, top}}, team);
  const StaticSolution solution = solver.Solve({}, {.tolerance = 1e-10});
  ASSERT_TRUE(solution.iterations.converged);
  std::printf("%s, nu %g: %d voxels, %d iterations to 1e-10, %.2f s of CPU, %.0f bytes a voxel; %s\n",
              row.model.c_str(), row.nu, model.mesh().voxels(), solution.iterations.iterations,
              static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC,
              static_cast<double>(solver.bytes()) / model.mesh().voxels(), solver.multigrid().Description().c_str());
  Vec3 R = Vec3::Zero();
  for (const GridIndex& at : ends.top) R += solution.reaction.At(model.mesh().NodeAt(at));
  ASSERT_FALSE(row.reaction.empty());
  EXPECT_NEAR(R[2], row.reaction[0], 1e-6 * row.reaction[0]);
  if (row.reaction.size() == 3) {
    EXPECT_NEAR(R[0], row.reaction[1], 1e-6 * row.reaction[0]);
    EXPECT_NEAR(R[1], row.reaction[2], 1e-6 * row.reaction[0]);
  }
  for (const double energy : row.energy) EXPECT_NEAR(solution.energy, energy, 1e-6 * energy);
  for (std::size_t d = 0; d < row.largest.size(); ++d) {
    double largest = 0;
    for (std::int32_t n = 0; n < model.mesh().nodes(); ++n)
      largest = std::max(largest, std::abs(solution.displacement(n, static_cast<int>(d))));
    EXPECT_NEAR(largest, row.largest[d], 1e-6 * row.largest[d]);
  }
}

TEST(ParOSol, EveryRowIsMetToOneInAMillion) {
  const std::vector<Row> rows = ReadRows();
  if (rows.empty()) GTEST_SKIP() << "no reference results in " << ReferencePath() << " (set FASCICLE_REFERENCE)";
  ASSERT_GE(rows.size(), 8u);
  std::optional<VoxelGrid> label;
  for (const Row& row : rows) {
    if (row.model.starts_with("cube")) {
      const std::int32_t n = std::stoi(row.model.substr(4));
      Compare(row, BoxGrid({n, n, n}, Vec3::Constant(64.0 / n)), 1, Vec3(0, 0, 0.64), 0);
    } else if (row.model == "gyr48") {
      Compare(row, Gyroid(), 1, Vec3(0, 0, 0.64), 0);
    } else if (row.model == "bic2mm") {
      if (!label) label = ReadLabel(LabelVolumePath(), 1);
      if (!label) {
        std::printf("bic2mm left out: %s is not there; set FASCICLE_DATA\n", LabelVolumePath().c_str());
        continue;
      }
      Compare(row, BicepsOf2mm(*label), 0.03, Vec3(0, 0, 3.46), 5);
    } else {
      ADD_FAILURE() << "an unknown model: " << row.model;
    }
  }
}

// Iterations to 1e-8 for a body of 1 mm voxels and for its coarser levels that are not factored directly, finest first.
// The ends are fixed over 10 mm, and pulled by 3 mm.
std::vector<int> IterationsOfLevels(const VoxelGrid& grid, double nu) {
  std::vector<int> iterations;
  for (VoxelLevel& level : MakeHierarchy(grid, 0.5, 5)) {
    KeepLargestIsland(level.grid);
    const VoxelModel model(level.grid, {{3e4, nu}}, Dilatation::kFull);
    const Ends ends = EndsOf(model.mesh(), std::max(1, 10 / level.voxel_size));
    ThreadTeam team(1);
    const std::clock_t start = std::clock();
    VoxelStaticSolver solver(model, {{ends.bottom}, {ends.top, {true, true, true}, Vec3(0, 0, 3e-3)}}, team);
    const StaticSolution solution = solver.Solve({}, {.tolerance = 1e-8});
    EXPECT_TRUE(solution.iterations.converged);
    std::printf("%2d mm: %d voxels, %d nodes, %d iterations to 1e-8, %.2f s of CPU, %.0f bytes a voxel; %s\n",
                level.voxel_size, model.mesh().voxels(), model.mesh().nodes(), solution.iterations.iterations,
                static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC,
                static_cast<double>(solver.bytes()) / model.mesh().voxels(), solver.multigrid().Description().c_str());
    if (!solver.multigrid().IsDirect()) iterations.push_back(solution.iterations.iterations);
  }
  return iterations;
}

// A spindle of the length and thickness of the biceps.
TEST(Multigrid, IterationsDoNotGrowWithTheLevelsOfASpindle) {
  const std::vector<int> iterations = IterationsOfLevels(testing::SpindleGrid({60, 60, 320}, 1e-3, 10, 30), 0.45);
  ASSERT_GE(iterations.size(), 4u);
  EXPECT_LE(iterations.front(), iterations.back() + 3);
  EXPECT_LE(*std::max_element(iterations.begin(), iterations.end()), 15);
}

// The real one has tendons six voxels across and 70 long, whose bending stiffness bricks of that size overestimate.
TEST(Multigrid, IterationsHardlyGrowWithTheLevelsOfTheBiceps) {
  const std::optional<VoxelGrid> label = ReadLabel(LabelVolumePath(), 1);
  if (!label) GTEST_SKIP() << LabelVolumePath() << " is not there; set FASCICLE_DATA";
  VoxelGrid grid = CropToSolid(*label);
  KeepLargestIsland(grid);
  const std::vector<int> iterations = IterationsOfLevels(grid, 0.45);
  ASSERT_GE(iterations.size(), 4u);
  EXPECT_LE(iterations.front(), iterations.back() + 3);
  EXPECT_LE(*std::max_element(iterations.begin(), iterations.end()), 25);
}

}  // namespace
}  // namespace fascicle
