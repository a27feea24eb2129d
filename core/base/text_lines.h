#ifndef FASCICLE_CORE_BASE_TEXT_LINES_H_
#define FASCICLE_CORE_BASE_TEXT_LINES_H_

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace fascicle {

// Goes through the lines of a text that hold something, without the comments that `#` starts and the blanks around
// them.
class TextLines {
 public:
  // `text` must outlive this.
  explicit TextLines(std::string_view text) : rest_(text) {}

  // To the next one; false when there is none.
  bool Next();
  std::string_view line() const { return line_; }
  // As an editor counts, from 1.
  std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::string_view line_;
  std::size_t number_ = 0;
};

// The words of a line, with blanks between them.
std::vector<std::string_view> Words(std::string_view line);

// Exactly as many finite numbers as `values` has, with blanks between them; false for anything else.
bool ParseNumbers(std::string_view line, std::span<double> values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_TEXT_LINES_H_
