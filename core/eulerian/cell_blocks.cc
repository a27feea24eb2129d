#include "core/eulerian/cell_blocks.h"

namespace fascicle {
namespace {

constexpr std::size_t kBlockGrain = 64;
// Cells with a smaller solid part join a cell with a larger one.
constexpr double kWhole = 0.5;

// The cell that a cell with little solid joins: the most solid one beside it, if that is solid enough; else itself.
std::size_t RootOf(const EulerianGrid& grid, const EulerianCells& cells, std::size_t cell) {
  if (cells.inside[cell] >= kWhole) return cell;
  const GridIndex at = grid.CellAt(cell);
  std::size_t root = cell;
  for (int n = 0; n < 27; ++n) {
    const GridIndex other = {at[0] - 1 + n % 3, at[1] - 1 + n / 3 % 3, at[2] - 1 + n / 9};
    if (!grid.HasCell(other)) continue;
    const std::size_t number = grid.CellNumber(other);
    if (cells.inside[number] >= kWhole && cells.inside[number] > cells.inside[root]) root = number;
  }
  return root;
}

}  // namespace

CellBlocks MakeCellBlocks(const EulerianGrid& grid, const EulerianCells& cells, ThreadTeam& team) {
  std::vector<std::size_t> roots(cells.solid.size());
  team.For(roots.size(), kBlockGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) roots[c] = RootOf(grid, cells, cells.solid[c]);
  });
  std::vector<int> block_of(grid.cell_count(), -1);  // of root cells
  CellBlocks blocks;
  for (std::size_t c = 0; c < roots.size(); ++c) {
    if (roots[c] != cells.solid[c]) continue;
    block_of[roots[c]] = static_cast<int>(blocks.count());
    blocks.begin.push_back(0);
  }
  for (const std::size_t root : roots) ++blocks.begin[block_of[root] + 1];
  for (std::size_t b = 0; b < blocks.count(); ++b) blocks.begin[b + 1] += blocks.begin[b];
  // Root cells come first, whatever their numbers.
  blocks.cells.resize(roots.size());
  std::vector<std::size_t> place(blocks.begin);
  for (std::size_t c = 0; c < roots.size(); ++c) {
    if (roots[c] == cells.solid[c]) blocks.cells[place[block_of[roots[c]]]++] = roots[c];
  }
  for (std::size_t c = 0; c < roots.size(); ++c) {
    if (roots[c] != cells.solid[c]) blocks.cells[place[block_of[roots[c]]]++] = cells.solid[c];
  }
  return blocks;
}

}  // namespace fascicle
