#include "client/cli/image_options.h"

#include <CLI/App.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include "client/cli/stage_progress.h"
#include "client/render/slices.h"
#include "core/imaging/volume_reader.h"
#include "core/imaging/volume_writer.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr double kMillimetre = 1e-3;  // [m]

template <class T>
bool ParseNumber(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

// Parses three numbers separated by commas.
template <class T>
std::optional<std::array<T, 3>> ParseThree(const std::string& text) {
  const std::vector<std::string> parts = Split(text, ',');
  std::array<T, 3> numbers;
  if (parts.size() != 3) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    if (!ParseNumber<T>(parts[axis], numbers[axis])) return std::nullopt;
  }
  return numbers;
}

std::optional<VoxelBox> ParseRegion(const std::string& text, Problems& problems) {
  const std::vector<std::string> parts = Split(text, ':');
  const auto first = ParseThree<std::int32_t>(parts[0]);
  const auto size = parts.size() == 2 ? ParseThree<std::int32_t>(parts[1]) : std::nullopt;
  if (first && size) return VoxelBox{*first, *size};
  problems.Add("--region", "`" + text + "` is not a box of voxels", "I,J,K:NI,NJ,NK, such as 20,30,0:100,90,31");
  return std::nullopt;
}

std::optional<ImageFilter> ParseFilter(const std::string& text) {
  const std::vector<std::string> parts = Split(text, ':');
  std::array<double, 2> numbers = {};
  if (parts.size() > 3) return std::nullopt;
  for (std::size_t p = 1; p < parts.size(); ++p) {
    if (!ParseNumber(parts[p], numbers[p - 1])) return std::nullopt;
  }
  const std::size_t given = parts.size() - 1;
  const bool whole = given == 0 || (numbers[0] == std::floor(numbers[0]) && std::abs(numbers[0]) < 1000);
  if (parts[0] == "gaussian" && given < 2) {
    GaussianFilter filter;
    if (given > 0) filter.deviation = numbers[0] * kMillimetre;
    return filter;
  }
  if (parts[0] == "curvature" && whole) {
    CurvatureFilter filter;
    if (given > 0) filter.iterations = static_cast<int>(numbers[0]);
    if (given > 1) filter.conductance = numbers[1];
    return filter;
  }
  if (parts[0] == "wavelet" && whole) {
    WaveletFilter filter;
    if (given > 0) filter.scales = static_cast<int>(numbers[0]);
    if (given > 1) filter.threshold = numbers[1];
    return filter;
  }
  if (parts[0] == "bias-field" && whole) {
    BiasFieldFilter filter;
    if (given > 0) filter.refinements = static_cast<int>(numbers[0]);
    if (given > 1) filter.iterations = static_cast<int>(numbers[1]);
    return filter;
  }
  return std::nullopt;
}

VolumeReaderOptions ReadRawOptions(const ImageOptions& options, Problems& problems) {
  VolumeReaderOptions reading;
  if (options.raw_size.empty()) return reading;
  RawLayout layout;
  if (const auto size = ParseThree<std::int32_t>(options.raw_size)) {
    layout.size = *size;
  } else {
    problems.Add("--raw-size", "`" + options.raw_size + "` is not a number of voxels along three axes",
                 "NI,NJ,NK, such as 140,220,71");
  }
  if (const auto spacing = ParseThree<double>(options.raw_spacing)) {
    layout.spacing = kMillimetre * Vec3((*spacing)[0], (*spacing)[1], (*spacing)[2]);
  } else {
    problems.Add("--raw-spacing", "three lengths are needed", "X,Y,Z in millimetres, such as 0.5,0.5,1");
  }
  layout.type = *VoxelTypeOf(options.raw_type);
  layout.big_endian = options.raw_big_endian;
  layout.header_bytes = options.raw_skip;
  reading.raw = layout;
  return reading;
}

