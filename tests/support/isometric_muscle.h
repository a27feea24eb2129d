#ifndef FASCICLE_TESTS_SUPPORT_ISOMETRIC_MUSCLE_H_
#define FASCICLE_TESTS_SUPPORT_ISOMETRIC_MUSCLE_H_

#include <array>
#include <cmath>

#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

// Reference problem d, a muscle with fixed ends, in the sizes of the benchmarks: quadratic elements with curved edges
// on n x n x lengthwise hexahedra of six tetrahedra each.
namespace fascicle::testing {

struct MuscleGrid {
  int n;
  int lengthwise;

  int FreeComponents() const { return 3 * (2 * n + 1) * (2 * n + 1) * (2 * lengthwise - 1); }
  int Tetrahedra() const { return 6 * n * n * lengthwise; }
};

inline constexpr std::array<MuscleGrid, 9> kMuscleGrids = {
    {{2, 8}, {3, 12}, {4, 20}, {6, 20}, {8, 28}, {10, 38}, {12, 54}, {16, 64}, {20, 80}}};

// The one whose number of free components is closest to a given one, by ratio.
inline MuscleGrid NearestMuscleGrid(double components) {
  MuscleGrid best = kMuscleGrids[0];
  const auto distance = [&](const MuscleGrid& grid) { return std::abs(std::log(grid.FreeComponents() / components)); };
  for (const MuscleGrid& grid : kMuscleGrids) {
    if (distance(grid) < distance(best)) best = grid;
  }
  return best;
}

// Activation t at time t in [0, 1] s, quasi-static.
inline Scene IsometricMuscle(const MuscleGrid& grid) {
  return StaticScene(ReferenceMuscle(grid.n, grid.lengthwise, Ramp(1)), ElementOrder::kQuadratic);
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_ISOMETRIC_MUSCLE_H_
