#include "core/base/text_lines.h"

#include <charconv>
#include <cmath>

namespace fascicle {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

// Removes the first word from `line`, which must not start with a blank.
std::string_view TakeWord(std::string_view& line) {
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line = Trimmed(line.substr(word.size()));
  return word;
}

bool ParseNumber(std::string_view word, double& value) {
  const char* begin = word.data() + (word.starts_with('+') && !word.starts_with("+-") ? 1 : 0);
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  return error == std::errc() && stop == end && std::isfinite(value);
}

}  // namespace

bool TextLines::Next() {
  while (!rest_.empty()) {
    const std::size_t end = rest_.find('\n');
    const std::string_view whole = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
    ++number_;
    line_ = Trimmed(whole.substr(0, whole.find('#')));
    if (!line_.empty()) return true;
  }
  line_ = {};
  return false;
}

std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  for (line = Trimmed(line); !line.empty();) words.push_back(TakeWord(line));
  return words;
}

bool ParseNumbers(std::string_view line, std::span<double> values) {
  line = Trimmed(line);
  for (double& value : values) {
    if (!ParseNumber(TakeWord(line), value)) return false;
  }
  return line.empty();
}

}  // namespace fascicle
