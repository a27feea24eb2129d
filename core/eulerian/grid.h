#ifndef FASCICLE_CORE_EULERIAN_GRID_H_
#define FASCICLE_CORE_EULERIAN_GRID_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/geometry/voxel_grid.h"

namespace fascicle {

// A regular, fixed grid over space: cubes, and the nodes at their corners. Numbered with x fastest, then y.
struct EulerianGrid {
  Vec3 origin = Vec3::Zero();  // of node (0, 0, 0) [m]
  double spacing = 1;          // h [m]
  GridIndex cells = {0, 0, 0};

  GridIndex nodes() const { return {cells[0] + 1, cells[1] + 1, cells[2] + 1}; }
  std::size_t cell_count() const { return static_cast<std::size_t>(cells[0]) * cells[1] * cells[2]; }
  std::size_t node_count() const { return static_cast<std::size_t>(cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1); }
  std::size_t NodeNumber(const GridIndex& at) const {
    return static_cast<std::size_t>(at[0]) +
           static_cast<std::size_t>(cells[0] + 1) * (at[1] + static_cast<std::size_t>(cells[1] + 1) * at[2]);
  }
  std::size_t CellNumber(const GridIndex& at) const {
    return static_cast<std::size_t>(at[0]) +
           static_cast<std::size_t>(cells[0]) * (at[1] + static_cast<std::size_t>(cells[1]) * at[2]);
  }
  GridIndex NodeAt(std::size_t number) const { return Split(number, cells[0] + 1, cells[1] + 1); }
  GridIndex CellAt(std::size_t number) const { return Split(number, cells[0], cells[1]); }
  bool HasNode(const GridIndex& at) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] < 0 || at[axis] > cells[axis]) return false;
    }
    return true;
  }
  bool HasCell(const GridIndex& at) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] < 0 || at[axis] >= cells[axis]) return false;
    }
    return true;
  }
  Vec3 NodePosition(const GridIndex& at) const { return origin + spacing * Vec3(at[0], at[1], at[2]); }
  Vec3 CellCentre(const GridIndex& at) const { return NodePosition(at) + Vec3::Constant(0.5 * spacing); }
  // The eight corners of a cell: bit 0 of c is along x, 1 along y, 2 along z.
  std::size_t Corner(const GridIndex& cell, int c) const {
    return NodeNumber({cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)});
  }

  // The cell that contains a point, clamped to the grid, and the position in it, in [0, 1] within the grid.
  struct Place {
    GridIndex cell;
    Vec3 within;
  };
  Place PlaceOf(const Vec3& point) const {
    Place place;
    const Vec3 at = (point - origin) / spacing;
    for (int axis = 0; axis < 3; ++axis) {
      const double limited = std::clamp(at[axis], 0.0, static_cast<double>(cells[axis]));
      place.cell[axis] = std::min(static_cast<std::int32_t>(limited), cells[axis] - 1);
      place.within[axis] = limited - place.cell[axis];
    }
    return place;
  }

 private:
  static GridIndex Split(std::size_t number, std::int32_t ni, std::int32_t nj) {
    const auto i = static_cast<std::int32_t>(number % ni);
    const std::size_t rest = number / ni;
    return {i, static_cast<std::int32_t>(rest % nj), static_cast<std::int32_t>(rest / nj)};
  }
};

// The trilinear weight of corner c at a position `within` a cell.
inline double CornerWeight(int c, const Vec3& within) {
  double weight = 1;
  for (int axis = 0; axis < 3; ++axis) weight *= (c >> axis & 1) != 0 ? within[axis] : 1 - within[axis];
  return weight;
}

// The mean of a field over the corners of a cell.
inline Vec3 CentreValue(const EulerianGrid& grid, const std::vector<Vec3>& field, const GridIndex& cell) {
  Vec3 sum = Vec3::Zero();
  for (int c = 0; c < 8; ++c) sum += field[grid.Corner(cell, c)] / 8;
  return sum;
}

// The gradient of the trilinear shape function of corner c at the centre of a cell [1/m].
inline Vec3 CornerGradient(int c, double spacing) {
  return Vec3((c & 1) != 0 ? 1 : -1, (c & 2) != 0 ? 1 : -1, (c & 4) != 0 ? 1 : -1) / (4 * spacing);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_GRID_H_
