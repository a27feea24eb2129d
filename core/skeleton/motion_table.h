#ifndef FASCICLE_CORE_SKELETON_MOTION_TABLE_H_
#define FASCICLE_CORE_SKELETON_MOTION_TABLE_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"

namespace fascicle {

// A table of values in time: a motion (.mot), or results (.sto), of OpenSim.
struct MotionTable {
  std::string name;
  bool in_degrees = false;                  // whether its angles are in degrees, as the file says
  std::vector<std::string> columns;         // without time
  std::vector<double> times;                // [s] strictly ascending
  std::vector<std::vector<double>> values;  // of each column, one for each time, as in the file

  // The values of a column; null if there is none.
  const std::vector<double>* Find(std::string_view column) const;
  // Whether it has several rows at equal intervals, to a thousandth, as a filter needs.
  bool HasEqualIntervals() const;
};

// Reads such a table, of at most 100,000 rows. All problems are added at once, with lines. The number of rows that the
// header claims must be that of the rows. Any input is safe. Thread-safe.
std::optional<MotionTable> ReadMotionTable(std::string_view text, const std::string& name, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_MOTION_TABLE_H_
