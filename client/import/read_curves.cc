// <LoadData>: load curves [FEBio Feature Manual, loadcurve].
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

void ReadInterpolation(pugi::xml_node node, XmlSource& source, LoadCurve& curve) {
  const std::string text = Option(node, "interpolate", source);
  using enum LoadCurve::Interpolation;
  if (text.empty() || text == "linear" || text == "1") {
    curve.interpolation = kLinear;
  } else if (text == "step" || text == "0") {
    curve.interpolation = kStep;
  } else if (text == "smooth" || text == "2") {
    curve.interpolation = kSmooth;
  } else if (text == "smooth step") {
    curve.interpolation = kSmoothStep;
  } else {
    curve.refused = "its interpolation " + Quoted(text) + " is not supported; linear, step, smooth and smooth step are";
  }
}

void ReadExtension(pugi::xml_node node, XmlSource& source, LoadCurve& curve) {
  const std::string text = Option(node, "extend", source);
  using enum LoadCurve::Extension;
  if (text.empty() || text == "constant" || text == "0") {
    curve.extension = kConstant;
  } else if (text == "extrapolate" || text == "1") {
    curve.extension = kExtrapolate;
  } else {
    curve.extension = kOther;
  }
}

void ReadPoints(pugi::xml_node node, XmlSource& source, LoadCurve& curve) {
  pugi::xml_node points = node.child("points");
  if (!points) points = node;
  source.Take(points);
  for (const pugi::xml_node point : points.children()) {
    const std::string_view name = point.name();
    if (name != "pt" && name != "point") continue;
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
  for (const pugi::xml_node node : section.children("load_controller")) {
    source.TakeAll(node);
    const auto id = source.IntegerAttribute(node, "id");
    const std::string type = source.Required(node, "type");
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
    } else {
      curve.refused = "it is a " + Quoted(type) + "; only load curves are supported";
    }
    if (!model.curves.try_emplace(*id, std::move(curve)).second) {
      source.Fail(node, "there is a load controller " + std::to_string(*id) + " already", "number them uniquely");
    }
  }
}

}  // namespace fascicle::client
