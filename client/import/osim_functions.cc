#include "client/import/osim_functions.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

constexpr std::string_view kKinds[] = {
    "Constant",           "LinearFunction", "PolynomialFunction",      "SimmSpline",
    "NaturalCubicSpline", "GCVSpline",      "PiecewiseLinearFunction", "MultiplierFunction"};

std::optional<ScalarFunction> ThroughPoints(XmlSource& xml, pugi::xml_node node, bool is_cubic) {
  std::vector<double> x = NumbersOf(xml, node.child("x")), y = NumbersOf(xml, node.child("y"));
  const bool ascends = std::adjacent_find(x.begin(), x.end(), [](double a, double b) { return !(a < b); }) == x.end();
  if (x.size() < 2 || x.size() != y.size() || !ascends) {
    xml.Fail(node, "needs at least two points with ascending x, and as many y");
    return std::nullopt;
  }
  return is_cubic ? ScalarFunction::Cubic(std::move(x), std::move(y))
                  : ScalarFunction::PiecewiseLinear(std::move(x), std::move(y));
}

}  // namespace

std::vector<double> NumbersOf(XmlSource& xml, pugi::xml_node node) {
  std::vector<double> values;
  for (const std::string& word : xml.Words(node)) {
    double value = 0;
    if (!ParseDouble(word, value) || !std::isfinite(value)) {
      xml.Fail(node, "`" + word.substr(0, 40) + "` is not a number");
      return {};
    }
    values.push_back(value);
  }
  return values;
}

std::optional<ScalarFunction> ReadFunction(XmlSource& xml, pugi::xml_node parent) {
  for (const pugi::xml_node node : parent.children()) {
    const std::string_view kind = node.name();
    if (kind == "function") return ReadFunction(xml, node);
    if (std::find(std::begin(kKinds), std::end(kKinds), kind) == std::end(kKinds)) {
      if (kind.ends_with("Function") || kind.ends_with("Spline")) {
        xml.Fail(node, "functions of this kind are not supported", "use a SimmSpline or a PolynomialFunction");
        return std::nullopt;
      }
      continue;
    }
    xml.TakeAll(node);
    if (kind == "Constant") return ScalarFunction::Constant(xml.Number(node.child("value")));
    if (kind == "MultiplierFunction") {
      const double scale = node.child("scale") ? xml.Number(node.child("scale")) : 1;
      const auto inner = ReadFunction(xml, node);
      return inner ? std::optional(inner->Scaled(scale)) : std::nullopt;
    }
    if (kind == "PiecewiseLinearFunction") return ThroughPoints(xml, node, false);
    if (kind.ends_with("Spline")) return ThroughPoints(xml, node, true);
    std::vector<double> coefficients = NumbersOf(xml, node.child("coefficients"));  // highest power first
    std::reverse(coefficients.begin(), coefficients.end());
    return ScalarFunction::Polynomial(std::move(coefficients));
  }
  return std::nullopt;
}

}  // namespace fascicle::client
