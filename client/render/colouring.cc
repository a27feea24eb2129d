#include "client/render/colouring.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
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
  std::vector<float> values;  // of all objects in all frames

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
    if (std::isfinite(value)) values.push_back(static_cast<float>(value));
  }
};

// The ends of the scale without a few values that are far off; nothing if there are none.
std::optional<std::pair<double, double>> WithoutOutliers(Quantity& quantity) {
  constexpr std::size_t kFewest = 200;
  constexpr double kPart = 0.01, kLargestGrowth = 1.5;
  if (quantity.values.size() < kFewest) return std::nullopt;
  const auto percentile = [&](double part) {
    const auto at =
        quantity.values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(quantity.values.size() - 1));
    std::nth_element(quantity.values.begin(), at, quantity.values.end());
    return static_cast<double>(*at);
  };
  const double low = percentile(kPart), high = percentile(1 - kPart);
  const double all = quantity.highest - quantity.lowest;
  if (!(high > low) || all <= kLargestGrowth * (high - low)) return std::nullopt;
  return std::pair(low, high);
}

// Displacements of bodies that have not moved are round-off, which would fill the scale. `bodies` are at rest.
bool IsStill(const Quantity& quantity, const std::vector<BodyShape>& bodies) {
  constexpr double kRoundOff = 1e-9;  // of the bodies' size
  if (quantity.unit != "m" || !quantity.title.starts_with("displacement")) return false;
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const BodyShape& body : bodies) {
    for (const Vec3& x : body.positions) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
  }
  return std::max(-quantity.lowest, quantity.highest) < kRoundOff * (high - low).norm();
}

std::string NoteOnOutliers(const Quantity& quantity, double factor) {
  char text[96];
  std::snprintf(text, sizeof text, "scale: percentiles 1 to 99\nvalues: %.4g to %.4g", quantity.lowest * factor,
                quantity.highest * factor);
  return text;
}

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

// Bodies without the field, by a value of the whole body.
void ColourBodiesBySeries(const std::vector<BodyShape>& bodies,
                          const google::protobuf::RepeatedPtrField<v1::SeriesInfo>& series, const v1::Frame& frame,
                          const std::string& name, Colouring& colouring, Quantity& quantity) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!colouring.bodies[i].empty()) continue;
    for (int k = 0; k < series.size() && k < frame.series_size(); ++k) {
      if (series[k].name() != bodies[i].name + "/" + name) continue;
      quantity.Name(name, series[k].unit());
      quantity.Hold(frame.series(k));
      colouring.bodies[i].assign(bodies[i].positions.size(), frame.series(k));
    }
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
                                    const google::protobuf::RepeatedPtrField<v1::SeriesInfo>& series,
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
    ColourBodiesBySeries(bodies, series, frames[f], name, colourings[f], quantity);
    ColourLines(lines, frames[f], name, colourings[f], quantity);
  }
  if (!quantity.found) {
    throw std::runtime_error("there is no field `" + name +
                             "` in the frame; there are: " + KnownNames(lines, frames.front()));
  }
  const bool still = !range && IsStill(quantity, bodies);
  if (still) std::tie(quantity.lowest, quantity.highest) = std::pair(0.0, 1e-3);
  const std::optional<std::pair<double, double>> most = range || still ? std::nullopt : WithoutOutliers(quantity);
  const auto [lowest, highest] = range ? *range : most ? *most : std::pair(quantity.lowest, quantity.highest);
  const double largest = std::max(std::abs(lowest), std::abs(highest));
  const ReadableUnit readable = MakeReadable(largest, quantity.unit);
  quantity.title = SpokenName(quantity.title);
  const ColourScale scale = MakeColourScale(lowest * readable.factor, highest * readable.factor, range.has_value());
  for (Colouring& colouring : colourings) {
    Scale(readable.factor, colouring);
    colouring.scale = scale;
    if (still) colouring.note = "nothing has moved";
    if (most) colouring.note = NoteOnOutliers(quantity, readable.factor);
    colouring.title = quantity.title + (readable.name.empty() ? "" : " [" + readable.name + "]");
  }
  return colourings;
}

}  // namespace fascicle::client
