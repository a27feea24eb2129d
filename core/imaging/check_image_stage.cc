#include <cmath>
#include <set>
#include <string>

#include "core/imaging/image_stage.h"

namespace fascicle {
namespace {

bool InRange(double value, double low, double high) { return value >= low && value <= high; }

void CheckFilter(const ImageFilter& filter, const std::string& path, Problems& problems) {
  if (const auto* gaussian = std::get_if<GaussianFilter>(&filter)) {
    if (!(gaussian->deviation > 0) || !std::isfinite(gaussian->deviation)) {
      problems.Add(path + ".deviation", "must be above 0", "a voxel or two is usual");
    }
  } else if (const auto* curvature = std::get_if<CurvatureFilter>(&filter)) {
    if (!InRange(curvature->iterations, 1, 100)) problems.Add(path + ".iterations", "must be 1 to 100", "5 is usual");
    if (!(curvature->conductance > 0) || !std::isfinite(curvature->conductance)) {
      problems.Add(path + ".conductance", "must be above 0", "1 is usual; larger blurs more");
    }
  } else if (const auto* bias = std::get_if<BiasFieldFilter>(&filter)) {
    if (!InRange(bias->refinements, 0, 5)) problems.Add(path + ".refinements", "must be 0 to 5", "3 is usual");
    if (!InRange(bias->iterations, 1, 500)) problems.Add(path + ".iterations", "must be 1 to 500", "50 is usual");
  } else {
    const auto& wavelet = std::get<WaveletFilter>(filter);
    if (!InRange(wavelet.scales, 1, 8)) problems.Add(path + ".scales", "must be 1 to 8", "3 is usual");
    if (!(wavelet.threshold >= 0) || !std::isfinite(wavelet.threshold)) {
      problems.Add(path + ".threshold", "must be 0 or above", "3 deviations of the noise are usual");
    }
  }
}

void CheckThresholds(const Classification& choice, Problems& problems) {
  constexpr std::size_t kMost = 7;
  const std::string path = "classification.thresholds";
  if (choice.method != ClassMethod::kGivenThresholds) {
    if (!choice.thresholds.empty()) problems.Add(path, "are found by the method", "leave them out, or take given ones");
    return;
  }
  if (choice.thresholds.empty() || choice.thresholds.size() > kMost) problems.Add(path, "needs 1 to 7 values");
  for (std::size_t t = 0; t < choice.thresholds.size(); ++t) {
    const bool rising = t == 0 || choice.thresholds[t] > choice.thresholds[t - 1];
    if (!std::isfinite(choice.thresholds[t]) || !rising) {
      problems.Add(IndexPath(path, t), "must be finite and above the one before", "");
    }
  }
}

void CheckClassification(const ImageStage& stage, const Classification& choice, Problems& problems) {
  const bool given = choice.method == ClassMethod::kGivenThresholds;
  const int classes = given ? static_cast<int>(choice.thresholds.size()) + 1 : choice.classes;
  if (!given && !InRange(classes, 2, 8)) problems.Add("classification.classes", "must be 2 to 8", "3 is usual");
  if (!(choice.fuzziness > 1 && choice.fuzziness <= 10)) {
    problems.Add("classification.fuzziness", "must be above 1 and at most 10", "2 is usual");
  }
  if (!InRange(choice.least_membership, 0, 1)) problems.Add("classification.least_membership", "must be 0 to 1", "");
  CheckThresholds(choice, problems);
  if (choice.wanted_class && !InRange(*choice.wanted_class, 0, classes - 1)) {
    problems.Add("classification.wanted_class", "must be 0 to " + std::to_string(classes - 1),
                 "classes are counted from the darkest");
  }
  if (!choice.wanted_class && stage.seeds.empty()) {
    problems.Add("classification.wanted_class", "which class is wanted is not said",
                 "give its number from 0 at the darkest, or a seed in it");
  }
}

void CheckLabels(const ImageStage& stage, const LabelChoice& choice, Problems& problems) {
  constexpr std::size_t kMost = 255;
  std::set<int> seen;
  if (choice.labels.size() > kMost) problems.Add("labels", "more than 255 are given", "");
  for (std::size_t l = 0; l < choice.labels.size(); ++l) {
    if (choice.labels[l] == 0) problems.Add(IndexPath("labels", l), "0 is what no body is of", "");
    if (!seen.insert(choice.labels[l]).second) problems.Add(IndexPath("labels", l), "is given twice", "");
  }
  if (!stage.filters.empty()) problems.Add("filters", "labels can't be filtered", "leave them out, or classify values");
}

}  // namespace

void CheckImageStage(const ImageStage& stage, Problems& problems) {
  if (stage.region) {
    for (int axis = 0; axis < 3; ++axis) {
      if (stage.region->first[axis] < 0) problems.Add("region.first", "must not be below 0", "voxels count from 0");
      if (stage.region->size[axis] < 1) problems.Add("region.size", "must be at least 1 along each axis", "");
    }
  }
  if (stage.resample && (!(*stage.resample > 0) || !std::isfinite(*stage.resample))) {
    problems.Add("resample", "must be above 0", "");
  }
  for (std::size_t f = 0; f < stage.filters.size(); ++f) {
    CheckFilter(stage.filters[f], IndexPath("filters", f), problems);
  }
  if (const auto* labels = std::get_if<LabelChoice>(&stage.choice)) {
    CheckLabels(stage, *labels, problems);
  } else {
    CheckClassification(stage, std::get<Classification>(stage.choice), problems);
  }
  for (std::size_t s = 0; s < stage.seeds.size(); ++s) {
    if (!stage.seeds[s].allFinite()) problems.Add(IndexPath("seeds", s), "must be finite", "");
  }
  if (stage.cleaning.keep == KeptParts::kSeeds && stage.seeds.empty()) {
    problems.Add("cleaning.keep", "no seeds are given", "give points of the islands that are kept");
  }
  if (!(stage.cleaning.opening >= 0) || !std::isfinite(stage.cleaning.opening)) {
    problems.Add("cleaning.opening", "must be 0 or above", "");
  }
  if (!InRange(stage.level, 0, 10)) problems.Add("level", "must be 0 to 10", "each level has voxels of twice the size");
  if (!(stage.fraction > 0 && stage.fraction <= 1))
    problems.Add("fraction", "must be above 0 and at most 1", "0.5 is usual");
}

}  // namespace fascicle
