#ifndef FASCICLE_CLIENT_LIB_SERIES_TABLE_H_
#define FASCICLE_CLIENT_LIB_SERIES_TABLE_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// The series of a job as columns, for tables, CSV files and plots. Not thread-safe.
class SeriesTable {
 public:
  struct Column {
    std::string name;
    std::string unit;
    std::string description;
    std::vector<double> values;  // one for each frame
  };

  explicit SeriesTable(const v1::Geometry& geometry);

  // Throws std::runtime_error if the frame has a different number of values.
  void Add(const v1::Frame& frame);

  std::size_t size() const { return times_.size(); }
  const std::vector<std::int64_t>& frames() const { return frames_; }
  const std::vector<double>& times() const { return times_; }  // [s]
  const std::vector<std::int64_t>& steps() const { return steps_; }
  const std::vector<Column>& columns() const { return columns_; }

 private:
  std::vector<std::int64_t> frames_;
  std::vector<double> times_;
  std::vector<std::int64_t> steps_;
  std::vector<Column> columns_;
};

// Whether `name` matches `pattern`, in which `*` stands for any characters (`/` too) and `?` for one.
bool MatchesGlob(std::string_view pattern, std::string_view name);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_SERIES_TABLE_H_
