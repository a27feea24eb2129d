#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <iostream>
#include <memory>

#include "client/cli/command.h"
#include "client/cli/image_options.h"
#include "core/imaging/arm_phantom.h"
#include "core/imaging/volume_writer.h"

namespace fascicle::client {
namespace {

constexpr const char* kPhantomExamples =
    R"(  fascicle phantom arm.mha                                    140 x 220 x 71 voxels of 0.5 mm
  fascicle phantom arm.nii.gz --noise 0.1 --truth truth.nii.gz
  fascicle segment arm.mha --filter wavelet --seed 98,119,35 --opening 0.6 --picture anconeus.png

A section of an arm near the elbow, as in a T1-weighted magnetic resonance image, defined by formulas. Labels: 0 air,
1 skin, 2 fat, 3 muscles, 4 anconeus, 5 cortical bone, 6 marrow.
)";

struct PhantomOptions {
  std::string out, truth;
  ArmPhantomSettings settings;
};

void Write(const VolumeImage& image, VoxelType type, const std::string& path) {
  Problems problems;
  WriteVolume(image, type, path, problems);
  if (problems.empty()) return;
  Error error{Error::Kind::kInvalid, "the phantom can't be written", "INVALID_IMAGE", {}};
  error.problems.Append(path, problems);
  throw CommandError(std::move(error));
}

int MakePhantom(const PhantomOptions& options, const Context& context) {
  const ArmPhantom phantom = MakeArmPhantom(options.settings);
  Write(phantom.image, VoxelType::kInt16, options.out);
  if (!options.truth.empty()) {
    VolumeImage truth = phantom.image;
    for (std::size_t v = 0; v < truth.values.size(); ++v) truth.values[v] = static_cast<float>(phantom.truth[v]);
    Write(truth, VoxelType::kUint8, options.truth);
  }
  const GridIndex seed = phantom.image.VoxelAt(ArmPhantomSeed());
  if (context.json) {
    Json report = {{"image", options.out}, {"seed", seed}};
    if (!options.truth.empty()) report["truth"] = options.truth;
    PrintJson(report);
    return kDone;
  }
  std::printf("the anconeus contains voxel %d,%d,%d\n", seed[0], seed[1], seed[2]);
  for (const std::string& file : {options.out, options.truth}) {
    if (!file.empty()) std::cout << "written to " << file << '\n';
  }
  return kDone;
}

}  // namespace

void AddPhantom(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "phantom", "Make a synthetic scan of an arm with known anatomy", kPhantomExamples);
  const auto options = std::make_shared<PhantomOptions>();
  command->add_option("OUT", options->out, "The scan: .mha, .nrrd, .nii or .nii.gz")->required();
  command->add_option("--truth", options->truth, "Also write the tissue of each voxel")->type_name("FILE");
  command
      ->add_option("--noise", options->settings.noise, "Standard deviation of the noise, relative to fat's value; 0.05")
      ->check(CLI::Range(0.0, 0.5));
  command->add_option("--bias", options->settings.bias, "Variation of the coil's sensitivity; 0.1")
      ->check(CLI::Range(0.0, 0.5));
  command->add_option("--noise-seed", options->settings.seed, "Seed of the noise; 1");
  command->callback(
      [options, &context] { context.action = [options, &context] { return MakePhantom(*options, context); }; });
}

}  // namespace fascicle::client
