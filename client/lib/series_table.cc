#include "client/lib/series_table.h"

#include <stdexcept>

namespace fascicle::client {

SeriesTable::SeriesTable(const v1::Geometry& geometry) {
  for (const v1::SeriesInfo& info : geometry.series()) {
    columns_.push_back({info.name(), info.unit(), info.description(), {}});
  }
}

void SeriesTable::Add(const v1::Frame& frame) {
  if (static_cast<std::size_t>(frame.series_size()) != columns_.size()) {
    throw std::runtime_error("the server sent a frame with a different number of series");
  }
  frames_.push_back(frame.index());
  times_.push_back(frame.time());
  steps_.push_back(frame.step());
  for (int i = 0; i < frame.series_size(); ++i) columns_[static_cast<std::size_t>(i)].values.push_back(frame.series(i));
}

bool MatchesGlob(std::string_view pattern, std::string_view name) {
  // Position of the last `*`, and how much of the name it has matched so far, for backtracking.
  std::size_t p = 0, n = 0, star = std::string_view::npos, taken = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++taken;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace fascicle::client
