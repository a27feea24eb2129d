#include "client/import/xml_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "client/import/expression.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

bool IsSeparator(char c) { return c == ',' || c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Calls `use` for each token between commas and white space until it returns false.
template <class Use>
bool ForEachToken(std::string_view text, const Use& use) {
  std::size_t at = 0;
  while (true) {
    while (at < text.size() && IsSeparator(text[at])) ++at;
    if (at == text.size()) return true;
    const std::size_t begin = at;
    while (at < text.size() && !IsSeparator(text[at])) ++at;
    if (!use(text.substr(begin, at - begin))) return false;
  }
}

std::string Trimmed(std::string text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (!text.empty() && is_space(text.back())) text.pop_back();
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), is_space));
  return text;
}

}  // namespace

XmlSource::XmlSource(std::string name, std::string_view bytes, Problems& problems)
    : name_(std::move(name)), problems_(problems), count_before_(problems.count()), buffer_(bytes) {
  for (std::size_t at = bytes.find('\n'); at != std::string_view::npos; at = bytes.find('\n', at + 1)) {
    line_ends_.push_back(at);
  }
  if (bytes.starts_with("\xFE\xFF") || bytes.starts_with("\xFF\xFE")) {
    problems_.Add(name_, "the file is written in UTF-16", "write it in UTF-8");
    return;
  }
  // Names and numbers are ASCII in every encoding, and line numbers are unaffected.
  const pugi::xml_parse_result result =
      document_.load_buffer_inplace(buffer_.data(), buffer_.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    const auto line = std::lower_bound(line_ends_.begin(), line_ends_.end(), std::size_t(result.offset));
    problems_.Add(name_ + ":" + std::to_string(1 + (line - line_ends_.begin())),
                  std::string("this is not XML: ") + result.description(), "is the file complete?");
    document_.reset();
  }
}

int XmlSource::LineOf(pugi::xml_node node) const {
  const std::ptrdiff_t offset = node.offset_debug();
  if (offset < 0) return 0;
  return 1 + static_cast<int>(std::lower_bound(line_ends_.begin(), line_ends_.end(), std::size_t(offset)) -
                              line_ends_.begin());
}

std::string XmlSource::PathOf(pugi::xml_node node) const {
  std::string path;
  for (int depth = 0; node && node.parent().parent() && depth < 8; node = node.parent(), ++depth) {
    std::string step = std::string(node.name()).substr(0, 40);
    for (const char* key : {"name", "id", "lid", "type"}) {
      const pugi::xml_attribute attribute = node.attribute(key);
      if (attribute.empty()) continue;
      step += " " + Quoted(attribute.value());
      break;
    }
    path = path.empty() ? step : step + "/" + path;
  }
  return path;
}

std::string XmlSource::Where(pugi::xml_node node) const {
  const std::string path = PathOf(node);
  return name_ + ":" + std::to_string(LineOf(node)) + (path.empty() ? "" : ": " + path);
}

void XmlSource::Fail(pugi::xml_node node, const std::string& message, const std::string& hint) {
  Take(node);
  // Beyond the problems that are kept, only the count matters.
  problems_.Add(problems_.count() < Problems::kMaxKept ? Where(node) : std::string(), message, hint);
}

void XmlSource::Remark(Notice::Kind kind, pugi::xml_node node, std::string message, std::string hint) {
  constexpr std::size_t kMaxNotices = 1000;
  if (notices.size() >= kMaxNotices) return;
  notices.push_back({kind, LineOf(node), Where(node), std::move(message), std::move(hint)});
}

void XmlSource::Tell(Notice::Kind kind, pugi::xml_node node, std::string message, std::string hint) {
  TakeAll(node);
  Remark(kind, node, std::move(message), std::move(hint));
}

namespace {

// What to do about a section that has no counterpart.
const char* HintFor(pugi::xml_node node) {
  const std::string_view name = node.name();
  if (name == "Contact") return "remove it, or declare contact in the scene";
  if (name == "Discrete") return "remove it; springs have no counterpart";
  if (name == "Initial") return "remove it, or start from a result of fascicle";
  return "remove it from the model";
}

}  // namespace

void XmlSource::TellOfChildren(pugi::xml_node parent, int depth) {
  constexpr int kDeepest = 6;
  for (const pugi::xml_node child : parent.children()) {
    if (child.type() != pugi::node_element || taken_whole_.contains(child.hash_value())) continue;
    if (!taken_.contains(child.hash_value())) {
      if (depth > 0 || child.first_child()) Tell(Notice::Kind::kNotTaken, child, "", HintFor(child));
    } else if (depth < kDeepest) {
      TellOfChildren(child, depth + 1);
    }
  }
}

void XmlSource::TellOfTheRest() {
  TellOfChildren(root(), 0);
  std::stable_sort(notices.begin(), notices.end(), [](const Notice& a, const Notice& b) { return a.line < b.line; });
}