std::variant<Classification, LabelChoice> ReadChoice(const ImageOptions& options, Problems& problems) {
  if (options.mask || !options.labels.empty()) {
    if (options.mask && !options.labels.empty()) {
      problems.Add("--mask", "excludes --label", "a mask is all voxels that are not 0");
    }
    return LabelChoice{options.labels};
  }
  Classification choice;
  choice.method = !options.thresholds.empty() ? ClassMethod::kGivenThresholds
                  : options.method == "otsu"  ? ClassMethod::kOtsu
                                              : ClassMethod::kFuzzyMeans;
  choice.classes = options.classes;
  choice.fuzziness = options.fuzziness;
  choice.least_membership = options.membership;
  choice.thresholds = options.thresholds;
  choice.wanted_class = options.wanted_class;
  return choice;
}

// The option that corresponds to a field of the stage.
std::string OptionOf(const std::string& path) {
  static const std::map<std::string, std::string> options = {{"region", "--region"},
                                                             {"resample", "--resample"},
                                                             {"filters", "--filter"},
                                                             {"classification.classes", "--classes"},
                                                             {"classification.fuzziness", "--fuzziness"},
                                                             {"classification.least_membership", "--membership"},
                                                             {"classification.thresholds", "--thresholds"},
                                                             {"classification.wanted_class", "--class"},
                                                             {"classification", "--method"},
                                                             {"labels", "--label"},
                                                             {"seeds", "--seed"},
                                                             {"cleaning.opening", "--opening"},
                                                             {"cleaning.keep", "--keep"},
                                                             {"level", "--level"},
                                                             {"fraction", "--fraction"}};
  // "filters[0].deviation" belongs to "filters".
  for (std::string field = path; !field.empty();) {
    const auto found = options.find(field);
    if (found != options.end()) return found->second;
    const std::size_t end = field.find_last_of(".[");
    field.resize(end == std::string::npos ? 0 : end);
  }
  return path;
}

void AddAsOptions(const Problems& found, Problems& problems) {
  for (const Problem& problem : found.kept()) problems.Add(OptionOf(problem.path), problem.message, problem.hint);
}

[[noreturn]] void Fail(const Problems& problems, const std::string& file) {
  Error error{Error::Kind::kInvalid, "the image " + file + " can't be segmented", "INVALID_IMAGE", {}};
  for (const Problem& problem : problems.kept()) {
    error.problems.Add(problem.path.empty() ? file : problem.path, problem.message, problem.hint);
  }
  throw CommandError(std::move(error));
}

}  // namespace

