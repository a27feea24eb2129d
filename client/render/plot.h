#ifndef FASCICLE_CLIENT_RENDER_PLOT_H_
#define FASCICLE_CLIENT_RENDER_PLOT_H_

#include <filesystem>
#include <string>
#include <vector>

#include "client/render/canvas.h"

namespace fascicle::client {

// One line of a plot; points with NaN are omitted.
struct PlotLine {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
  bool as_points = false;  // marks without a line, as for measured values
};

// Lines with common axes.
struct PlotPanel {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<PlotLine> lines;
};

// Draws the panels below each other and writes a PNG. Throws std::runtime_error with a message for users.
void DrawPlot(const std::vector<PlotPanel>& panels, PictureSize size, const std::filesystem::path& path);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_PLOT_H_
