#include "core/linalg/row_products.h"

#include <utility>
#include <vector>

namespace fascicle {

RowMatrix Transposed(const RowMatrix& A, ThreadTeam* team) {
  const auto parts = static_cast<std::size_t>(team != nullptr ? team->size() : 1);
  const auto first_row = [&](std::size_t part) {
    return static_cast<Eigen::Index>(part * static_cast<std::size_t>(A.rows()) / parts);
  };
  const auto for_parts = [&](const auto& body) {
    InRanges(team, parts, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t part = begin; part < end; ++part) body(part);
    });
  };
  // For each part and each column: first the number of entries, then the position of the next one.
  std::vector<std::vector<int>> places(parts);
  for_parts([&](std::size_t part) {
    places[part].assign(static_cast<std::size_t>(A.cols()), 0);
    for (Eigen::Index i = first_row(part); i < first_row(part + 1); ++i) {
      for (RowMatrix::InnerIterator entry(A, i); entry; ++entry) ++places[part][entry.col()];
    }
  });
  RowMatrix result(A.cols(), A.rows());
  int place = 0;
  for (Eigen::Index column = 0; column < A.cols(); ++column) {
    result.outerIndexPtr()[column] = place;
    for (std::vector<int>& of_part : places) place += std::exchange(of_part[column], place);
  }
  result.outerIndexPtr()[A.cols()] = place;
  result.resizeNonZeros(place);
  for_parts([&](std::size_t part) {
    for (Eigen::Index i = first_row(part); i < first_row(part + 1); ++i) {
      for (RowMatrix::InnerIterator entry(A, i); entry; ++entry) {
        const int at = places[part][entry.col()]++;
        result.innerIndexPtr()[at] = static_cast<int>(i);
        result.valuePtr()[at] = entry.value();
      }
    }
  });
  return result;
}

}  // namespace fascicle
