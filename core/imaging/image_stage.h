#ifndef FASCICLE_CORE_IMAGING_IMAGE_STAGE_H_
#define FASCICLE_CORE_IMAGING_IMAGE_STAGE_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/problems.h"
#include "core/imaging/filters.h"
#include "core/imaging/volume_image.h"

namespace fascicle {

// The image is labels already: which of them.
struct LabelChoice {
  // Material m is the voxels of value labels[m - 1]; at most 255, none twice, none 0. Empty: a mask, whose voxels other
  // than 0 are material 1.
  std::vector<int> labels;

  bool operator==(const LabelChoice&) const = default;
};

enum class ClassMethod {
  kFuzzyMeans,       // fuzzy c-means
  kOtsu,             // thresholds of largest variance between classes
  kGivenThresholds,  // thresholds of the user
};

// Voxels are parted into classes by their (filtered) values, and those of one class are material 1.
struct Classification {
  ClassMethod method = ClassMethod::kFuzzyMeans;
  int classes = 3;                 // 2 to 8; not for given thresholds, which tell it
  double fuzziness = 2;            // (1, 10], of fuzzy means
  double least_membership = 0;     // [0, 1], of fuzzy means: voxels of the class below this stay out
  std::vector<double> thresholds;  // rising, 1 to 7; of kGivenThresholds [the values' unit]
  // Counted from 0 at the darkest; none: the class that the seeds have.
  std::optional<int> wanted_class;

  bool operator==(const Classification&) const = default;
};

enum class KeptParts {
  kAll,
  kLargest,  // the largest island (that hang together by faces of voxels)
  kSeeds,    // the islands of the seeds
};

// What is done with the chosen voxels, in this order.
struct Cleaning {
  double opening = 0;  // [m], >= 0: parts that a ball of this radius does not reach go, before islands are told apart
  KeptParts keep = KeptParts::kLargest;
  bool fill_holes = true;

  bool operator==(const Cleaning&) const = default;
};

// From an image to voxels, in the order of its members.
struct ImageStage {
  std::optional<VoxelBox> region;    // of interest: what lies outside is cut off
  std::optional<double> resample;    // [m]: spacing of cubes that the image is resampled to
  std::vector<ImageFilter> filters;  // in this order; none for labels
  std::variant<Classification, LabelChoice> choice;
  std::vector<Vec3> seeds;  // points [m] in the image's frame, that are of the body
  Cleaning cleaning;
  int level = 0;          // 0 to 10: how many times 2x2x2 voxels are joined [Zhu et al. 1998, 4]
  double fraction = 0.5;  // (0, 1]: of the eight that must be solid

  bool operator==(const ImageStage&) const = default;
};

// Checks all of a stage that can be told without its image. Paths are the members: "filters[0].deviation",
// "classification.classes", "labels[1]", "cleaning.opening".
void CheckImageStage(const ImageStage& stage, Problems& problems);

struct ClassStatistics {
  std::int64_t voxels = 0;
  double volume = 0;                                        // [m^3]
  double lowest = 0, highest = 0, mean = 0, deviation = 0;  // of the image before it was filtered
};

struct StagedImage {
  VolumeImage image;     // in the region and resampled, before filters
  VolumeImage filtered;  // without values when there are no filters
  // The classes, from the darkest on (of labels: one for each, in their order).
  std::vector<std::uint8_t> classes;        // of each voxel; empty for labels
  std::vector<ClassStatistics> statistics;  // of each class or label
  std::vector<double> thresholds;           // between classes [the values' unit]; empty for labels
  std::vector<double> centres;              // of fuzzy means
  std::vector<float> membership;            // of each voxel in the wanted class; of fuzzy means
  int wanted_class = 0;
  // The body at level 0 in the whole of `image`, and its statistics.
  VoxelGrid body;
  ClassStatistics body_statistics;
  // The body at the level that was asked for, cropped to its solid voxels.
  VoxelGrid grid;
};

// `fraction` of the whole is done, and what comes next.
using ImageProgress = std::function<void(double fraction, const char* stage)>;

// Runs a stage (that CheckImageStage passed) on an image. The same bits for any number of threads. Adds to `problems`,
// with paths as above, where the region is not in the image, a label has no voxels (which there are is told), a seed
// lies outside or in another class, all values are the same, or nothing is left; and gives nothing then.
std::optional<StagedImage> RunImageStage(const VolumeImage& image, const ImageStage& stage, ThreadTeam& team,
                                         Problems& problems, const ImageProgress& progress = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_IMAGE_STAGE_H_
