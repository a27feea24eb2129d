#ifndef FASCICLE_CLIENT_LIB_SERIES_TABLE_H_
#define FASCICLE_CLIENT_LIB_SERIES_TABLE_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "client/lib/decode.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// The numbers of a job over time as columns, for tables, CSV files and plots: the job's series, then the values of
// lines as `LINE/VALUE`, then the poses of rigid bodies that move as `NAME/pose/x|y|z` [m] and `NAME/pose/qw|qx|qy|qz`.
// Not thread-safe.
class SeriesTable {
 public:
  struct Column {
    std::string name;
    std::string unit;
    std::string description;
    bool is_pose = false;        // seven per rigid body, shown on request only
    std::vector<double> values;  // one for each frame
  };

  explicit SeriesTable(const v1::Geometry& geometry);

  // Throws std::runtime_error if the frame has a different number of values, or invalid poses.
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
  std::size_t series_ = 0;
  std::size_t moving_ = 0;  // number of rigid bodies
  std::vector<LineInfo> lines_;
};

// Whether `name` matches `pattern`, in which `*` stands for any characters (`/` too) and `?` for one.
bool MatchesGlob(std::string_view pattern, std::string_view name);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_SERIES_TABLE_H_
