#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "client/cli/command.h"
#include "client/cli/image_options.h"
#include "client/cli/image_scene.h"
#include "client/cli/interrupts.h"
#include "core/base/stop.h"
#include "core/imaging/labels.h"
#include "core/imaging/masks.h"
#include "core/imaging/volume_reader.h"

namespace fascicle::client {
namespace {

constexpr const char* kSegmentExamples =
    R"(  fascicle phantom arm.mha --truth truth.mha                  a synthetic arm
  fascicle segment arm.mha --filter wavelet --seed 98,119,35 --opening 0.6 --out anconeus.mha --picture anconeus.png
  fascicle segment arm.mha --seed 98,119,35 --truth truth.mha --truth-label 4     compare with the true anatomy
  fascicle segment arm.mha --filter wavelet --seed 98,119,35 --opening 0.6 --out anconeus.mha --scene anconeus.json
  fascicle segment thigh.nii.gz --filter bias-field --filter wavelet --classes 4 --class 3 --opening 2 --picture muscles.png
  fascicle segment ct/ --thresholds 200 --class 1 --out bone.mha          a DICOM series in a folder
  fascicle segment scan.raw --raw-size 140,220,71 --raw-spacing 0.5,0.5,1 --class 1
  fascicle segment labels.mha --label 1 --label 2 --keep all --picture both.png     an existing segmentation

Steps in order: region, resampling, filters, classes, opening, islands, holes. Check the picture before
you trust the result. The label image has 1 where the body is, or 1, 2, ... for the labels in their order. Ctrl-C
stops the command (exit code 4); files are written completely or not at all.
)";

struct SegmentOptions : ImageOptions {
  std::string truth;
  int truth_label = 1;
};

Json StatisticsJson(const ClassStatistics& statistics) {
  return {{"voxels", statistics.voxels},   {"volume", statistics.volume}, {"lowest", statistics.lowest},
          {"highest", statistics.highest}, {"mean", statistics.mean},     {"deviation", statistics.deviation}};
}

// Dice coefficient with a label of a reference image of the same size.
std::optional<double> OverlapWithTruth(const SegmentOptions& options, const StagedImage& staged,
                                       const GivenImage& given, Problems& problems) {
  if (options.truth.empty()) return std::nullopt;
  if (given.stage.resample) problems.Add("--truth", "cannot be compared with a resampled image", "");
  Problems found;
  std::optional<VolumeImage> truth = ReadVolumeFiles({options.truth}, {}, found);
  problems.Append(options.truth, found);
  if (!truth || !problems.empty()) return std::nullopt;
  if (truth->size != given.image.size) {
    problems.Add("--truth", "its size differs from the image's", "");
    return std::nullopt;
  }
  if (given.stage.region) truth = Crop(*truth, *given.stage.region);
  std::vector<std::uint8_t> material;
  for (const float value : truth->values) material.push_back(HasLabel(value, options.truth_label) ? 1 : 0);
  return DiceOverlap(staged.body, MakeVoxelGrid(*truth, std::move(material)));
}

void PrintStatistics(const char* name, const ClassStatistics& s, const char* mark) {
  std::printf("%-9s %11lld %12.4f %10.4g %10.4g %10.4g %10.4g%s\n", name, static_cast<long long>(s.voxels),
              s.volume * 1e6, s.lowest, s.highest, s.mean, s.deviation, mark);
}

void PrintReport(const SegmentOptions& options, const StagedImage& staged, const VoxelPlace& place,
                 const std::optional<double>& overlap) {
  const VolumeImage& image = staged.image;
  std::printf("image     %d x %d x %d voxels of %.4g x %.4g x %.4g mm\n", image.size[0], image.size[1], image.size[2],
              image.spacing[0] * 1e3, image.spacing[1] * 1e3, image.spacing[2] * 1e3);
  const bool labels = staged.classes.empty();
  for (std::size_t t = 0; t < staged.thresholds.size(); ++t) {
    std::printf("%s%.6g", t == 0 ? "thresholds " : ", ", staged.thresholds[t]);
  }
  if (!staged.thresholds.empty()) std::printf("\n");
  for (std::size_t c = 0; c < staged.centres.size(); ++c) {
    std::printf("%s%.6g", c == 0 ? "centres    " : ", ", staged.centres[c]);
  }
  if (!staged.centres.empty()) std::printf("\n");
  std::printf("\n%-9s %11s %12s %10s %10s %10s %10s\n", "", "voxels", "cm^3", "lowest", "highest", "mean", "deviation");
  for (std::size_t c = 0; c < staged.statistics.size(); ++c) {
    const std::string name = labels ? options.labels.empty() ? "mask" : "label " + std::to_string(options.labels[c])
                                    : "class " + std::to_string(c);
    PrintStatistics(name.c_str(), staged.statistics[c],
                    !labels && static_cast<int>(c) == staged.wanted_class ? "   wanted" : "");
  }
  PrintStatistics("body", staged.body_statistics, "");
  std::printf("\n");
  PrintPlace(place);
  for (const std::string& note : staged.notes) std::printf("note  %s\n", note.c_str());
  if (overlap) std::printf("\nDice coefficient with the truth  %.4f\n", *overlap);
  for (const std::string& file : {options.out, options.scene, options.picture}) {
    if (!file.empty()) std::cout << "written to " << file << '\n';
  }
}

Json ReportJson(const SegmentOptions& options, const StagedImage& staged, const VoxelPlace& place,
                const std::optional<double>& overlap) {
  Json classes = Json::array();
  for (const ClassStatistics& statistics : staged.statistics) classes.push_back(StatisticsJson(statistics));
  const VolumeImage& image = staged.image;
  Json report = {{"size", image.size},
                 {"spacing", {image.spacing[0], image.spacing[1], image.spacing[2]}},
                 {"thresholds", staged.thresholds},
                 {"centres", staged.centres},
                 {staged.classes.empty() ? "labels" : "classes", std::move(classes)},
                 {"body", StatisticsJson(staged.body_statistics)}};
  report.update(PlaceJson(place));
  if (!staged.notes.empty()) report["notes"] = staged.notes;
  if (!staged.classes.empty()) report["wanted_class"] = staged.wanted_class;
  if (overlap) report["dice"] = *overlap;
  if (!options.out.empty()) report["labels_file"] = options.out;
  if (!options.scene.empty()) report["scene"] = options.scene;
  if (!options.picture.empty()) report["picture"] = options.picture;
  return report;
}

// So many times voxels are joined that a first run takes seconds.
int LevelFor(const ClassStatistics& body) {
  constexpr double kMostVoxels = 20'000;
  int level = 0;
  for (double voxels = static_cast<double>(body.voxels); voxels > kMostVoxels; voxels /= 8) ++level;
  return level;
}

int Segment(const SegmentOptions& options, const Context& context) {
  const StopOnInterrupt interrupts;
  const std::stop_token stop = interrupts.token();
  Problems problems;
  const GivenImage given = ReadGivenImage(options, stop, problems);
  const StagedImage staged = RunStage(options, given, stop);
  const std::optional<double> overlap = OverlapWithTruth(options, staged, given, problems);
  if (!problems.empty()) {
    throw CommandError({Error::Kind::kInvalid, "the truth can't be compared", "INVALID_IMAGE", problems});
  }
  ThrowIfStopped(stop);
  const VoxelPlace place = PlaceOf(staged.body);
  if (!options.out.empty()) WriteLabels(MakeLabelImage(staged.body), options.out);
  if (!options.scene.empty()) {
    const int labels = std::max(1, static_cast<int>(options.labels.size()));
    WriteImageScene(options.scene, options.out, place, labels, LevelFor(staged.body_statistics));
  }
  ThrowIfStopped(stop);
  if (!options.picture.empty()) DrawBody(staged, options, TitleOf(options));
  if (context.json) {
    PrintJson(ReportJson(options, staged, place, overlap));
  } else {
    PrintReport(options, staged, place, overlap);
  }
  return kDone;
}

}  // namespace

void AddSegment(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "segment", "Segment a body in a scan", kSegmentExamples);
  const auto options = std::make_shared<SegmentOptions>();
  AddImageOptions(*command, *options);
  CLI::Option* out =
      command->add_option("--out", options->out, "Write the body as a label image: .mha, .nrrd, .nii or .nii.gz")
          ->type_name("FILE");
  command
      ->add_option("--scene", options->scene,
                   "Write a scene of that label image: fixed at one end, pulled at the other, in mm")
      ->type_name("FILE.json")
      ->needs(out);
  CLI::Option* truth =
      command->add_option("--truth", options->truth, "A label image to compare with: prints the Dice coefficient")
          ->type_name("FILE");
  command->add_option("--truth-label", options->truth_label, "Value of the body in it; 1")->needs(truth);
  command->callback(
      [options, &context] { context.action = [options, &context] { return Segment(*options, context); }; });
}

}  // namespace fascicle::client
