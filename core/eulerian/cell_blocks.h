#ifndef FASCICLE_CORE_EULERIAN_CELL_BLOCKS_H_
#define FASCICLE_CORE_EULERIAN_CELL_BLOCKS_H_

#include <span>
#include <vector>

#include "core/eulerian/cells.h"

namespace fascicle {

// Cells that share a pressure, block by block: one that is mostly solid, then those beside it that are less so. The
// volume of a sliver can't be corrected by a pressure of its own.
struct CellBlocks {
  std::vector<std::size_t> cells;
  std::vector<std::size_t> begin = {0};  // of each block, in `cells`, and the end

  std::size_t count() const { return begin.size() - 1; }
  std::size_t First(std::size_t block) const { return cells[begin[block]]; }
  std::span<const std::size_t> operator[](std::size_t block) const {
    return std::span(cells).subspan(begin[block], begin[block + 1] - begin[block]);
  }
};

// The blocks of all cells that have any solid, in ascending order of their first cells. The same for any number of
// threads.
CellBlocks MakeCellBlocks(const EulerianGrid& grid, const EulerianCells& cells, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CELL_BLOCKS_H_
