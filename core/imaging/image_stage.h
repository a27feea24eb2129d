#ifndef FASCICLE_CORE_IMAGING_IMAGE_STAGE_H_
#define FASCICLE_CORE_IMAGING_IMAGE_STAGE_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/problems.h"
#include "core/imaging/filters.h"
#include "core/imaging/volume_image.h"

namespace fascicle {

// The image contains labels: which of them to use.
struct LabelChoice {
  // Voxels with value labels[m - 1] (HasLabel) become material m; at most 255 distinct labels, none 0. Empty: the image
  // is a mask, whose non-zero voxels become material 1.
  std::vector<int> labels;

  bool operator==(const LabelChoice&) const = default;
};

enum class ClassMethod {
  kFuzzyMeans,       // fuzzy c-means
  kOtsu,             // thresholds with the largest variance between classes
  kGivenThresholds,  // thresholds given by the user
};

// Voxels are divided into classes by their (filtered) values; those of one class become material 1.
struct Classification {
  ClassMethod method = ClassMethod::kFuzzyMeans;
  int classes = 3;                 // 2 to 8; given thresholds determine it themselves
  double fuzziness = 2;            // (1, 10], for fuzzy means
  double least_membership = 0;     // [0, 1], for fuzzy means: voxels of the class with a lower membership are excluded
  std::vector<double> thresholds;  // ascending, 1 to 7; for kGivenThresholds [unit of the values]
  // Counted from 0, the darkest; absent: the class of the seeds.
  std::optional<int> wanted_class;

  bool operator==(const Classification&) const = default;
};

enum class KeptParts {
  kAll,
  kLargest,  // the largest island (face-connected component)
  kSeeds,    // the islands that contain the seeds
};

// Operations on the selected voxels, in this order.
struct Cleaning {
  double opening = 0;  // [m], >= 0: parts thinner than a ball of this radius are removed first
  KeptParts keep = KeptParts::kLargest;
  bool fill_holes = true;

  bool operator==(const Cleaning&) const = default;
};

// From an image to voxels; the members are applied in their order.
struct ImageStage {
  std::optional<VoxelBox> region;    // region of interest; everything outside is cropped
  std::optional<double> resample;    // [m]: spacing of the cubes to which the image is resampled
  std::vector<ImageFilter> filters;  // in this order; none for labels
  std::variant<Classification, LabelChoice> choice;
  std::vector<Vec3> seeds;  // points of the body [m], in the image's frame
  Cleaning cleaning;
  int level = 0;          // 0 to 10: how often 2x2x2 voxels are joined [Zhu et al. 1998, 4]
  double fraction = 0.5;  // (0, 1]: part of the eight voxels that must be solid

  bool operator==(const ImageStage&) const = default;
};

// Checks everything about a stage that does not depend on the image. Paths name the members: "filters[0].deviation",
// "classification.classes", "labels[1]", "cleaning.opening".
void CheckImageStage(const ImageStage& stage, Problems& problems);

struct ClassStatistics {
  std::int64_t voxels = 0;
  double volume = 0;                                        // [m^3]
  double lowest = 0, highest = 0, mean = 0, deviation = 0;  // of the unfiltered image
};

struct StagedImage {
  VolumeImage image;     // cropped and resampled, not filtered
  VolumeImage filtered;  // without values if there are no filters
  // The classes, starting with the darkest. For labels: one for each label, in their order.
  std::vector<std::uint8_t> classes;        // of each voxel; empty for labels
  std::vector<ClassStatistics> statistics;  // of each class or label
  std::vector<double> thresholds;           // between classes [the values' unit]; empty for labels
  std::vector<double> centres;              // of fuzzy means
  std::vector<float> membership;            // of each voxel in the wanted class; for fuzzy means
  int wanted_class = 0;
  // The body at level 0 in the grid of `image`, and its statistics.
  VoxelGrid body;
  ClassStatistics body_statistics;
  // The body at the requested level, cropped to its solid voxels.
  VoxelGrid grid;
  // Remarks: those of the image, and on values and sizes that are unusual.
  std::vector<std::string> notes;
};

// Called with the completed fraction and the next stage.
using ImageProgress = std::function<void(double fraction, const char* stage)>;

// Runs a stage, which CheckImageStage must have accepted, on an image. The same bits for any number of threads. Returns
// nothing and adds to `problems`, with paths as above, if the region is not inside of the image, a label has no voxels
// (the message lists the existing labels), a seed lies outside or in another class, all values are equal, or no voxel
// is left. Throws Stopped after a stop request to the team.
std::optional<StagedImage> RunImageStage(const VolumeImage& image, const ImageStage& stage, ThreadTeam& team,
                                         Problems& problems, const ImageProgress& progress = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_IMAGE_STAGE_H_