std::string XmlSource::Text(pugi::xml_node node) {
  Take(node);
  std::string text;
  for (const pugi::xml_node child : node.children()) {
    if (child.type() != pugi::node_pcdata && child.type() != pugi::node_cdata) continue;
    if (!text.empty()) text += ' ';
    text += child.value();
  }
  return Trimmed(std::move(text));
}

std::vector<std::string> XmlSource::WordsOf(std::string_view text) {
  std::vector<std::string> words;
  ForEachToken(text, [&](std::string_view token) {
    words.emplace_back(token);
    return true;
  });
  return words;
}

std::string XmlSource::Required(pugi::xml_node node, const char* attribute) {
  std::string value = Trimmed(node.attribute(attribute).value());
  if (value.empty()) Fail(node, "has no " + std::string(attribute), "give " + std::string(attribute) + "=\"...\"");
  return value;
}

bool XmlSource::Numbers(pugi::xml_node node, double* values, std::size_t count) {
  const std::string text = Text(node);
  std::size_t found = 0;
  const bool good = ForEachToken(text, [&](std::string_view token) {
    double value = 0;
    if (!ParseDouble(token, value) || !std::isfinite(value)) {
      Fail(node, Quoted(token) + " is not a number");
      return false;
    }
    if (found < count) values[found] = value;
    ++found;
    return true;
  });
  if (!good) return false;
  if (found == count) return true;
  Fail(node, "has " + std::to_string(found) + " numbers where " + std::to_string(count) + " should be");
  return false;
}

std::string XmlSource::MathText(pugi::xml_node node) {
  const pugi::xml_node inner = node.child("math");
  if (inner) Take(node);
  return Text(inner ? inner : node);
}

double XmlSource::Number(pugi::xml_node node) {
  double value = 0;
  if (std::string_view(node.attribute("type").value()) == "math") {
    const std::string text = MathText(node);
    std::string mistake;
    const auto expression = Expression::Parse(text, "", mistake);
    if (expression && std::isfinite(value = expression->At(0))) return value;
    Fail(node, expression ? Quoted(text) + " is not finite" : mistake, "give one value for all nodes and times");
    return 0;
  }
  return Numbers(node, &value, 1) ? value : 0;
}

bool XmlSource::IsConstant(pugi::xml_node node) {
  const std::string_view type = node.attribute("type").value();
  if (type.empty() || type == "const" || type == "vector" || type == "math") return true;
  Fail(node, "is given by a " + std::string(Quoted(type)) + ", not by one value for all", "give a constant value");
  return false;
}

Driven XmlSource::DrivenNumber(pugi::xml_node node) {
  Driven driven;
  driven.node = node;
  if (!IsConstant(node)) return driven;
  driven.value = Number(node);
  if (node.attribute("lc")) {
    const std::optional<std::int64_t> controller = IntegerAttribute(node, "lc");
    if (controller && *controller > 0) driven.controller = controller;  // 0 means none
  }
  return driven;
}

bool XmlSource::Flag(pugi::xml_node node) {
  if (!node) return false;
  const std::string text = Text(node);
  if (text == "1" || text == "true") return true;
  if (text != "0" && text != "false") Fail(node, Quoted(text) + " is neither 0 nor 1");
  return false;
}

std::optional<Vec3> XmlSource::Vector(pugi::xml_node node) {
  Vec3 vector;
  return Numbers(node, vector.data(), 3) ? std::optional(vector) : std::nullopt;
}

std::optional<std::array<double, 2>> XmlSource::Pair(pugi::xml_node node) {
  std::array<double, 2> pair;
  return Numbers(node, pair.data(), 2) ? std::optional(pair) : std::nullopt;
}

std::optional<std::vector<std::int64_t>> XmlSource::Integers(pugi::xml_node node, std::size_t count) {
  std::vector<std::int64_t> numbers;
  numbers.reserve(count);
  const std::string text = Text(node);
  const bool good = ForEachToken(text, [&](std::string_view token) {
    std::int64_t number = 0;
    if (!ParseInt(token, number)) {
      Fail(node, Quoted(token) + " is not a whole number");
      return false;
    }
    numbers.push_back(number);
    return true;
  });
  if (!good) return std::nullopt;
  if (count > 0 && numbers.size() != count) {
    Fail(node, "has " + std::to_string(numbers.size()) + " numbers where " + std::to_string(count) + " should be");
    return std::nullopt;
  }
  return numbers;
}

std::optional<std::int64_t> XmlSource::IntegerAttribute(pugi::xml_node node, const char* attribute) {
  const std::string value = Required(node, attribute);
  std::int64_t number = 0;
  if (value.empty()) return std::nullopt;
  if (ParseInt(value, number)) return number;
  Fail(node, std::string(attribute) + " is " + Quoted(value) + ", not a whole number");
  return std::nullopt;
}

}  // namespace fascicle::client
