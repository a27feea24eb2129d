// <LoadData>: load curves and formulas of time [FEBio Feature Manual, loadcurve, math, math-interval].
#include <algorithm>
#include <string_view>

#include "client/import/sections.h"
#include "core/base/letters.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

// A word of any case, with spaces for underscores.
std::string Plain(std::string_view word) {
  std::string plain = Lower(word);
  std::replace(plain.begin(), plain.end(), '_', ' ');
  return plain;
}

// An option that is an element or, in some files, an attribute.
std::string Option(pugi::xml_node node, const char* name, XmlSource& source) {
  if (const pugi::xml_node child = node.child(name)) return Plain(source.Text(child));
  return Plain(node.attribute(name).value());
}

// Version 2.5 has it as the type.
void ReadInterpolation(pugi::xml_node node, XmlSource& source, LoadCurve& curve) {
  const bool is_old = std::string_view(node.name()) == "loadcurve";
  const std::string text = is_old ? Plain(node.attribute("type").value()) : Option(node, "interpolate", source);
  using enum LoadCurve::Interpolation;
  if (text.empty() || text == "linear" || text == "1") {
    curve.interpolation = kLinear;
  } else if (text == "step" || text == "0") {
    curve.interpolation = kStep;
  } else if (text == "smooth" || text == "2") {
    curve.interpolation = kSmooth;
  } else if (text == "smooth step") {
    curve.interpolation = kSmoothStep;
  } else if (text == "cubic spline") {
    curve.interpolation = kSpline;
  } else {
    curve.refused = "its interpolation " + Quoted(text) +
                    " is not supported; linear, step, smooth, smooth step and cubic spline are";
  }
}

void ReadExtension(pugi::xml_node node, XmlSource& source, LoadCurve& curve) {
  const std::string text = Option(node, "extend", source);
  using enum LoadCurve::Extension;
  if (text.empty() || text == "constant" || text == "0") {
    curve.extension = kConstant;
  } else if (text == "extrapolate" || text == "1") {
    curve.extension = kExtrapolate;
  } else if (text == "repeat" || text == "2") {
    curve.extension = kRepeat;
  } else if (text == "repeat offset" || text == "3") {
    curve.extension = kRepeatOffset;
  } else {
    curve.refused =
        "its extension " + Quoted(text) + " is not supported; constant, extrapolate, repeat and repeat offset are";
  }
  curve.extension_before = curve.extension;
}

// A formula of t, with an interval and what follows outside of it for "math-interval".
void ReadFormula(pugi::xml_node node, bool has_interval, XmlSource& source, LoadCurve& curve) {
  const std::string text = source.MathText(node);
  std::string mistake;
  curve.formula = Expression::Parse(text, "t", mistake);
  if (!curve.formula) curve.refused = mistake;
  const pugi::xml_node interval = node.child("interval");
  if (!has_interval) return;
  const auto ends = interval ? source.Pair(interval) : std::nullopt;
  if (!ends || !((*ends)[0] < (*ends)[1])) {
    curve.refused = "it has no interval";
    return;
  }
  curve.times = {(*ends)[0], (*ends)[1]};
  using enum LoadCurve::Extension;
  for (const auto& [name, extension] :
       {std::pair("left_extend", &curve.extension_before), std::pair("right_extend", &curve.extension)}) {
    const std::string mode = Option(node, name, source);
    *extension = mode == "zero" || mode == "0" ? kZero : mode == "repeat" || mode == "2" ? kRepeat : kConstant;
  }
}

void ReadPoints(pugi::xml_node node, XmlSource& source, LoadCurve& curve) {
  pugi::xml_node points = node.child("points");
  if (!points) points = node;
  source.Take(points);
  for (const pugi::xml_node point : points.children()) {
    const std::string_view name = point.name();
    if (name != "pt" && name != "point" && name != "loadpoint") continue;
    const auto pair = source.Pair(point);
    if (!pair) continue;
    if (!curve.times.empty() && !((*pair)[0] > curve.times.back())) {
      source.Fail(point, "its time is not later than that of the point before", "order the points by time");
      continue;
    }
    curve.times.push_back((*pair)[0]);
    curve.values.push_back((*pair)[1]);
  }
}

}  // namespace

void ReadLoadData(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  for (const pugi::xml_node node : section.children()) {
    const std::string_view name = node.name();
    const bool is_old = name == "loadcurve";  // version 2.5
    if (!is_old && name != "load_controller") continue;
    source.TakeAll(node);
    const auto id = source.IntegerAttribute(node, "id");
    const std::string type = is_old ? "loadcurve" : source.Required(node, "type");
    if (!id || type.empty()) continue;
    LoadCurve curve;
    curve.node = node;
    if (type == "loadcurve") {
      ReadInterpolation(node, source, curve);
      ReadExtension(node, source, curve);
      const std::size_t before = source.failures();
      ReadPoints(node, source, curve);
      if (curve.times.empty() && source.failures() == before) {
        source.Fail(node, "the load curve has no points", "write <points><pt>time,value</pt>...</points>");
      }
    } else if (type == "math" || type == "math-interval") {
      ReadFormula(node, type == "math-interval", source, curve);
    } else {
      curve.refused = "it is a " + Quoted(type) + "; load curves, math and math-interval are supported";
    }
    if (!model.curves.try_emplace(*id, std::move(curve)).second) {
      source.Fail(node, "there is a load controller " + std::to_string(*id) + " already", "number them uniquely");
    }
  }
}

}  // namespace fascicle::client
