#include "core/imaging/volume_layout.h"

#include <algorithm>
#include <charconv>

namespace fascicle {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";
constexpr std::uint64_t kMostFiles = 100'000;

template <class T>
std::optional<T> ParseNumber(std::string_view text) {
  T value = 0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class T>
std::optional<std::vector<T>> ParseAll(std::string_view text) {
  std::vector<T> numbers;
  for (text = Trimmed(text); !text.empty(); text = Trimmed(text)) {
    const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
    const std::optional<T> number = ParseNumber<T>(text.substr(0, end));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    text.remove_prefix(end);
  }
  return numbers;
}

// Data files must be beside their header.
bool AddDataFile(std::string_view name, VolumeLayout& layout, Problems& problems) {
  if (name.starts_with("./")) name.remove_prefix(2);
  if (name.empty() || name.find_first_of("/\\") != std::string::npos || name == "." || name == "..") {
    problems.Add("", "the header names a data file in another folder: `" + std::string(name.substr(0, 100)) + "`",
                 "it must be in the header's folder and be named without one");
    return false;
  }
  layout.files.emplace_back(name);
  return true;
}

// "name%03d.raw first last step" [MetaIO; NRRD, 5.1].
bool TakePattern(std::string_view value, VolumeLayout& layout, Problems& problems) {
  const std::size_t blank = value.find_first_of(kBlanks, value.find('%'));
  const std::string_view pattern = value.substr(0, blank);
  const auto range = ParseAll<std::int64_t>(blank == std::string_view::npos ? std::string_view() : value.substr(blank));
  const std::size_t percent = pattern.find('%');
  const std::size_t end = pattern.find('d', percent);
  const std::string_view digits = end == std::string_view::npos ? "" : pattern.substr(percent + 1, end - percent - 1);
  const auto width = digits.empty() ? std::optional<std::uint64_t>(0) : ParseNumber<std::uint64_t>(digits);
  const bool ok = end != std::string_view::npos && pattern.find('%', end) == std::string_view::npos && width &&
                  *width < 20 && range && (range->size() == 2 || range->size() == 3);
  const std::int64_t first = ok ? (*range)[0] : 0, last = ok ? (*range)[1] : 0,
                     step = ok && range->size() == 3 ? (*range)[2] : 1;
  constexpr auto kMost = static_cast<std::int64_t>(kMostFiles);
  if (!ok || step < 1 || first < 0 || last < first || last >= kMost) {
    problems.Add("", "the names of data files can't be understood: `" + std::string(value.substr(0, 100)) + "`",
                 "expected a pattern and its first and last number and step, such as `slice%03d.raw 1 20 1`");
    return false;
  }
  for (std::int64_t n = first; n <= last; n += step) {
    std::string number = std::to_string(n);
    if (number.size() < *width) number.insert(0, *width - number.size(), digits.starts_with('0') ? '0' : ' ');
    const std::string name = std::string(pattern.substr(0, percent)) + number + std::string(pattern.substr(end + 1));
    if (!AddDataFile(name, layout, problems)) return false;
  }
  return true;
}

}  // namespace

bool TakeSizes(const std::vector<std::uint64_t>& sizes, VolumeLayout& layout, Problems& problems) {
  layout.size = {1, 1, 1};
  for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
    if (axis < 3) {
      layout.size[axis] = sizes[axis];
    } else if (sizes[axis] != 1) {
      problems.Add("",
                   "the image has " + std::to_string(sizes[axis]) + " volumes along its dimension " +
                       std::to_string(axis + 1) + ", one for each time or channel",
                   "save the one that is wanted by itself");
      return false;
    }
  }
  return true;
}

void TakeAxes(const Mat3& axes, VolumeLayout& layout) {
  layout.image.spacing = axes.colwise().norm().transpose();
  for (int axis = 0; axis < 3; ++axis) layout.image.direction.col(axis) = axes.col(axis) / layout.image.spacing[axis];
}

bool TakeDataFiles(std::string_view value, std::string_view rest, VolumeLayout& layout, Problems& problems) {
  if (value.find('%') != std::string_view::npos) return TakePattern(value, layout, problems);
  if (value != "LIST" && !value.starts_with("LIST ")) return AddDataFile(value, layout, problems);
  while (const std::optional<std::string_view> line = TakeLine(rest)) {
    if (Trimmed(*line).empty()) continue;
    if (layout.files.size() == kMostFiles || !AddDataFile(Trimmed(*line), layout, problems)) return false;
  }
  if (layout.files.empty()) problems.Add("", "the header's list of data files is empty", "a name on each line");
  return !layout.files.empty();
}

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::optional<std::string_view> TakeLine(std::string_view& text) {
  if (text.empty()) return std::nullopt;
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::optional<std::vector<double>> ParseNumbers(std::string_view text) { return ParseAll<double>(text); }

std::optional<std::vector<std::uint64_t>> ParseCounts(std::string_view text) { return ParseAll<std::uint64_t>(text); }

}  // namespace fascicle
