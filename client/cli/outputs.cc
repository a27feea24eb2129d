#include "client/cli/outputs.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "client/render/colour_scale.h"

namespace fascicle::client {
namespace {

const char* QuantityOf(const std::string& unit) {
  static const std::map<std::string, const char*> names = {{"J", "energy"},   {"N", "force"},    {"m", "length"},
                                                           {"Pa", "stress"},  {"N m", "moment"}, {"m/s", "speed"},
                                                           {"s", "duration"}, {"m^3", "volume"}, {"W", "power"}};
  const auto found = names.find(unit);
  return found == names.end() ? "" : found->second;
}

// "volume ratio" for muscle/volume_ratio: what a series without unit is called.
std::string LastPart(const std::string& name) { return SpokenName(name.substr(name.rfind('/') + 1)); }

double LargestMagnitude(const SeriesTable::Column& column) {
  double largest = 0;
  for (const double value : column.values) largest = std::fmax(largest, std::abs(value));  // ignores NaN
  return largest;
}

// Whether all values are zero, or round-off of the others in the same unit.
bool StaysZero(const SeriesTable& table, const SeriesTable::Column& column) {
  constexpr double kRoundOff = 1e-9;
  double largest = 0;
  for (const SeriesTable::Column& other : table.columns()) {
    if (other.unit == column.unit && column.unit != "1") largest = std::max(largest, LargestMagnitude(other));
  }
  return LargestMagnitude(column) <= kRoundOff * largest;
}

std::vector<const SeriesTable::Column*> Choose(const SeriesTable& table, const std::vector<std::string>& globs) {
  std::vector<const SeriesTable::Column*> chosen;
  for (const SeriesTable::Column& column : table.columns()) {
    const bool wanted = globs.empty()
                            ? !StaysZero(table, column) && !column.is_pose && !column.name.starts_with("solver/")
                            : std::any_of(globs.begin(), globs.end(),
                                          [&](const std::string& glob) { return MatchesGlob(glob, column.name); });
    if (wanted) chosen.push_back(&column);
  }
  if (chosen.empty() && !globs.empty()) {
    std::string known;
    for (const SeriesTable::Column& column : table.columns()) known += "\n  " + column.name;
    throw CommandError::Invalid("no series matches; existing series:" + known);
  }
  return chosen;
}

}  // namespace

std::vector<PlotPanel> PanelsOf(const SeriesTable& table, const std::vector<std::string>& globs) {
  constexpr std::size_t kMostLines = 8;
  std::vector<PlotPanel> panels;
  for (const SeriesTable::Column* column : Choose(table, globs)) {
    const std::string quantity = QuantityOf(column->unit);
    const std::string label =
        column->unit == "1" ? LastPart(column->name) : quantity + (quantity.empty() ? "[" : " [") + column->unit + "]";
    auto panel = std::find_if(panels.rbegin(), panels.rend(), [&](const PlotPanel& p) { return p.y_label == label; });
    // Dimensionless series have different scales, such as volume ratios and iterations, and get separate panels.
    const bool apart = column->unit == "1" || panel == panels.rend() || panel->lines.size() == kMostLines;
    if (apart) {
      panels.push_back({column->unit == "1" ? column->name : quantity, "time [s]", label, {}});
      panel = panels.rbegin();
    }
    panel->lines.push_back({column->name, table.times(), column->values, false});
  }
  return panels;
}

void WritePlot(const std::vector<PlotPanel>& panels, const std::filesystem::path& path) {
  constexpr int kPanelHeight = 330, kMostPanels = 20;
  const int count = std::clamp(static_cast<int>(panels.size()), 1, kMostPanels);
  std::vector<PlotPanel> shown = panels;
  shown.resize(std::min<std::size_t>(shown.size(), kMostPanels));
  DrawPlot(shown, {1200, std::max(500, kPanelHeight * count)}, path);
}

void LargestDisplacement::Add(const v1::Geometry& geometry, const v1::Frame& frame) {
  if (shapes_.empty()) shapes_ = DecodeGeometry(geometry);
  last_ = 0;
  for (std::size_t b = 0; b < shapes_.size(); ++b) {
    const std::vector<Vec3>& rest = shapes_[b].positions;
    const std::vector<Vec3> positions = DecodePositions(frame.bodies(static_cast<int>(b)), rest.size());
    for (std::size_t n = 0; n < rest.size(); ++n) last_ = std::max(last_, (positions[n] - rest[n]).norm());
  }
  if (last_ <= largest_) return;
  largest_ = last_;
  frame_ = frame;
}

const std::optional<v1::Frame>& LargestDisplacement::frame() const {
  static const std::optional<v1::Frame> kNone;
  constexpr double kClearly = 1.25;
  return largest_ > kClearly * last_ ? frame_ : kNone;
}

PictureOptions DefaultPicture(const v1::Job& job, const v1::Frame& frame) {
  PictureOptions options;
  options.title = job.scene_name();
  if (frame.bodies_size() == 0) {
    options.colour = "";
    return options;
  }
  for (const v1::FieldValues& field : frame.bodies(0).fields()) {
    if (field.name() == "von_mises_stress") options.colour = field.name();
  }
  return options;
}

}  // namespace fascicle::client
