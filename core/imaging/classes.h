#ifndef FASCICLE_CORE_IMAGING_CLASSES_H_
#define FASCICLE_CORE_IMAGING_CLASSES_H_

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"

namespace fascicle {

// Values from which the classes of an image are told apart: a histogram over its range.
struct Histogram {
  double lowest = 0, highest = 0;    // of all values
  std::vector<std::int64_t> counts;  // of bins of equal width from lowest to highest

  double width() const { return (highest - lowest) / static_cast<double>(counts.size()); }
  double CentreOf(std::size_t bin) const { return lowest + (static_cast<double>(bin) + 0.5) * width(); }
  std::size_t BinOf(double value) const;
  // How many bins have counts.
  std::size_t filled() const;
};
// bins >= 1; values finite, at least one.
Histogram MakeHistogram(std::span<const float> values, int bins);

// The classes - 1 rising values that part a histogram into classes of largest variance between them [Otsu 1979, Liao
// 2001]. classes >= 2; at least as many bins have counts. Takes a time of classes * bins^2.
std::vector<double> OtsuThresholds(const Histogram& histogram, int classes);

// Fuzzy c-means [Bezdek 1981]: minimizes the sum over voxels x and classes c of u_c(x)^m |value(x) - v_c|^2.
struct FuzzyMeans {
  std::vector<double> centres;  // v_c, rising
  double fuzziness = 2;         // m > 1
  int iterations = 0;
  bool converged = false;

  // u_c of a value, in [0, 1]; they add up to 1.
  double Membership(double value, std::size_t c) const;
  // The class of largest membership: that of the nearest centre.
  std::size_t ClassOf(double value) const;
};
// On the bins of a histogram, from the means of Otsu's classes on, until no centre moves by more than 1e-7 of the
// range.
FuzzyMeans FindFuzzyMeans(const Histogram& histogram, int classes, double fuzziness);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_CLASSES_H_
