#include "core/linalg/sweep_order.h"

#include <algorithm>
#include <numeric>

namespace fascicle {
namespace {

// Rows of a chunk: many enough that few are at its surface, few enough that every colour of a large matrix has work for
// all threads.
constexpr std::size_t kChunkRows = 192;

// Sorts rows so that those of every chunk are close together, by bisection along the longest side of their bounding
// box; appends the ends of the chunks.
void SortIntoChunks(std::span<std::int32_t> rows, std::span<const Vec3> positions, std::int32_t first,
                    std::vector<std::int32_t>& begin) {
  if (rows.size() > kChunkRows / 16) {
    Vec3 low = positions[rows[0]], high = low;
    for (const std::int32_t row : rows) {
      low = low.cwiseMin(positions[row]);
      high = high.cwiseMax(positions[row]);
    }
    Eigen::Index axis;
    (high - low).maxCoeff(&axis);
    const std::size_t half = rows.size() / 2;
    std::nth_element(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(half), rows.end(),
                     [&](std::int32_t a, std::int32_t b) {
                       return std::pair(positions[a][axis], a) < std::pair(positions[b][axis], b);
                     });
    const bool is_chunk = rows.size() <= kChunkRows;
    std::vector<std::int32_t> ignored;
    std::vector<std::int32_t>& ends = is_chunk ? ignored : begin;
    SortIntoChunks(rows.first(half), positions, first, ends);
    SortIntoChunks(rows.subspan(half), positions, first + static_cast<std::int32_t>(half), ends);
    if (!is_chunk) return;
  }
  begin.push_back(first + static_cast<std::int32_t>(rows.size()));
}

// The colour of each chunk: the first one that no coupled chunk has.
std::vector<std::int32_t> ColoursOf(const BlockPattern& pattern, std::span<const std::int32_t> rows,
                                    std::span<const std::int32_t> begin) {
  std::vector<std::int32_t> chunk_of(rows.size());
  const std::size_t chunks = begin.size() - 1;
  for (std::size_t c = 0; c < chunks; ++c) {
    for (std::int32_t i = begin[c]; i < begin[c + 1]; ++i) chunk_of[rows[i]] = static_cast<std::int32_t>(c);
  }
  std::vector<std::int32_t> colour(chunks, -1);
  std::vector<std::size_t> user;  // the last chunk, counted from 1, that is coupled to a chunk of each colour
  for (std::size_t c = 0; c < chunks; ++c) {
    for (std::int32_t i = begin[c]; i < begin[c + 1]; ++i) {
      for (std::int32_t k = pattern.begin[rows[i]]; k < pattern.begin[rows[i] + 1]; ++k) {
        const std::int32_t of_other = colour[chunk_of[pattern.column[k]]];
        if (of_other >= 0) user[of_other] = c + 1;
      }
    }
    const auto free = std::find_if(user.begin(), user.end(), [&](std::size_t u) { return u != c + 1; });
    colour[c] = static_cast<std::int32_t>(free - user.begin());
    if (free == user.end()) user.push_back(0);
  }
  return colour;
}

}  // namespace

SweepOrder::SweepOrder(const BlockPattern& pattern, std::span<const Vec3> positions) : place(pattern.rows()) {
  std::vector<std::int32_t> rows(pattern.rows()), begin = {0};
  std::iota(rows.begin(), rows.end(), 0);
  if (!rows.empty()) SortIntoChunks(rows, positions, 0, begin);
  const std::vector<std::int32_t> colours = ColoursOf(pattern, rows, begin);
  std::vector<std::int32_t> chunks(colours.size());
  std::iota(chunks.begin(), chunks.end(), 0);
  std::stable_sort(chunks.begin(), chunks.end(),
                   [&](std::int32_t a, std::int32_t b) { return colours[a] < colours[b]; });
  chunk_begin = {0};
  for (const std::int32_t c : chunks) {
    row.insert(row.end(), rows.begin() + begin[c], rows.begin() + begin[c + 1]);
    chunk_begin.push_back(static_cast<std::int32_t>(row.size()));
    while (static_cast<std::int32_t>(colour_begin.size()) <= colours[c] + 1)
      colour_begin.push_back(colour_begin.back());
    ++colour_begin.back();
  }
  for (std::size_t i = 0; i < row.size(); ++i) place[row[i]] = static_cast<std::int32_t>(i);
}

}  // namespace fascicle
