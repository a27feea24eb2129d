#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <iostream>
#include <memory>

#include "client/cli/command.h"
#include "client/cli/image_options.h"
#include "client/cli/image_scene.h"
#include "client/cli/interrupts.h"
#include "core/base/stop.h"
#include "core/geometry/voxel_grid.h"

namespace fascicle::client {
namespace {

constexpr const char* kVoxelizeExamples =
    R"(  fascicle phantom arm.mha                                    a synthetic arm
  fascicle voxelize arm.mha --filter wavelet --seed 98,119,35 --opening 0.6       the levels of the muscle, as a table
  fascicle voxelize labels.mha --label 1 --fraction 0.25 --level 2 --out coarse.mha
  fascicle voxelize labels.mha --label 1 --level 1 --out coarse.mha --scene coarse.json    and a first scene
  fascicle voxelize labels.mha --label 1 --level 1 --picture coarse.png

The body is selected as for `fascicle segment`. A voxel of the next level joins 2 x 2 x 2 and is solid if the given
fraction of them is solid. --out and --picture show the level given by --level. Ctrl-C stops the command
(exit code 4); files are written completely or not at all.
)";

struct VoxelizeOptions : ImageOptions {
  int levels = 5;
  double fraction = ImageStage().fraction;
  int level = 0;
};

void PrintTable(const VoxelizeOptions& options, const std::vector<VoxelLevel>& hierarchy, const VoxelPlace& place,
                const std::vector<std::string>& notes) {
  std::printf("level  voxel size     mm                       voxels       nodes       cm^3\n");
  for (std::size_t l = 0; l < hierarchy.size(); ++l) {
    const VoxelLevel& level = hierarchy[l];
    const Vec3 mm = level.grid.spacing * 1e3;
    char size[64];
    std::snprintf(size, sizeof size, "%.4g x %.4g x %.4g", mm[0], mm[1], mm[2]);
    std::printf("%5zu  %10d     %-20s %10lld  %10lld  %9.3f%s\n", l, level.voxel_size, size,
                static_cast<long long>(level.voxels), static_cast<long long>(level.nodes),
                static_cast<double>(level.voxels) * level.grid.spacing.prod() * 1e6,
                static_cast<int>(l) == options.level && !options.out.empty() ? "   written" : "");
  }
  PrintPlace(place);
  for (const std::string& note : notes) std::printf("note  %s\n", note.c_str());
  for (const std::string& file : {options.out, options.scene, options.picture}) {
    if (!file.empty()) std::cout << "written to " << file << '\n';
  }
}

Json TableJson(const VoxelizeOptions& options, const std::vector<VoxelLevel>& hierarchy, const VoxelPlace& place,
               const std::vector<std::string>& notes) {
  Json levels = Json::array();
  for (const VoxelLevel& level : hierarchy) {
    levels.push_back({{"voxel_size", level.voxel_size},
                      {"spacing", {level.grid.spacing[0], level.grid.spacing[1], level.grid.spacing[2]}},
                      {"size", level.grid.size},
                      {"voxels", level.voxels},
                      {"nodes", level.nodes},
                      {"volume", static_cast<double>(level.voxels) * level.grid.spacing.prod()}});
  }
  Json report = {{"fraction", options.fraction}, {"levels", std::move(levels)}};
  report.update(PlaceJson(place));
  if (!notes.empty()) report["notes"] = notes;
  if (!options.out.empty()) report["labels_file"] = options.out;
  if (!options.scene.empty()) report["scene"] = options.scene;
  if (!options.picture.empty()) report["picture"] = options.picture;
  return report;
}

// Shows the voxels of a level in the image: each voxel of the image gets the material at its centre.
void ShowLevel(const VoxelGrid& level, StagedImage& staged) {
  VolumeImage labels = MakeLabelImage(level);
  const VolumeImage& image = staged.image;
  std::size_t v = 0;
  for (std::int32_t k = 0; k < image.size[2]; ++k) {
    for (std::int32_t j = 0; j < image.size[1]; ++j) {
      for (std::int32_t i = 0; i < image.size[0]; ++i) {
        staged.body.material[v++] = level.MaterialAt(labels.VoxelAt(image.CentreOf({i, j, k})));
      }
    }
  }
}

int Voxelize(const VoxelizeOptions& options, const Context& context) {
  const StopOnInterrupt interrupts;
  const std::stop_token stop = interrupts.token();
  Problems problems;
  if (options.level >= options.levels) problems.Add("--level", "is not below --levels", "levels count from 0");
  const GivenImage given = ReadGivenImage(options, stop, problems);
  StagedImage staged = RunStage(options, given, stop);
  const std::vector<VoxelLevel> hierarchy = MakeHierarchy(staged.grid, options.fraction, options.levels, stop);
  if (options.level >= static_cast<int>(hierarchy.size())) {
    problems.Add("--level", "has no voxels: existing levels are 0 to " + std::to_string(hierarchy.size() - 1),
                 "use a lower level, or a smaller --fraction");
    throw CommandError({Error::Kind::kInvalid, "there is no such level", "INVALID_IMAGE", problems});
  }
  const VoxelGrid& level = hierarchy[options.level].grid;
  ThrowIfStopped(stop);
  const VoxelPlace place = PlaceOf(staged.body);
  if (!options.out.empty()) WriteLabels(MakeLabelImage(level), options.out);
  if (!options.scene.empty()) {
    const int labels = std::max(1, static_cast<int>(options.labels.size()));
    WriteImageScene(options.scene, options.out, PlaceOf(level), labels, 0);
  }
  ThrowIfStopped(stop);
  if (!options.picture.empty()) {
    ShowLevel(level, staged);
    DrawBody(staged, options,
             TitleOf(options) + ", voxel size " + std::to_string(hierarchy[options.level].voxel_size) + ": " +
                 std::to_string(hierarchy[options.level].voxels) + " voxels");
  }
  if (context.json) {
    PrintJson(TableJson(options, hierarchy, place, staged.notes));
  } else {
    PrintTable(options, hierarchy, place, staged.notes);
  }
  return kDone;
}

}  // namespace

void AddVoxelize(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "voxelize", "Coarsen a segmented body to levels of voxels", kVoxelizeExamples);
  const auto options = std::make_shared<VoxelizeOptions>();
  AddImageOptions(*command, *options);
  command->add_option("--levels", options->levels, "Largest number of levels; 5")->check(CLI::Range(1, 11));
  command->add_option("--fraction", options->fraction, "Part of the eight voxels that must be solid, above 0; 0.5")
      ->check(CLI::Range(0.01, 1.0));
  command->add_option("--level", options->level, "The level to write and draw, counted from 0, the finest")
      ->check(CLI::Range(0, 10));
  CLI::Option* out =
      command->add_option("--out", options->out, "Write a level as a label image: .mha, .nrrd, .nii or .nii.gz")
          ->type_name("FILE");
  command
      ->add_option("--scene", options->scene,
                   "Write a scene of that label image: fixed at one end, pulled at the other, in mm")
      ->type_name("FILE.json")
      ->needs(out);
  command->callback(
      [options, &context] { context.action = [options, &context] { return Voxelize(*options, context); }; });
}

}  // namespace fascicle::client
