#include "core/imaging/image_stage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "core/base/stop.h"
#include "core/imaging/classes.h"
#include "core/imaging/labels.h"
#include "core/imaging/masks.h"

namespace fascicle {
namespace {

constexpr int kThresholdBins = 4096;

std::string Text(const GridIndex& at) {
  return "(" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " + std::to_string(at[2]) + ")";
}

// Statistics of `values` by group: group_of(voxel) is the group's number, or negative for none.
template <class GroupOf>
std::vector<ClassStatistics> StatisticsOf(const VolumeImage& image, int groups, const std::stop_token& stop,
                                          const GroupOf& group_of) {
  std::vector<ClassStatistics> all(groups);
  std::vector<double> sum(groups, 0), squares(groups, 0);
  for (std::size_t v = 0; v < image.voxels(); ++v) {
    ThrowIfStopped(stop);
    const int group = group_of(v);
    if (group < 0) continue;
    const double value = image.values[v];
    ClassStatistics& one = all[group];
    one.lowest = one.voxels == 0 ? value : std::min(one.lowest, value);
    one.highest = one.voxels == 0 ? value : std::max(one.highest, value);
    ++one.voxels;
    sum[group] += value;
    squares[group] += value * value;
  }
  for (int g = 0; g < groups; ++g) {
    if (all[g].voxels == 0) continue;
    const auto count = static_cast<double>(all[g].voxels);
    all[g].volume = count * image.voxel_volume();
    all[g].mean = sum[g] / count;
    all[g].deviation = std::sqrt(std::max(squares[g] / count - all[g].mean * all[g].mean, 0.0));
  }
  return all;
}

class StageRun {
 public:
  StageRun(const ImageStage& stage, ThreadTeam& team, Problems& problems, const ImageProgress& progress)
      : stage_(stage), team_(team), problems_(problems), progress_(progress) {}

  std::optional<StagedImage> Run(const VolumeImage& image) {
    if (!TakeRegion(image) || !TakeSeeds()) return std::nullopt;
    Filter();
    const auto* labels = std::get_if<LabelChoice>(&stage_.choice);
    const bool chosen = labels != nullptr ? ChooseLabels(*labels) : Classify(std::get<Classification>(stage_.choice));
    if (!chosen || !Clean() || !Coarsen()) return std::nullopt;
    TakeNotes(image, labels != nullptr && !labels->labels.empty());
    Show(1, "done");
    return std::move(result_);
  }

 private:
  void Show(double fraction, const char* next) {
    if (progress_) progress_(fraction, next);
    team_.ThrowIfStopped();
  }
  bool Refuse(const std::string& path, const std::string& message, const std::string& hint) {
    problems_.Add(path, message, hint);
    return false;
  }

  bool TakeRegion(const VolumeImage& image) {
    Show(0, "region");
    VoxelBox box = stage_.region.value_or(VoxelBox{{0, 0, 0}, image.size});
    for (int axis = 0; axis < 3; ++axis) {
      if (box.first[axis] >= image.size[axis] || box.size[axis] > image.size[axis] - box.first[axis]) {
        return Refuse("region", "is not inside of the image, which has " + Text(image.size) + " voxels",
                      "first + size must not exceed that");
      }
    }
    result_.image = stage_.region ? Crop(image, box) : image;
    if (!stage_.resample) return true;
    const GridIndex size = ResampledSize(box.size, image.spacing, *stage_.resample);
    const double voxels = static_cast<double>(size[0]) * size[1] * size[2];
    constexpr double kGrowth = 64;
    if (voxels > kGrowth * static_cast<double>(result_.image.voxels()) ||
        voxels > std::numeric_limits<std::int32_t>::max()) {
      return Refuse("resample", "makes " + Text(size) + " voxels",
                    "at most 64 times as many as before are allowed: use larger voxels");
    }
    const bool labels = std::holds_alternative<LabelChoice>(stage_.choice);
    const Interpolation interpolation = labels ? Interpolation::kNearest : Interpolation::kLinear;
    result_.image = Resample(result_.image, *stage_.resample, interpolation, team_.stop());
    return true;
  }

  bool TakeSeeds() {
    for (std::size_t s = 0; s < stage_.seeds.size(); ++s) {
      const GridIndex at = result_.image.VoxelAt(stage_.seeds[s]);
      seeds_.push_back(at);
      if (!result_.image.Contains(at)) {
        problems_.Add(IndexPath("seeds", s),
                      "is outside of the image or region: voxel " + Text(at) + " of " + Text(result_.image.size), "");
      }
    }
    for (std::size_t f = 0; f < stage_.filters.size(); ++f) {
      constexpr double kWidest = 20;
      const auto* gaussian = std::get_if<GaussianFilter>(&stage_.filters[f]);
      if (gaussian != nullptr && gaussian->deviation > kWidest * result_.image.spacing.minCoeff()) {
        problems_.Add(IndexPath("filters", f) + ".deviation", "is more than 20 voxels", "is it in the right unit?");
      }
    }
    return problems_.empty();
  }