void AddImageOptions(CLI::App& command, ImageOptions& options) {
  command
      .add_option(
          "IMAGE", options.files,
          "The scan: .mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz, .hdr, .raw, or a DICOM series as its folder or files")
      ->required();
  CLI::Option* raw = command.add_option("--raw-size", options.raw_size, "For a .raw file: voxels along i, j, k")
                         ->type_name("NI,NJ,NK")
                         ->group("Image");
  command.add_option("--raw-spacing", options.raw_spacing, "For a .raw file: size of a voxel [mm]")
      ->type_name("X,Y,Z")
      ->needs(raw)
      ->group("Image");
  command.add_option("--raw-type", options.raw_type, "For a .raw file: type of its numbers")
      ->check(CLI::IsMember(
          {"uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64", "int64", "uint64"}))
      ->needs(raw)
      ->group("Image");
  command.add_flag("--raw-big-endian", options.raw_big_endian, "For a .raw file: big-endian numbers")
      ->needs(raw)
      ->group("Image");
  command.add_option("--raw-skip", options.raw_skip, "For a .raw file: bytes before the numbers")
      ->check(CLI::NonNegativeNumber)
      ->needs(raw)
      ->group("Image");
  command.add_option("--region", options.region, "Crop the image: first voxel and size")
      ->type_name("I,J,K:NI,NJ,NK")
      ->group("Image");
  command.add_option("--resample", options.resample, "Resample to cubes of this size [mm]")
      ->check(CLI::PositiveNumber)
      ->type_name("MM")
      ->group("Image");
  command
      .add_option("--filter", options.filters,
                  "Filter; may be repeated, in order. Noise: wavelet[:SCALES[:THRESHOLD]] (3 scales, 3 "
                  "deviations of the noise), gaussian[:MM] (1 mm), curvature[:ITERATIONS[:CONDUCTANCE]] (5, 1). Uneven "
                  "sensitivity of a coil: bias-field[:REFINEMENTS[:ITERATIONS]] (3, 50)")
      ->type_name("FILTER")
      ->allow_extra_args(false)
      ->group("Image");
  command.add_option("--method", options.method, "Classification method: fuzzy c-means or Otsu's thresholds")
      ->check(CLI::IsMember({"fuzzy", "otsu"}))
      ->group("Selection of the body");
  command.add_option("--classes", options.classes, "Number of classes, such as air, muscle and fat")
      ->check(CLI::Range(2, 8))
      ->group("Selection of the body");
  command.add_option("--thresholds", options.thresholds, "Thresholds between classes, instead of a method")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("V,V,...")
      ->group("Selection of the body");
  command.add_option("--class", options.wanted_class, "Class of the body, counted from 0, the darkest")
      ->group("Selection of the body");
  command.add_option("--fuzziness", options.fuzziness, "Fuzziness of c-means, above 1")->group("Selection of the body");
  command.add_option("--membership", options.membership, "Least membership in the class of the body's voxels")
      ->check(CLI::Range(0.0, 1.0))
      ->group("Selection of the body");
  command
      .add_option("--seed", options.seeds,
                  "A voxel of the body, which determines its class and the island to keep; may be repeated")
      ->type_name("I,J,K")
      ->allow_extra_args(false)
      ->group("Selection of the body");
  command.add_option("--label", options.labels, "For an image of labels: the label of the body; may be repeated")
      ->allow_extra_args(false)
      ->group("Selection of the body");
  command.add_flag("--mask", options.mask, "For a mask: all voxels other than 0 are the body")
      ->group("Selection of the body");
  command.add_option("--opening", options.opening, "Opening by a ball of this radius [mm] before islands are found")
      ->check(CLI::NonNegativeNumber)
      ->type_name("MM")
      ->group("Selection of the body");
  command
      .add_option("--keep", options.keep,
                  "Islands to keep; by default those of the seeds, or the largest without seeds")
      ->check(CLI::IsMember({"all", "largest", "seeds"}))
      ->group("Selection of the body");
  command.add_flag("--no-fill", options.no_fill, "Do not fill holes")->group("Selection of the body");
  command.add_option("--threads", options.threads, "Number of threads; the result does not depend on it")
      ->check(CLI::Range(1, 256));
  CLI::Option* picture =
      command.add_option("--picture", options.picture, "Draw slices with the body's outline")->type_name("FILE.png");
  AddSliceOptions(command, options.window, options.crop);
  for (const char* name : {"--window", "--crop"}) command.get_option(name)->needs(picture);
}

void AddSliceOptions(CLI::App& command, std::vector<double>& window, std::optional<double>& crop) {
  command
      .add_option(
          "--window", window,
          "For the picture: the value in middle grey, and how far black and white are apart; by default they are "
          "at the 0.5 and 99.5 percentiles")
      ->expected(2)
      ->type_name("LEVEL WIDTH")
      ->group("Picture");
  command.add_option("--crop", crop, "For the picture: show the body with a margin of this width only [mm]")
      ->check(CLI::NonNegativeNumber)
      ->type_name("MM")
      ->group("Picture");
}

void SetSliceOptions(const std::vector<double>& window, const std::optional<double>& crop, SlicesInput& input) {
  if (!window.empty() && !(window[1] > 0)) throw CommandError::Invalid("--window: the width must be above 0");
  if (!window.empty()) input.window = {window[0], window[1]};
  if (crop) input.crop = *crop * kMillimetre;
}

