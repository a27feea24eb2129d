#include "client/cli/outputs.h"

#include <algorithm>
#include <map>

namespace fascicle::client {
namespace {

const char* QuantityOf(const std::string& unit) {
  static const std::map<std::string, const char*> names = {{"J", "energy"},   {"N", "force"},    {"m", "length"},
                                                           {"Pa", "stress"},  {"1", "value"},    {"m/s", "speed"},
                                                           {"s", "duration"}, {"m^3", "volume"}, {"W", "power"}};
  const auto found = names.find(unit);
  return found == names.end() ? "value" : found->second;
}

bool StaysZero(const SeriesTable::Column& column) {
  return std::all_of(column.values.begin(), column.values.end(), [](double value) { return value == 0; });
}

std::vector<const SeriesTable::Column*> Choose(const SeriesTable& table, const std::vector<std::string>& globs) {
  std::vector<const SeriesTable::Column*> chosen;
  for (const SeriesTable::Column& column : table.columns()) {
    const bool wanted = globs.empty() ? !StaysZero(column) && !column.is_pose && !column.name.starts_with("solver/")
                                      : std::any_of(globs.begin(), globs.end(), [&](const std::string& glob) {
                                          return MatchesGlob(glob, column.name);
                                        });
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
    const std::string unit = column->unit == "1" ? "" : " [" + column->unit + "]";
    const std::string label = QuantityOf(column->unit) + unit;
    auto panel = std::find_if(panels.rbegin(), panels.rend(), [&](const PlotPanel& p) { return p.y_label == label; });
    // Dimensionless series have different scales, such as volume ratios and iterations, and get separate panels.
    const bool apart = column->unit == "1" || panel == panels.rend() || panel->lines.size() == kMostLines;
    if (apart) {
      panels.push_back({column->unit == "1" ? column->name : "", "time [s]", label, {}});
      panel = panels.rbegin();
    }
    panel->lines.push_back({column->name, table.times(), column->values});
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
