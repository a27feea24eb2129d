#include "server/translate/number_files.h"

#include <algorithm>

#include "core/base/text_lines.h"
#include "server/translate/files.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

std::vector<double> ReadLines(std::string_view text, const NumberFile& expected, Problems& problems) {
  std::vector<double> values;
  std::vector<double> line(expected.columns);
  std::size_t count = 0;
  for (TextLines lines(text); lines.Next(); ++count) {
    const std::string where = "line " + std::to_string(lines.number()) + ": ";
    if (!ParseNumbers(lines.line(), line)) {
      problems.Add({}, where + (expected.columns == 1 ? "not one finite number"
                                                      : "not " + std::to_string(expected.columns) +
                                                            " finite numbers with blanks between them"));
      continue;
    }
    const auto wrong = std::find_if(line.begin(), line.end(),
                                    [&](double value) { return value < expected.min || value > expected.max; });
    if (wrong != line.end()) {
      problems.Add(
          {}, where + Text(*wrong) + " is outside the range [" + Text(expected.min) + ", " + Text(expected.max) + "]");
    }
    if (expected.lines && count < std::max(*expected.lines, expected.or_lines))
      values.insert(values.end(), line.begin(), line.end());
  }
  if (!expected.lines || count == expected.or_lines) return values;
  if (expected.or_item == nullptr) {
    CheckLineCount(count, *expected.lines, expected.item, problems);
  } else if (count != *expected.lines) {
    problems.Add({},
                 std::to_string(count) + " lines for " + std::to_string(*expected.lines) + " " + expected.item +
                     ", or " + std::to_string(expected.or_lines) + " " + expected.or_item,
                 std::string("give one line for each of the ") + expected.item + ", or of the " + expected.or_item +
                     ", in the order of the mesh");
  }
  return values;
}

}  // namespace

void CheckLineCount(std::size_t lines, std::size_t expected, const char* item, Problems& problems) {
  if (lines == expected) return;
  problems.Add({}, std::to_string(lines) + " lines for " + std::to_string(expected) + " " + item,
               std::string("give one line for each of the ") + item + ", in the order of the mesh");
}

std::vector<double> ReadNumberFile(const v1::FileRef& file, const NumberFile& expected, const std::string& path,
                                   const AssetReader& assets, Problems& problems) {
  const auto bytes = ReadFile(file, path, assets, problems);
  if (!bytes) return {};
  Problems own;
  std::vector<double> values = ReadLines(*bytes, expected, own);
  problems.Append(path, own);
  return own.empty() ? values : std::vector<double>();
}

}  // namespace fascicle::server
