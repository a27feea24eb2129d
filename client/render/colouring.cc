#include "client/render/colouring.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "client/render/field_values.h"

namespace fascicle::client {
namespace {

// Common properties of the values of all frames.
struct Quantity {
  std::string title;
  std::string unit;
  bool found = false;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;

  void Name(const std::string& its_title, const std::string& its_unit) {
    if (found && unit != its_unit) {
      throw std::runtime_error("`" + title + "` is in " + unit + " of one object and in " + its_unit + " of another");
    }
    title = its_title;
    unit = its_unit;
    found = true;
  }
  void Hold(double value) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
};

void ColourBodies(const std::vector<BodyShape>& bodies, const v1::Frame& frame, const std::string& name,
                  Colouring& colouring, Quantity& quantity) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const v1::BodyFrame& body = frame.bodies(static_cast<int>(i));
    if (!HasField(body, name)) continue;
    NodeValues nodes = ValuesAtNodes(bodies[i], body, name);
    quantity.Name(nodes.title, nodes.unit);
    for (const double value : nodes.values) quantity.Hold(value);
    colouring.bodies[i] = std::move(nodes.values);
  }
}

void ColourLines(const std::vector<LineInfo>& lines, const v1::Frame& frame, const std::string& name,
                 Colouring& colouring, Quantity& quantity) {
  const std::vector<LinePath> paths = DecodeLines(frame, lines);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t v = 0; v < lines[i].values.size(); ++v) {
      if (lines[i].values[v].name() != name) continue;
      quantity.Name(name, lines[i].values[v].unit());
      quantity.Hold(paths[i].values[v]);
      colouring.lines[i] = paths[i].values[v];
    }
  }
}

// The quantities by which the first body and the first line can be coloured.
std::string KnownNames(const std::vector<LineInfo>& lines, const v1::Frame& frame) {
  std::string known;
  if (frame.bodies_size() > 0) known = FieldNames(frame.bodies(0)) + " (the scene's output.fields says which are kept)";
  if (lines.empty()) return known;
  std::string of_lines;
  for (const v1::SeriesInfo& value : lines[0].values) of_lines += (of_lines.empty() ? "" : ", ") + value.name();
  return known + (known.empty() ? "of lines: " : "; of lines: ") + of_lines;
}

void Scale(double factor, Colouring& colouring) {
  for (auto& values : colouring.bodies) {
    for (double& value : values) value *= factor;
  }
  for (auto& value : colouring.lines) {
    if (value) *value *= factor;
  }
}

}  // namespace

std::vector<Colouring> ColourFrames(const std::vector<BodyShape>& bodies, const std::vector<LineInfo>& lines,
                                    std::span<const v1::Frame> frames, const std::string& name,
                                    const std::optional<std::pair<double, double>>& range) {
  std::vector<Colouring> colourings(frames.size());
  for (Colouring& colouring : colourings) {
    colouring.bodies.resize(bodies.size());
    colouring.lines.resize(lines.size());
  }
  if (name.empty()) return colourings;
  Quantity quantity;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    ColourBodies(bodies, frames[f], name, colourings[f], quantity);
    ColourLines(lines, frames[f], name, colourings[f], quantity);
  }
  if (!quantity.found) {
    throw std::runtime_error("there is no field `" + name +
                             "` in the frame; there are: " + KnownNames(lines, frames.front()));
  }
  if (range) std::tie(quantity.lowest, quantity.highest) = *range;
  const double largest = std::max(std::abs(quantity.lowest), std::abs(quantity.highest));
  const ReadableUnit readable = MakeReadable(largest, quantity.unit);
  std::replace(quantity.title.begin(), quantity.title.end(), '_', ' ');
  const ColourScale scale =
      MakeColourScale(quantity.lowest * readable.factor, quantity.highest * readable.factor, range.has_value());
  for (Colouring& colouring : colourings) {
    Scale(readable.factor, colouring);
    colouring.scale = scale;
    colouring.title = quantity.title + (readable.name.empty() ? "" : " [" + readable.name + "]");
  }
  return colourings;
}

}  // namespace fascicle::client
