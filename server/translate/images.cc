#include "server/translate/images.h"

#include <cstdio>
#include <string_view>
#include <utility>

#include "core/base/parallel.h"
#include "core/imaging/arm_phantom.h"
#include "core/imaging/image_stage.h"
#include "core/imaging/volume_reader.h"
#include "server/translate/files.h"
#include "server/translate/kept_results.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

// Memory limit for one image [byte]; a server translates several scenes at once. The stages after reading hold the
// image up to three times.
constexpr std::int64_t kMemoryLimit = std::int64_t{4} << 30;
constexpr std::int64_t kReadingLimit = kMemoryLimit / 3;

GridIndex ToGridIndex(const google::protobuf::RepeatedField<std::int32_t>& values) {
  if (values.size() != 3) return {0, 0, 0};
  return {values[0], values[1], values[2]};
}

std::optional<RawLayout> TranslateRaw(const v1::ImageShape& shape, double metres, const std::string& path,
                                      Problems& problems) {
  if (!shape.has_raw()) return std::nullopt;
  RawLayout raw;
  raw.size = ToGridIndex(shape.raw().size());
  raw.spacing = ToVec3(shape.raw().spacing()) * metres;
  raw.big_endian = shape.raw().big_endian();
  raw.header_bytes = shape.raw().header_bytes();
  const auto type = VoxelTypeOf(shape.raw().type());
  if (!type) {
    problems.Add(JoinPath(path, "raw.type"), "\"" + shape.raw().type() + "\" is not a number type",
                 "uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32 or float64");
    return std::nullopt;
  }
  raw.type = *type;
  return raw;
}

std::optional<VolumeImage> ReadImage(const BodySource& source, const std::string& path, Problems& problems) {
  const v1::ImageShape& shape = source.wire.mesh().image();
  if (shape.has_phantom()) {
    return MakeArmPhantom(
               {shape.phantom().noise(), shape.phantom().bias(), static_cast<std::uint64_t>(shape.phantom().seed())})
        .image;
  }
  const std::string file_path = JoinPath(path, "file");
  std::vector<std::pair<std::string, std::string>> named;  // files and their bytes
  const auto read = [&](const v1::FileRef& file, const std::string& at) {
    auto bytes = ReadFile(file, at, source.assets, problems);
    if (bytes) named.emplace_back(file.path(), std::move(*bytes));
    return bytes.has_value();
  };
  bool complete = read(shape.file(), file_path);
  for (int i = 0; i < shape.more_files_size(); ++i) {
    complete &= read(shape.more_files(i), JoinPath(path, IndexPath("more_files", static_cast<std::size_t>(i))));
  }
  Problems own;
  VolumeReaderOptions options;
  options.raw = TranslateRaw(shape, MetresIn(source.wire.unit()), path, problems);
  options.memory_limit = kReadingLimit;
  options.stop = source.tools.stop;
  if (!complete || (shape.has_raw() && !options.raw)) return std::nullopt;
  std::vector<VolumeFile> files;
  for (const auto& [name, bytes] : named) files.push_back({name, bytes});
  auto image = ReadVolume(files, options, own);
  problems.Append(file_path, own);
  return image;
}

ImageFilter TranslateFilter(const v1::ImageFilter& filter, double metres) {
  if (filter.has_curvature()) return CurvatureFilter{filter.curvature().iterations(), filter.curvature().conductance()};
  if (filter.has_wavelet()) return WaveletFilter{filter.wavelet().scales(), filter.wavelet().threshold()};
  if (filter.has_bias_field()) {
    return BiasFieldFilter{filter.bias_field().refinements(), filter.bias_field().iterations()};
  }
  return GaussianFilter{filter.gaussian().deviation() * metres};
}

Classification TranslateClasses(const v1::ImageClasses& classes) {
  Classification result;
  if (classes.method() == v1::CLASS_METHOD_OTSU) result.method = ClassMethod::kOtsu;
  if (classes.method() == v1::CLASS_METHOD_THRESHOLDS) result.method = ClassMethod::kGivenThresholds;
  result.classes = classes.count();
  result.fuzziness = classes.fuzziness();
  result.least_membership = classes.least_membership();
  result.thresholds.assign(classes.thresholds().begin(), classes.thresholds().end());
  if (classes.has_wanted()) result.wanted_class = classes.wanted();
  return result;
}

Cleaning TranslateCleaning(const v1::ImageCleaning& cleaning, double metres) {
  Cleaning result;
  result.opening = cleaning.opening() * metres;
  if (cleaning.keep() == v1::KEPT_PARTS_ALL) result.keep = KeptParts::kAll;
  if (cleaning.keep() == v1::KEPT_PARTS_SEEDS) result.keep = KeptParts::kSeeds;
  result.fill_holes = !cleaning.leave_holes();
  return result;
}