GivenImage ReadGivenImage(const ImageOptions& options, const std::stop_token& stop, Problems problems) {
  GivenImage given;
  ImageStage& stage = given.stage;
  VolumeReaderOptions reading = ReadRawOptions(options, problems);
  reading.stop = stop;
  if (!options.region.empty()) stage.region = ParseRegion(options.region, problems);
  if (options.resample > 0) stage.resample = options.resample * kMillimetre;
  for (const std::string& text : options.filters) {
    if (const std::optional<ImageFilter> filter = ParseFilter(text)) {
      stage.filters.push_back(*filter);
    } else {
      problems.Add("--filter", "`" + text + "` is not a filter",
                   "wavelet[:SCALES[:THRESHOLD]], gaussian[:MM], curvature[:ITERATIONS[:CONDUCTANCE]] or "
                   "bias-field[:REFINEMENTS[:ITERATIONS]]");
    }
  }
  stage.choice = ReadChoice(options, problems);
  std::vector<GridIndex> seeds;
  for (const std::string& text : options.seeds) {
    if (const auto seed = ParseThree<std::int32_t>(text)) {
      seeds.push_back(*seed);
    } else {
      problems.Add("--seed", "`" + text + "` is not a voxel", "I,J,K, such as 98,119,35");
    }
  }
  // Positions are set once the image is available.
  stage.seeds.assign(options.seeds.size(), Vec3::Zero());
  stage.cleaning.opening = options.opening * kMillimetre;
  const std::string keep = !options.keep.empty() ? options.keep : options.seeds.empty() ? "largest" : "seeds";
  stage.cleaning.keep = keep == "all" ? KeptParts::kAll : keep == "seeds" ? KeptParts::kSeeds : KeptParts::kLargest;
  stage.cleaning.fill_holes = !options.no_fill;
  Problems of_stage;
  CheckImageStage(stage, of_stage);
  AddAsOptions(of_stage, problems);

  Problems of_file;
  const std::vector<fs::path> paths(options.files.begin(), options.files.end());
  std::optional<VolumeImage> image = ReadVolumeFiles(paths, reading, of_file);
  problems.Append("", of_file);
  if (!image || !problems.empty()) Fail(problems, options.files[0]);
  given.image = std::move(*image);
  for (std::size_t s = 0; s < seeds.size(); ++s) stage.seeds[s] = given.image.CentreOf(seeds[s]);
  return given;
}

StagedImage RunStage(const ImageOptions& options, const GivenImage& given, const std::stop_token& stop) {
  ThreadTeam team(options.threads, stop);
  Problems found, problems;
  std::optional<StagedImage> staged;
  {
    StageProgress bar;
    staged = RunImageStage(given.image, given.stage, team, found,
                           [&](double part, const char* next) { bar.Show(part, next); });
  }
  AddAsOptions(found, problems);
  if (!staged) Fail(problems, options.files[0]);
  return std::move(*staged);
}

void DrawBody(const StagedImage& staged, const ImageOptions& options, const std::string& title) {
  SlicesInput input;
  input.size = staged.image.size;
  input.spacing = staged.image.spacing;
  input.values = staged.image.values;
  input.labels = staged.body.material;
  input.direction = staged.image.direction;
  input.title = title;
  SetSliceOptions(options.window, options.crop, input);
  input.names = {"body"};
  if (options.labels.size() > 1) {
    input.names.clear();
    for (const int label : options.labels) input.names.push_back("label " + std::to_string(label));
  }
  DrawSlices(input, PictureSize(), options.picture);
}

std::string TitleOf(const ImageOptions& options) {
  fs::path path = options.files[0];
  if (path.filename().empty()) path = path.parent_path();
  return path.filename().string();
}

void WriteLabels(const VolumeImage& labels, const std::string& path) {
  Problems problems;
  WriteVolume(labels, VoxelType::kUint8, path, problems);
  if (!problems.empty()) Fail(problems, path);
}

}  // namespace fascicle::client
