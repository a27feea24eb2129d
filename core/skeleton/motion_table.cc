#include "core/skeleton/motion_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/text_lines.h"

namespace fascicle {
namespace {

constexpr std::size_t kMostRows = 100'000;

class TableReader {
 public:
  TableReader(std::string_view text, const std::string& name, Problems& problems)
      : lines_(text), file_(name), problems_(problems), before_(problems.count()) {}

  std::optional<MotionTable> Read() {
    if (!ReadHeader() || !ReadColumns()) return std::nullopt;
    while (lines_.Next()) {
      if (!ReadRow()) return std::nullopt;
    }
    if (table_.times.empty()) Fail("the table has no rows", "is the file complete?");
    if (rows_ >= 0 && rows_ != static_cast<long>(table_.times.size())) {
      Fail("the header claims " + std::to_string(rows_) + " rows, but there are " + std::to_string(table_.times.size()),
           "is the file complete?");
    }
    if (problems_.count() > before_) return std::nullopt;
    return std::move(table_);
  }

 private:
  void Fail(const std::string& message, const std::string& hint = {}) {
    problems_.Add(file_ + ":" + std::to_string(lines_.number()), message, hint);
  }

  bool ReadHeader() {
    while (lines_.Next()) {
      const std::string_view line = lines_.line();
      if (line == "endheader") return true;
      if (table_.name.empty()) table_.name = line;
      const std::size_t equals = line.find('=');
      if (equals == std::string_view::npos) continue;
      const std::string_view key = line.substr(0, equals), value = line.substr(equals + 1);
      if (key == "inDegrees") {
        if (value != "yes" && value != "no") Fail("inDegrees must be yes or no");
        table_.in_degrees = value == "yes";
      }
      if (key == "nRows" || key == "datarows") {
        const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), rows_);
        if (error != std::errc() || end != value.data() + value.size() || rows_ < 0)
          Fail("the number of rows is wrong");
      }
    }
    Fail("there is no line `endheader`", "give a .mot or .sto file of OpenSim");
    return false;
  }

  bool ReadColumns() {
    if (!lines_.Next()) {
      Fail("there are no column names", "is the file complete?");
      return false;
    }
    const std::vector<std::string_view> words = Words(lines_.line());
    if (words.size() < 2 || words[0] != "time") {
      Fail("the first column must be `time`, and others must follow");
      return false;
    }
    table_.columns.assign(words.begin() + 1, words.end());
    std::set<std::string_view> seen;
    for (const std::string& column : table_.columns) {
      if (!seen.insert(column).second) Fail("column `" + column.substr(0, 60) + "` is given twice");
    }
    table_.values.resize(table_.columns.size());
    row_.resize(words.size());
    return true;
  }

  // False if reading more would only repeat a problem.
  bool ReadRow() {
    if (!ParseNumbers(lines_.line(), row_)) {
      Fail("expected " + std::to_string(row_.size()) + " finite numbers");
      return false;
    }
    if (!table_.times.empty() && !(row_[0] > table_.times.back())) {
      Fail("time does not advance", "sort the rows by time, and leave out repeated ones");
      return false;
    }
    if (table_.times.size() == kMostRows) {
      Fail("there are more than 100,000 rows", "leave out rows");
      return false;
    }
    table_.times.push_back(row_[0]);
    for (std::size_t k = 1; k < row_.size(); ++k) table_.values[k - 1].push_back(row_[k]);
    return true;
  }

  TextLines lines_;
  std::string file_;
  Problems& problems_;
  std::size_t before_;
  long rows_ = -1;
  MotionTable table_;
  std::vector<double> row_;
};

}  // namespace

bool MotionTable::HasEqualIntervals() const {
  if (times.size() < 2) return false;
  const double interval = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (std::abs(times[k] - times[0] - interval * static_cast<double>(k)) > 1e-3 * interval) return false;
  }
  return true;
}

const std::vector<double>* MotionTable::Find(std::string_view column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  return found == columns.end() ? nullptr : &values[static_cast<std::size_t>(found - columns.begin())];
}

std::optional<MotionTable> ReadMotionTable(std::string_view text, const std::string& name, Problems& problems) {
  return TableReader(text, name, problems).Read();
}

}  // namespace fascicle
