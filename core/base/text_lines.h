#ifndef FASCICLE_CORE_BASE_TEXT_LINES_H_
#define FASCICLE_CORE_BASE_TEXT_LINES_H_

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace fascicle {

// Iterates over the non-empty lines of a text, without `#` comments and surrounding blanks.
class TextLines {
 public:
  // `text` must outlive this.
  explicit TextLines(std::string_view text) : rest_(text) {}

  // Advances to the next line; false at the end.
  bool Next();
  std::string_view line() const { return line_; }
  // Line number, counted from 1.
  std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::string_view line_;
  std::size_t number_ = 0;
};

// The words of a line, separated by blanks.
std::vector<std::string_view> Words(std::string_view line);

// Parses exactly values.size() finite numbers, separated by blanks; false for anything else.
bool ParseNumbers(std::string_view line, std::span<double> values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_TEXT_LINES_H_
