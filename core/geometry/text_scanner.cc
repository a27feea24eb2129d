#include "core/geometry/text_scanner.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "core/base/stop.h"

namespace fascicle {
namespace {

bool IsSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

constexpr const char* kCutOff = "is the file complete?";

template <class Number>
bool Parse(std::string_view token, Number& value) {
  if (token.starts_with('+')) token.remove_prefix(1);
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  return error == std::errc() && end == token.data() + token.size();
}

// Whether the token would be a number if its comma were a point.
bool HasDecimalComma(std::string_view token) {
  const std::size_t comma = token.find(',');
  if (comma == std::string_view::npos) return false;
  std::string with_point(token);
  with_point[comma] = '.';
  double value = 0;
  return ParseDouble(with_point, value);
}

}  // namespace

bool SameInAnyCase(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

std::string_view WithoutByteOrderMark(std::string_view bytes) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return bytes.starts_with(kMark) ? bytes.substr(kMark.size()) : bytes;
}

bool ParseInt(std::string_view token, std::int64_t& value) { return Parse(token, value); }
bool ParseDouble(std::string_view token, double& value) { return Parse(token, value); }

std::string Quoted(std::string_view token) {
  constexpr std::size_t kLongest = 40;
  std::string text = "`";
  for (const char c : token.substr(0, kLongest)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (token.size() > kLongest ? "...`" : "`");
}

void TextScanner::SkipSpace() {
  ThrowIfStopped(stop_);
  std::size_t i = 0;
  for (bool in_comment = false; i < rest_.size(); ++i) {
    const char c = rest_[i];
    if (EndsLine(i)) {
      ++line_;
      in_comment = false;
    } else if (!in_comment && comment_ != '\0' && c == comment_) {
      in_comment = true;
    } else if (!in_comment && !IsSpace(c)) {
      break;
    }
  }
  rest_.remove_prefix(i);
}

std::string_view TextScanner::Peek() {
  SkipSpace();
  const auto end = std::find_if(rest_.begin(), rest_.end(),
                                [this](char c) { return IsSpace(c) || (comment_ != '\0' && c == comment_); });
  return rest_.substr(0, end - rest_.begin());
}

std::string_view TextScanner::Token() {
  const std::string_view token = Peek();
  rest_.remove_prefix(token.size());
  return token;
}

std::string_view TextScanner::Line() {
  ThrowIfStopped(stop_);
  std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  const std::string_view text = rest_.substr(0, end);
  if (end < rest_.size()) ++line_;
  if (rest_.substr(end).starts_with("\r\n")) ++end;
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  return text;
}

// A CR before a LF belongs to it.
bool TextScanner::EndsLine(std::size_t at) const {
  return rest_[at] == '\n' || (rest_[at] == '\r' && !rest_.substr(at + 1).starts_with('\n'));
}

std::string_view TextScanner::Bytes(std::size_t size, std::string_view what) {
  ThrowIfStopped(stop_);
  if (size > rest_.size()) {
    Fail(std::to_string(size) + " " + std::string(what) + " are announced, but the file ends after " +
             std::to_string(rest_.size()) + " more",
         kCutOff);
    return {};
  }
  const std::string_view bytes = rest_.substr(0, size);
  rest_.remove_prefix(size);
  return bytes;
}

std::int64_t TextScanner::Int(std::string_view what) {
  const std::string_view token = Token();
  std::int64_t value = 0;
  if (ParseInt(token, value)) return value;
  FailAt(token, what);
  return 0;
}

double TextScanner::Double(std::string_view what) {
  const std::string_view token = Token();
  double value = 0;
  if (ParseDouble(token, value)) return value;
  FailAt(token, what);
  return 0;
}

std::size_t TextScanner::Count(std::string_view what, std::size_t bytes_each) {
  const std::int64_t count = Int("the number of " + std::string(what));
  return Holds(count, what, bytes_each) ? static_cast<std::size_t>(count) : 0;
}

bool TextScanner::Holds(std::int64_t count, std::string_view what, std::size_t bytes_each) {
  if (failed_) return false;
  if (count < 0) {
    Fail("the number of " + std::string(what) + " is " + std::to_string(count));
  } else if (static_cast<std::uint64_t>(count) > (rest_.size() + 1) / bytes_each) {
    // One more, because the last item may end without a newline.
    Fail(std::to_string(count) + " " + std::string(what) + " are announced, but the file ends after " +
             std::to_string(rest_.size()) + " bytes more",
         kCutOff);
  }
  return !failed_;
}

void TextScanner::Expect(std::string_view word) {
  const std::string_view token = Token();
  if (token != word) FailAt(token, word);
}

void TextScanner::ExpectInAnyCase(std::string_view word) {
  const std::string_view token = Token();
  if (!SameInAnyCase(token, word)) FailAt(token, word);
}

void TextScanner::FailAt(std::string_view token, std::string_view what) {
  if (token.empty()) {
    Fail("the file ends where " + std::string(what) + " should follow", kCutOff);
  } else {
    Fail("expected " + std::string(what) + " but found " + Quoted(token),
         HasDecimalComma(token) ? "write numbers with a decimal point, not a comma" : "");
  }
}

void TextScanner::Fail(const std::string& message, std::string hint) {
  if (!failed_) problems_.Add("", "line " + std::to_string(line_) + ": " + message, std::move(hint));
  failed_ = true;
  rest_ = {};
}

}  // namespace fascicle
