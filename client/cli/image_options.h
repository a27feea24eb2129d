#ifndef FASCICLE_CLIENT_CLI_IMAGE_OPTIONS_H_
#define FASCICLE_CLIENT_CLI_IMAGE_OPTIONS_H_

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/render/slices.h"
#include "core/base/problems.h"
#include "core/imaging/image_stage.h"
#include "core/imaging/volume_image.h"

namespace fascicle::client {

// Options of `segment` and `voxelize` that describe the image and the selection of the body. Lengths in millimetres,
// voxels counted from 0 along i, j, k of the file.
struct ImageOptions {
  std::vector<std::string> files;
  std::string raw_size, raw_spacing, raw_type = "int16";
  bool raw_big_endian = false;
  std::int64_t raw_skip = 0;
  std::string region;
  double resample = 0;
  std::vector<std::string> filters;
  std::string method = "fuzzy";
  int classes = Classification().classes;
  std::vector<double> thresholds;
  std::optional<int> wanted_class;
  double fuzziness = Classification().fuzziness;
  double membership = 0;
  std::vector<int> labels;
  bool mask = false;
  std::vector<std::string> seeds;
  double opening = 0;
  std::string keep;  // empty: the islands of the seeds, or the largest without seeds
  bool no_fill = false;
  int threads = 1;
  std::string out;
  std::string scene;
  std::string picture;
  std::vector<double> window;  // level and width; empty: percentiles
  std::optional<double> crop;  // [mm]
};

// Adds --window and --crop, which change pictures of slices. The values must outlive parsing.
void AddSliceOptions(CLI::App& command, std::vector<double>& window, std::optional<double>& crop);
void SetSliceOptions(const std::vector<double>& window, const std::optional<double>& crop, SlicesInput& input);

// Adds IMAGE and all of its options. `options` must outlive parsing.
void AddImageOptions(CLI::App& command, ImageOptions& options);

struct GivenImage {
  VolumeImage image;
  ImageStage stage;
};
// Reads the image and evaluates the options. CommandError with all problems (the path is the option or file), including
// the given ones, if there are any. Stopped after a stop request.
GivenImage ReadGivenImage(const ImageOptions& options, const std::stop_token& stop, Problems problems);

// Runs the stage with progress on stderr. CommandError with all problems, whose paths are options; Stopped after a stop
// request.
StagedImage RunStage(const ImageOptions& options, const GivenImage& given, const std::stop_token& stop);

// Draws the body's outline on slices of the image.
void DrawBody(const StagedImage& staged, const ImageOptions& options, const std::string& title);

// The last component of the first path, for titles.
std::string TitleOf(const ImageOptions& options);

// Writes integers below 256 as an image. CommandError if that fails.
void WriteLabels(const VolumeImage& labels, const std::string& path);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_IMAGE_OPTIONS_H_
