#ifndef FASCICLE_CORE_GEOMETRY_TEXT_SCANNER_H_
#define FASCICLE_CORE_GEOMETRY_TEXT_SCANNER_H_

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/problems.h"

namespace fascicle {

// Reads tokens, lines and raw bytes from untrusted text. The first failure adds one problem with the line number and
// ends the input: from then on numbers are 0, tokens and lines are empty, and failed() is true.
class TextScanner {
 public:
  // Text and problems must outlive the scanner. A `comment` character starts a comment that extends to the end of its
  // line. Whatever takes something throws Stopped after a stop request.
  TextScanner(std::string_view text, Problems& problems, char comment = '\0', std::stop_token stop = {})
      : rest_(text), problems_(problems), comment_(comment), stop_(std::move(stop)) {}

  bool failed() const { return failed_; }
  int line() const { return line_; }
  std::size_t remaining() const { return rest_.size(); }

  // The next token, delimited by white space; empty at the end.
  std::string_view Token();
  std::string_view Peek();
  // Whether only white space and comments are left.
  bool AtEnd() { return Peek().empty(); }
  // The rest of the current line, without the line break: LF, CR LF or CR.
  std::string_view Line();
  // Exactly `size` raw bytes; fails if there are fewer.
  std::string_view Bytes(std::size_t size, std::string_view what);

  // Numbers. `what` names them in problems, as in "a node number".
  std::int64_t Int(std::string_view what);
  double Double(std::string_view what);
  // A number of items that follow, each at least `bytes_each` long. Fails if the rest of the text cannot hold them.
  std::size_t Count(std::string_view what, std::size_t bytes_each);
  // Whether the rest of the text can hold `count` items of `bytes_each`; fails otherwise.
  bool Holds(std::int64_t count, std::string_view what, std::size_t bytes_each);

  // Requires the next token to be exactly `word`, or `word` with letters of any case.
  void Expect(std::string_view word);
  void ExpectInAnyCase(std::string_view word);

  // Adds the problem "line N: message".
  void Fail(const std::string& message, std::string hint = {});

 private:
  void SkipSpace();
  bool EndsLine(std::size_t at) const;
  void FailAt(std::string_view token, std::string_view what);

  std::string_view rest_;
  Problems& problems_;
  char comment_;
  std::stop_token stop_;
  int line_ = 1;
  bool failed_ = false;
};

// Parses the whole of `token` as a number.
bool ParseInt(std::string_view token, std::int64_t& value);
bool ParseDouble(std::string_view token, double& value);

// Whether two words differ at most in the case of their letters (ASCII).
bool SameInAnyCase(std::string_view a, std::string_view b);

// The text without the byte-order mark of UTF-8 that some programs write at its beginning.
std::string_view WithoutByteOrderMark(std::string_view bytes);

// `token` in a form fit for a message: short, printable, in quotes.
std::string Quoted(std::string_view token);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_TEXT_SCANNER_H_