ImageStage TranslateStage(const v1::ImageShape& shape, double metres) {
  ImageStage stage;
  if (shape.has_region())
    stage.region = VoxelBox{ToGridIndex(shape.region().first()), ToGridIndex(shape.region().size())};
  if (shape.has_resample()) stage.resample = shape.resample() * metres;
  for (const v1::ImageFilter& filter : shape.filters()) stage.filters.push_back(TranslateFilter(filter, metres));
  if (shape.has_labels()) {
    stage.choice = LabelChoice{{shape.labels().values().begin(), shape.labels().values().end()}};
  } else {
    stage.choice = TranslateClasses(shape.classes());
  }
  for (const v1::ImagePoint& seed : shape.seeds()) stage.seeds.push_back(ToVec3(seed.point()) * metres);
  stage.cleaning = TranslateCleaning(shape.cleaning(), metres);
  stage.level = shape.level();
  stage.fraction = shape.fraction();
  return stage;
}

// The path in the message of a problem of the stage.
std::string WirePath(const std::string& path, const v1::ImageShape& shape) {
  const auto renamed = [&path](std::string_view from, std::string_view to) {
    return std::string(to) + path.substr(from.size());
  };
  if (path.starts_with("labels[")) return renamed("labels", "labels.values");
  if (path == "classification.classes") return "classes.count";
  if (path == "classification.wanted_class") return "classes.wanted";
  if (path.starts_with("classification.")) return renamed("classification", "classes");
  const std::size_t end = path.find(']');
  if (!path.starts_with("filters[") || end == std::string::npos) return path;
  const v1::ImageFilter& filter = shape.filters(std::stoi(path.substr(8, end - 8)));
  const std::string& kind = v1::ImageFilter::descriptor()->FindFieldByNumber(filter.kind_case())->name();
  return path.substr(0, end + 1) + "." + kind + path.substr(end + 1);
}

void AppendOfStage(const std::string& path, const Problems& own, const v1::ImageShape& shape, Problems& problems) {
  for (const Problem& problem : own.kept()) {
    problems.Add(JoinPath(path, WirePath(problem.path, shape)), problem.message, problem.hint);
  }
}

std::vector<std::string> NotesOf(const StagedImage& staged) {
  char text[200];
  std::snprintf(text, sizeof text, "%lld voxels, %.4g cm^3, mean of the image's values %.4g",
                static_cast<long long>(staged.body_statistics.voxels), 1e6 * staged.body_statistics.volume,
                staged.body_statistics.mean);
  std::vector<std::string> notes = {text};
  std::string thresholds;
  for (const double threshold : staged.thresholds) thresholds += (thresholds.empty() ? "" : ", ") + Text(threshold);
  if (!thresholds.empty()) notes.push_back("thresholds between classes: " + thresholds);
  notes.insert(notes.end(), staged.notes.begin(), staged.notes.end());
  return notes;
}

// From the file to the body's voxels: the long computation whose result is kept.
std::optional<SegmentedImage> Segment(const BodySource& source, const ImageStage& stage, const std::string& path,
                                      Problems& problems) {
  const StageTimer timer(source.tools.profile, "segmentation");
  const v1::ImageShape& shape = source.wire.mesh().image();
  const auto image = ReadImage(source, path, problems);
  if (!image) return std::nullopt;
  Problems of_stage;
  ThreadTeam team(1, source.tools.stop);
  auto staged = RunImageStage(*image, stage, team, of_stage);
  AppendOfStage(path, of_stage, shape, problems);
  if (!staged) return std::nullopt;
  return SegmentedImage{std::move(staged->grid), NotesOf(*staged)};
}

}  // namespace

std::optional<VoxelGrid> TranslateImage(const BodySource& source, const std::string& path,
                                        std::vector<std::string>& notes, Problems& problems) {
  constexpr std::uint32_t kVersion = 3;  // version of the results of Segment
  const v1::ImageShape& shape = source.wire.mesh().image();
  const double metres = MetresIn(source.wire.unit());
  const bool has_source = shape.has_file() || shape.has_phantom();
  if (!has_source) problems.Add(path, "has no source", "give one of: file, phantom");
  // Violations of the rules are reported by the rules.
  if (!ObeysRules(shape) || !has_source) return std::nullopt;
  const ImageStage stage = TranslateStage(shape, metres);
  Problems of_settings;
  CheckImageStage(stage, of_settings);
  AppendOfStage(path, of_settings, shape, problems);
  if (!of_settings.empty()) {
    ReadImage(source, path, problems);  // reports problems of the image, too
    return std::nullopt;
  }
  const auto inputs = [&] {
    ArchiveWriter writer("segmented image", kVersion);
    PutMessage("image", shape, writer);
    writer.PutDouble("metres", metres);
    return writer;
  };
  auto segmented = Kept<SegmentedImage>(source.tools, inputs, [&] { return Segment(source, stage, path, problems); });
  if (!segmented) return std::nullopt;
  for (const std::string& note : segmented->notes) notes.push_back(path + ": " + note);
  return std::move(segmented->grid);
}

}  // namespace fascicle::server