  void Filter() {
    for (std::size_t f = 0; f < stage_.filters.size(); ++f) {
      Show(0.1 + 0.5 * static_cast<double>(f) / static_cast<double>(stage_.filters.size()), "filter");
      result_.filtered = ApplyFilter(f == 0 ? result_.image : result_.filtered, stage_.filters[f], team_);
    }
  }

  // The values by which voxels are classified.
  const std::vector<float>& values() const {
    return stage_.filters.empty() ? result_.image.values : result_.filtered.values;
  }

  bool ChooseLabels(const LabelChoice& choice) {
    Show(0.6, "labels");
    const auto count = static_cast<int>(std::max<std::size_t>(choice.labels.size(), 1));
    std::vector<std::uint8_t> material(result_.image.voxels(), 0);
    for (std::size_t v = 0; v < material.size(); ++v) {
      team_.ThrowIfStopped();
      const float value = result_.image.values[v];
      if (choice.labels.empty()) {
        material[v] = value != 0 ? 1 : 0;
        continue;
      }
      const auto found =
          std::find_if(choice.labels.begin(), choice.labels.end(), [&](int label) { return HasLabel(value, label); });
      if (found != choice.labels.end()) material[v] = static_cast<std::uint8_t>(found - choice.labels.begin() + 1);
    }
    result_.statistics =
        StatisticsOf(result_.image, count, team_.stop(), [&](std::size_t v) { return int{material[v]} - 1; });
    for (int l = 0; l < count; ++l) {
      if (result_.statistics[l].voxels > 0) continue;
      if (choice.labels.empty()) return Refuse("labels", "all voxels of the mask are 0", "");
      problems_.Add(IndexPath("labels", l), "no voxel has the label " + std::to_string(choice.labels[l]),
                    ExistingLabels(result_.image));
    }
    result_.body = MakeVoxelGrid(result_.image, std::move(material));
    return problems_.empty();
  }

  bool Classify(const Classification& choice) {
    Show(0.6, "classes");
    FuzzyMeans means;
    if (choice.method == ClassMethod::kGivenThresholds) {
      result_.thresholds = choice.thresholds;
    } else {
      const Histogram histogram = MakeHistogram(values(), kThresholdBins);
      if (histogram.filled() < static_cast<std::size_t>(choice.classes)) {
        return Refuse("classification.classes",
                      "the image has " + std::to_string(histogram.filled()) + " different values, too few for " +
                          std::to_string(choice.classes) + " classes",
                      "is it a label image? Then say which labels");
      }
      if (choice.method == ClassMethod::kOtsu) {
        result_.thresholds = OtsuThresholds(histogram, choice.classes);
      } else {
        means = FindFuzzyMeans(histogram, choice.classes, choice.fuzziness, team_.stop());
        if (!means.converged) {
          return Refuse("classification", "fuzzy means do not converge",
                        "use fewer classes or a fuzziness nearer to 2");
        }
        result_.centres = means.centres;
        // Memberships are equal halfway between two centres.
        for (std::size_t c = 1; c < means.centres.size(); ++c) {
          result_.thresholds.push_back(0.5 * (means.centres[c - 1] + means.centres[c]));
        }
      }
    }
    TellClasses();
    return FindWantedClass(choice) && TakeWantedClass(choice, means);
  }

  void TellClasses() {
    const std::vector<double>& thresholds = result_.thresholds;
    result_.classes.resize(values().size());
    ForEach(team_, values().size(), 4096, [&](std::size_t v) {
      const auto above = std::lower_bound(thresholds.begin(), thresholds.end(), static_cast<double>(values()[v]));
      result_.classes[v] = static_cast<std::uint8_t>(above - thresholds.begin());
    });
    result_.statistics = StatisticsOf(result_.image, static_cast<int>(thresholds.size()) + 1, team_.stop(),
                                      [&](std::size_t v) { return int{result_.classes[v]}; });
  }

