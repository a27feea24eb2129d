#ifndef FASCICLE_CLIENT_CLI_OUTPUTS_H_
#define FASCICLE_CLIENT_CLI_OUTPUTS_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/follow.h"
#include "client/lib/decode.h"
#include "client/render/picture.h"
#include "client/render/plot.h"

namespace fascicle::client {

// The panels of a plot: the columns that match one of `globs`, grouped by unit. Without globs, all columns except those
// that are always zero (or below 1e-9 of the largest in their unit), those of the solver and poses. CommandError if a
// glob matches nothing.
std::vector<PlotPanel> PanelsOf(const SeriesTable& table, const std::vector<std::string>& globs);

// Writes the panels, with at most 8 lines each, as a PNG whose height grows with their number.
void WritePlot(const std::vector<PlotPanel>& panels, const std::filesystem::path& path);

// Finds the frame of a run in which a node is farthest from its rest position. Not thread-safe.
class LargestDisplacement {
 public:
  void Add(const v1::Geometry& geometry, const v1::Frame& frame);
  // That frame, if its largest displacement is clearly above the last one's: a body that has returned to its shape.
  const std::optional<v1::Frame>& frame() const;

 private:
  std::vector<BodyShape> shapes_;  // of the first frame's geometry
  std::optional<v1::Frame> frame_;
  double largest_ = 0, last_ = 0;  // [m]
};

// Defaults for a picture: the frame's title, coloured by von Mises stress if the scene stores it, otherwise by
// displacement; without colours if there are no bodies.
PictureOptions DefaultPicture(const v1::Job& job, const v1::Frame& frame);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_OUTPUTS_H_
