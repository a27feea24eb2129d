#ifndef FASCICLE_CORE_EULERIAN_CELL_BLOCKS_H_
#define FASCICLE_CORE_EULERIAN_CELL_BLOCKS_H_

#include <span>
#include <vector>

#include "core/eulerian/cells.h"

namespace fascicle {

// Blocks of cells that share a pressure: one cell that is mostly solid, followed by neighbours that are less so. The
// volume of a sliver cannot be corrected by its own pressure.
struct CellBlocks {
  std::vector<std::size_t> cells;
  std::vector<std::size_t> begin = {0};  // start of each block in `cells`, and the end

  std::size_t count() const { return begin.size() - 1; }
  std::size_t First(std::size_t block) const { return cells[begin[block]]; }
  std::span<const std::size_t> operator[](std::size_t block) const {
    return std::span(cells).subspan(begin[block], begin[block + 1] - begin[block]);
  }
};

// The blocks of all cells that are solid in part, by ascending first cells. The same for any number of threads.
CellBlocks MakeCellBlocks(const EulerianGrid& grid, const EulerianCells& cells, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CELL_BLOCKS_H_
