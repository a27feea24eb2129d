#include "client/import/expression.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

using Operation = Expression::Operation;

constexpr std::pair<std::string_view, double (*)(double)> kOneArgument[] = {
    {"sin", [](double x) { return std::sin(x); }},
    {"cos", [](double x) { return std::cos(x); }},
    {"tan", [](double x) { return std::tan(x); }},
    {"asin", [](double x) { return std::asin(x); }},
    {"acos", [](double x) { return std::acos(x); }},
    {"atan", [](double x) { return std::atan(x); }},
    {"sinh", [](double x) { return std::sinh(x); }},
    {"cosh", [](double x) { return std::cosh(x); }},
    {"tanh", [](double x) { return std::tanh(x); }},
    {"exp", [](double x) { return std::exp(x); }},
    {"ln", [](double x) { return std::log(x); }},
    {"log", [](double x) { return std::log10(x); }},
    {"sqrt", [](double x) { return std::sqrt(x); }},
    {"abs", [](double x) { return std::abs(x); }},
    {"sgn", [](double x) { return x > 0   ? 1.0
                                  : x < 0 ? -1.0
                                          : 0.0; }},
    {"H", [](double x) { return x > 0   ? 1.0
                                : x < 0 ? 0.0
                                        : 0.5; }},
    {"step", [](double x) { return x >= 0 ? 1.0 : 0.0; }},
};
constexpr std::pair<std::string_view, double (*)(double, double)> kTwoArguments[] = {
    {"max", [](double a, double b) { return std::max(a, b); }},
    {"min", [](double a, double b) { return std::min(a, b); }},
    {"atan2", [](double a, double b) { return std::atan2(a, b); }},
    {"pow", [](double a, double b) { return std::pow(a, b); }},
};

// Recursive descent, with a limit of depth.
class Parser {
 public:
  Parser(std::string_view text, std::string_view variable) : text_(text), variable_(variable) {}

  bool ParseAll() {
    Sum();
    Skip();
    if (mistake_.empty() && at_ < text_.size()) Fail();
    return mistake_.empty();
  }

  std::vector<Operation> operations;
  const std::string& mistake() const { return mistake_; }

 private:
  static constexpr int kDeepest = 50;
  static constexpr std::size_t kLongest = 10'000;

  void Fail(const std::string& what = {}) {
    if (!mistake_.empty()) return;
    mistake_ = Quoted(text_) + (what.empty() ? " is not a formula that can be read" : " " + what);
    at_ = text_.size();
  }

  void Skip() {
    while (at_ < text_.size() &&
           (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r')) {
      ++at_;
    }
  }

  bool Next(char c) {
    Skip();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  void Apply(double (*one)(double)) { operations.push_back({Operation::Kind::kOne, 0, one, nullptr}); }
  void Apply(double (*two)(double, double)) { operations.push_back({Operation::Kind::kTwo, 0, nullptr, two}); }

  void Sum() {
    if (++depth_ > kDeepest || text_.size() > kLongest) return Fail("is too long");
    Product();
    while (mistake_.empty()) {
      if (Next('+')) {
        Product();
        Apply([](double a, double b) { return a + b; });
      } else if (Next('-')) {
        Product();
        Apply([](double a, double b) { return a - b; });
      } else {
        break;
      }
    }
    --depth_;
  }

  void Product() {
    Signed();
    while (mistake_.empty()) {
      if (Next('*')) {
        Signed();
        Apply([](double a, double b) { return a * b; });
      } else if (Next('/')) {
        Signed();
        Apply([](double a, double b) { return a / b; });
      } else {
        break;
      }
    }
  }

  void Signed() {
    if (++depth_ > kDeepest) return Fail("is too long");
    if (Next('-')) {
      Signed();
      Apply([](double a) { return -a; });
    } else {
      if (Next('+')) return Signed();
      Power();
    }
    --depth_;
  }

  void Power() {
    Atom();
    if (!mistake_.empty() || !Next('^')) return;
    Signed();
    Apply([](double a, double b) { return std::pow(a, b); });
  }

  void Atom() {
    Skip();
    if (Next('(')) {
      Sum();
      if (!Next(')')) Fail();
      return;
    }
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
    if (at_ >= text_.size()) return Fail();
    const std::size_t begin = at_;
    if (is_digit(text_[at_])) {
      while (at_ < text_.size()) {
        const char c = text_[at_];
        const bool is_sign = (c == '+' || c == '-') && (text_[at_ - 1] == 'e' || text_[at_ - 1] == 'E');
        if (!is_digit(c) && c != 'e' && c != 'E' && !is_sign) break;
        ++at_;
      }
      double number = 0;
      if (!ParseDouble(text_.substr(begin, at_ - begin), number)) return Fail();
      operations.push_back({Operation::Kind::kNumber, number, nullptr, nullptr});
      return;
    }
    if (!is_letter(text_[at_])) return Fail();
    while (at_ < text_.size() && (is_letter(text_[at_]) || (is_digit(text_[at_]) && text_[at_] != '.'))) ++at_;
    Named(text_.substr(begin, at_ - begin));
  }

  void Named(std::string_view name) {
    if (!variable_.empty() && name == variable_) {
      operations.push_back({Operation::Kind::kVariable, 0, nullptr, nullptr});
      return;
    }
    if (name == "pi") {
      operations.push_back({Operation::Kind::kNumber, std::numbers::pi, nullptr, nullptr});
      return;
    }
    for (const auto& [known, function] : kOneArgument) {
      if (known == name) {
        Arguments(1);
        return Apply(function);
      }
    }
    for (const auto& [known, function] : kTwoArguments) {
      if (known == name) {
        Arguments(2);
        return Apply(function);
      }
    }
    Fail("depends on " + Quoted(name) + ", which is not known here");
  }

  void Arguments(int count) {
    if (!Next('(')) return Fail();
    for (int k = 0; k < count && mistake_.empty(); ++k) {
      if (k > 0 && !Next(',')) return Fail();
      Sum();
    }
    if (!Next(')')) Fail();
  }

  std::string_view text_, variable_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::string mistake_;
};

}  // namespace

std::optional<Expression> Expression::Parse(std::string_view text, std::string_view variable, std::string& mistake) {
  Parser parser(text, variable);
  if (!parser.ParseAll()) {
    mistake = parser.mistake();
    return std::nullopt;
  }
  Expression expression;
  expression.operations_ = std::move(parser.operations);
  return expression;
}

double Expression::At(double variable) const {
  std::vector<double> stack;
  for (const Operation& operation : operations_) {
    switch (operation.kind) {
      case Operation::Kind::kNumber:
        stack.push_back(operation.number);
        break;
      case Operation::Kind::kVariable:
        stack.push_back(variable);
        break;
      case Operation::Kind::kOne:
        stack.back() = operation.one(stack.back());
        break;
      case Operation::Kind::kTwo: {
        const double second = stack.back();
        stack.pop_back();
        stack.back() = operation.two(stack.back(), second);
        break;
      }
    }
  }
  return stack.back();
}

}  // namespace fascicle::client