  bool FindWantedClass(const Classification& choice) {
    if (choice.wanted_class) {
      result_.wanted_class = *choice.wanted_class;
    } else {
      result_.wanted_class = result_.classes[result_.image.IndexOf(seeds_[0])];
    }
    for (std::size_t s = 0; s < seeds_.size(); ++s) {
      const int found = result_.classes[result_.image.IndexOf(seeds_[s])];
      if (found == result_.wanted_class) continue;
      problems_.Add(IndexPath("seeds", s),
                    "is in class " + std::to_string(found) + ", not in class " + std::to_string(result_.wanted_class),
                    "move it, or use other classes");
    }
    return problems_.empty();
  }

  bool TakeWantedClass(const Classification& choice, const FuzzyMeans& means) {
    std::vector<std::uint8_t> material(result_.classes.size());
    const bool fuzzy = choice.method == ClassMethod::kFuzzyMeans;
    if (fuzzy) result_.membership.resize(material.size());
    ForEach(team_, material.size(), 4096, [&](std::size_t v) {
      double membership = 1;
      if (fuzzy) {
        membership = means.Membership(values()[v], result_.wanted_class);
        result_.membership[v] = static_cast<float>(membership);
      }
      const bool wanted = result_.classes[v] == result_.wanted_class && membership >= choice.least_membership;
      material[v] = wanted ? 1 : 0;
    });
    result_.body = MakeVoxelGrid(result_.image, std::move(material));
    return true;
  }

  bool Clean() {
    Show(0.7, "cleaning");
    VoxelGrid& body = result_.body;
    const double opening = stage_.cleaning.opening;
    const auto nothing_left = [&] {
      return std::all_of(body.material.begin(), body.material.end(), [](std::uint8_t m) { return m == 0; });
    };
    if (nothing_left())
      return Refuse("classification", "no voxel belongs to the wanted class", "lower least_membership");
    const VoxelGrid whole = body;
    Erode(body, opening, team_);
    if (nothing_left())
      return Refuse("cleaning.opening", "nothing is left of the body", "it must be below half of its thickness");
    if (stage_.cleaning.keep == KeptParts::kLargest) KeepLargestIsland(body, team_.stop());
    if (stage_.cleaning.keep == KeptParts::kSeeds && !KeepSeeds()) return false;
    Show(0.8, "cleaning");
    Restore(body, whole, opening, team_);
    if (stage_.cleaning.fill_holes) FillHoles(body, team_.stop());
    result_.body_statistics =
        StatisticsOf(result_.image, 1, team_.stop(), [&](std::size_t v) { return body.material[v] != 0 ? 0 : -1; })[0];
    return true;
  }

  bool KeepSeeds() {
    for (std::size_t s = 0; s < seeds_.size(); ++s) {
      if (result_.body.MaterialAt(seeds_[s]) != 0) continue;
      problems_.Add(IndexPath("seeds", s), "voxel " + Text(seeds_[s]) + " is not in the body",
                    stage_.cleaning.opening > 0 ? "move it away from the side, or open by less" : "move it");
    }
    if (!problems_.empty()) return false;
    KeepIslandsOf(result_.body, seeds_, team_.stop());
    return true;
  }

  bool Coarsen() {
    Show(0.9, "levels");
    result_.grid = result_.body;
    MakeRightHanded(result_.grid);
    // The lattice of levels starts at the body's bounding box, so that it does not depend on the region.
    result_.grid = CropToSolid(result_.grid, team_.stop());
    for (int level = 0; level < stage_.level; ++level) {
      result_.grid = fascicle::Coarsen(result_.grid, stage_.fraction, team_.stop());
    }
    result_.grid = CropToSolid(result_.grid, team_.stop());
    if (result_.grid.voxels() == 0)
      return Refuse("level", "no voxel is left at this level", "use a lower level, or a smaller fraction");
    return true;
  }

  void TakeNotes(const VolumeImage& image, bool labels) {
    result_.notes = image.notes;
    Vec3 edges;
    for (int axis = 0; axis < 3; ++axis) edges[axis] = result_.grid.size[axis] * result_.grid.spacing[axis];
    const std::string of_values = labels ? NoteOnFractions(result_.image) : std::string();
    for (const std::string& note : {of_values, NoteOnSize(edges.maxCoeff())}) {
      if (!note.empty()) result_.notes.push_back(note);
    }
  }

  const ImageStage& stage_;
  ThreadTeam& team_;
  Problems& problems_;
  const ImageProgress& progress_;
  std::vector<GridIndex> seeds_;
  StagedImage result_;
};

}  // namespace

std::optional<StagedImage> RunImageStage(const VolumeImage& image, const ImageStage& stage, ThreadTeam& team,
                                         Problems& problems, const ImageProgress& progress) {
  Problems found;
  std::optional<StagedImage> result = StageRun(stage, team, found, progress).Run(image);
  problems.Append("", found);
  return result;
}

}  // namespace fascicle
