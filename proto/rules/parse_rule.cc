#include "proto/rules/parse_rule.h"

#include <charconv>
#include <limits>
#include <vector>

namespace fascicle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string_view Trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::vector<std::string_view> SplitAt(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto end = text.find(separator);
    parts.push_back(Trim(text.substr(0, end)));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

bool Consume(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

bool ParseNumber(std::string_view text, double& value) {
  if (text == "inf" || text == "-inf") {
    value = text == "inf" ? kInfinity : -kInfinity;
    return true;
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

// "(0, 30000]"
bool ParseRange(std::string_view text, FieldRule& rule) {
  rule.range_text = text;
  if (text.size() < 5) return false;
  const char open = text.front(), close = text.back();
  if ((open != '(' && open != '[') || (close != ')' && close != ']')) return false;
  const auto ends = SplitAt(text.substr(1, text.size() - 2), ',');
  if (ends.size() != 2 || !ParseNumber(ends[0], rule.min) || !ParseNumber(ends[1], rule.max)) return false;
  rule.min_open = open == '(';
  rule.max_open = close == ')';
  return rule.min < rule.max;
}

// "default 0 0 0", "required" or "optional"
bool ParsePresence(std::string_view text, FieldRule& rule) {
  if (text == "required") return rule.required = true;
  if (text == "optional") return true;
  if (!Consume(text, "default ")) return false;
  rule.default_text = text;
  for (const std::string_view word : SplitAt(text, ' ')) {
    double value = 0;
    if (!ParseNumber(word, value)) return false;
    rule.defaults.push_back(value);
  }
  return rule.defaults.size() == (rule.values > 0 ? static_cast<std::size_t>(rule.values) : 1);
}

bool ParseCount(std::string_view text, FieldRule& rule) {
  const auto blank = text.find(' ');
  if (blank == std::string_view::npos || text.substr(blank) != " values") return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + blank, rule.values);
  return error == std::errc() && end == text.data() + blank && rule.values > 0;
}

}  // namespace

SplitComment Split(std::string_view comment) {
  SplitComment split;
  auto lines = SplitAt(Trim(comment), '\n');
  if (lines.back().starts_with("Unit ") && lines.back().find("; range ") != std::string_view::npos) {
    split.rule = lines.back();
    lines.pop_back();
  }
  for (std::size_t i = 0; i < lines.size(); ++i) split.text.append(i > 0 ? "\n" : "").append(lines[i]);
  return split;
}

std::optional<FieldRule> ParseRule(std::string_view line) {
  line = Trim(line);
  if (!Consume(line, "Unit ") || !line.ends_with('.')) return std::nullopt;
  line.remove_suffix(1);
  const auto parts = SplitAt(line, ';');
  if (parts.size() != 3 && parts.size() != 4) return std::nullopt;
  FieldRule rule;
  rule.unit = parts[0];
  if (rule.unit.empty()) return std::nullopt;
  if (parts.size() == 4 && !ParseCount(parts[1], rule)) return std::nullopt;
  std::string_view range = parts[parts.size() - 2];
  if (!Consume(range, "range ") || !ParseRange(Trim(range), rule)) return std::nullopt;
  if (!ParsePresence(parts.back(), rule)) return std::nullopt;
  return rule;
}

}  // namespace fascicle
