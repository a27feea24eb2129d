#ifndef FASCICLE_TESTS_CORE_LINALG_SPRING_GRID_H_
#define FASCICLE_TESTS_CORE_LINALG_SPRING_GRID_H_

#include <random>

#include "core/linalg/block_matrix.h"

namespace fascicle::testing {

// Springs between all nodes of a grid that are less than two spacings apart along every axis, each with a small lateral
// stiffness; the layer at z = 0 is fixed. Its smooth modes resemble those of an elastic block.
struct SpringGrid {
  explicit SpringGrid(int n) {
    const auto number = [&](int i, int j, int k) { return i + n * (j + n * k); };
    PatternBuilder builder;
    std::vector<std::int32_t> columns;
    for (int k = 0; k < n; ++k) {
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          positions.emplace_back(i, j, k);
          free.push_back({k > 0, k > 0, k > 0});
          columns.clear();
          for (int c = std::max(k - 1, 0); c < std::min(k + 2, n); ++c) {
            for (int b = std::max(j - 1, 0); b < std::min(j + 2, n); ++b) {
              for (int a = std::max(i - 1, 0); a < std::min(i + 2, n); ++a) columns.push_back(number(a, b, c));
            }
          }
          builder.AddRow(columns);
        }
      }
    }
    pattern = builder.Take();
    values.assign(pattern.blocks(), Mat3::Zero());
    for (std::size_t row = 0; row < pattern.rows(); ++row) {
      const auto r = static_cast<std::int32_t>(row);
      for (std::int32_t e = pattern.begin[row]; e < pattern.begin[row + 1]; ++e) {
        if (pattern.column[e] == r) continue;
        const Vec3 along = (positions[pattern.column[e]] - positions[row]).normalized();
        const Mat3 stiffness = along * along.transpose() + 0.02 * Mat3::Identity();
        values[e] -= stiffness;
        values[pattern.PlaceOf(r, r)] += stiffness;
      }
    }
    ThreadTeam team(1);
    IsolatePrescribed(pattern, free, team, values);
  }

  BlockPattern pattern;
  BlockValues values;
  NodalVector positions;
  FreeComponents free;
};

inline NodalVector RandomField(const FreeComponents& free, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1, 1);
  NodalVector field;
  for (const auto& f : free) field.emplace_back(f[0] * value(random), f[1] * value(random), f[2] * value(random));
  return field;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CORE_LINALG_SPRING_GRID_H_
