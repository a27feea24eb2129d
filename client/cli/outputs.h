#ifndef FASCICLE_CLIENT_CLI_OUTPUTS_H_
#define FASCICLE_CLIENT_CLI_OUTPUTS_H_

#include <filesystem>
#include <string>
#include <vector>

#include "client/cli/follow.h"
#include "client/render/picture.h"
#include "client/render/plot.h"

namespace fascicle::client {

// Panels of a plot: the columns that match one of `globs`, those of one unit together. Without globs all columns but
// those that stay zero, those of the solver and poses. CommandError when a glob matches nothing.
std::vector<PlotPanel> PanelsOf(const SeriesTable& table, const std::vector<std::string>& globs);

// The panels with up to 8 lines each as a PNG, higher the more panels there are.
void WritePlot(const std::vector<PlotPanel>& panels, const std::filesystem::path& path);

// The frame's title, and the field that tells most: the von Mises stress when the scene keeps it, or displacement;
// none without bodies.
PictureOptions DefaultPicture(const v1::Job& job, const v1::Frame& frame);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_OUTPUTS_H_
