#ifndef FASCICLE_CORE_IMAGING_CLASSES_H_
#define FASCICLE_CORE_IMAGING_CLASSES_H_

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/parallel.h"

namespace fascicle {

// A histogram of an image's values, from which classes are found.
struct Histogram {
  double lowest = 0, highest = 0;    // smallest and largest value
  std::vector<std::int64_t> counts;  // of bins of equal width from lowest to highest

  double width() const { return (highest - lowest) / static_cast<double>(counts.size()); }
  double CentreOf(std::size_t bin) const { return lowest + (static_cast<double>(bin) + 0.5) * width(); }
  std::size_t BinOf(double value) const;
  // Number of non-empty bins.
  std::size_t filled() const;
};
// Requires bins >= 1 and at least one value, all finite.
Histogram MakeHistogram(std::span<const float> values, int bins);

// The classes - 1 ascending thresholds that divide a histogram into classes with the largest variance between them
// [Otsu 1979, Liao 2001]. Requires classes >= 2 and at least as many filled bins. Takes time proportional to classes *
// bins^2.
std::vector<double> OtsuThresholds(const Histogram& histogram, int classes);

// Fuzzy c-means [Bezdek 1981]: minimizes the sum over voxels x and classes c of u_c(x)^m |value(x) - v_c|^2.
struct FuzzyMeans {
  std::vector<double> centres;  // v_c, ascending
  double fuzziness = 2;         // m > 1
  int iterations = 0;
  bool converged = false;

  // u_c of a value, in [0, 1]. The memberships of a value add to 1.
  double Membership(double value, std::size_t c) const;
  // The class with the largest membership: the one with the nearest centre.
  std::size_t ClassOf(double value) const;
};
// Finds fuzzy means on the bins of a histogram, starting from the means of Otsu's classes, until no centre moves by
// more than 1e-7 of the range. Throws Stopped after a stop request.
FuzzyMeans FindFuzzyMeans(const Histogram& histogram, int classes, double fuzziness, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_CLASSES_H_
