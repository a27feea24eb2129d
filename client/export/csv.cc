#include "client/export/csv.h"

#include <charconv>
#include <cmath>

namespace fascicle::client {
namespace {

std::string Escaped(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string escaped = "\"";
  for (const char c : cell) {
    if (c == '"') escaped += '"';
    escaped += c;
  }
  return escaped + "\"";
}

void AppendNumber(double value, std::string& text) {
  if (!std::isfinite(value)) return;
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

}  // namespace

std::string CsvOf(const std::vector<CsvColumn>& columns) {
  std::string text;
  for (const CsvColumn& column : columns) text += (text.empty() ? "" : ",") + Escaped(column.heading);
  text += '\n';
  const std::size_t rows = columns.empty() ? 0 : columns.front().values.size();
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) text += ',';
      AppendNumber(columns[i].values[row], text);
    }
    text += '\n';
  }
  return text;
}

std::string CsvOf(const SeriesTable& table) {
  std::vector<CsvColumn> columns = {{"frame", {table.frames().begin(), table.frames().end()}},
                                    {"time [s]", table.times()},
                                    {"step", {table.steps().begin(), table.steps().end()}}};
  for (const SeriesTable::Column& column : table.columns()) {
    columns.push_back({column.name + " [" + column.unit + "]", column.values});
  }
  return CsvOf(columns);
}

}  // namespace fascicle::client
