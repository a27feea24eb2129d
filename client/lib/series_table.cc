#include "client/lib/series_table.h"

#include <array>
#include <stdexcept>

namespace fascicle::client {

namespace {

struct PoseColumn {
  const char* name;
  const char* unit;
  const char* description;
};

constexpr std::array<PoseColumn, 7> kPoseColumns = {{{"x", "m", "place of the origin of the body's axes, along x"},
                                                     {"y", "m", "place of the origin of the body's axes, along y"},
                                                     {"z", "m", "place of the origin of the body's axes, along z"},
                                                     {"qw", "1", "orientation: unit quaternion, w"},
                                                     {"qx", "1", "orientation: unit quaternion, x"},
                                                     {"qy", "1", "orientation: unit quaternion, y"},
                                                     {"qz", "1", "orientation: unit quaternion, z"}}};

}  // namespace

SeriesTable::SeriesTable(const v1::Geometry& geometry)
    : series_(static_cast<std::size_t>(geometry.series_size())), lines_(DecodeLineInfos(geometry)) {
  for (const v1::SeriesInfo& info : geometry.series()) {
    columns_.push_back({info.name(), info.unit(), info.description(), false, {}});
  }
  for (const LineInfo& line : lines_) {
    for (const v1::SeriesInfo& value : line.values) {
      columns_.push_back({line.name + "/" + value.name(), value.unit(), value.description(), false, {}});
    }
  }
  for (const v1::RigidBodyGeometry& body : geometry.rigid_bodies()) {
    if (!body.moves()) continue;
    ++moving_;
    for (const PoseColumn& column : kPoseColumns) {
      columns_.push_back({body.name() + "/pose/" + column.name, column.unit, column.description, true, {}});
    }
  }
}

void SeriesTable::Add(const v1::Frame& frame) {
  std::vector<double> row(frame.series().begin(), frame.series().end());
  if (row.size() != series_) throw std::runtime_error("the server sent a frame with a different number of series");
  for (const LinePath& line : DecodeLines(frame, lines_)) row.insert(row.end(), line.values.begin(), line.values.end());
  for (const Pose& pose : DecodePoses(frame, moving_)) {
    row.insert(row.end(), pose.position.begin(), pose.position.end());
    row.insert(row.end(), pose.quaternion.begin(), pose.quaternion.end());
  }
  frames_.push_back(frame.index());
  times_.push_back(frame.time());
  steps_.push_back(frame.step());
  for (std::size_t i = 0; i < row.size(); ++i) columns_[i].values.push_back(row[i]);
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
