#include "core/imaging/classes.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/stop.h"

namespace fascicle {
namespace {

// The non-empty bins of a histogram.
struct Bins {
  std::vector<double> value, count;
};

Bins FilledBins(const Histogram& histogram) {
  Bins bins;
  for (std::size_t b = 0; b < histogram.counts.size(); ++b) {
    if (histogram.counts[b] == 0) continue;
    bins.value.push_back(histogram.CentreOf(b));
    bins.count.push_back(static_cast<double>(histogram.counts[b]));
  }
  return bins;
}

double Power(double distance, double exponent) {
  // 2 is the usual exponent.
  return exponent == 2 ? distance * distance : std::pow(distance, exponent);
}

}  // namespace

std::size_t Histogram::BinOf(double value) const {
  if (!(highest > lowest)) return 0;
  const double bin = std::floor((value - lowest) / width());
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(counts.size() - 1)));
}

std::size_t Histogram::filled() const {
  return static_cast<std::size_t>(std::count_if(counts.begin(), counts.end(), [](std::int64_t n) { return n > 0; }));
}

Histogram MakeHistogram(std::span<const float> values, int bins) {
  FASCICLE_CHECK(!values.empty() && bins >= 1, "a histogram needs values and bins");
  Histogram histogram;
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  histogram.lowest = *lowest;
  histogram.highest = *highest;
  histogram.counts.assign(bins, 0);
  for (const float value : values) ++histogram.counts[histogram.BinOf(value)];
  return histogram;
}

// By dynamic programming over the number of classes [Liao 2001]: the best division of the first bins into c classes
// extends one into c - 1 classes. Exact, and faster than ITK's search through all combinations.
std::vector<double> OtsuThresholds(const Histogram& histogram, int classes) {
  const Bins bins = FilledBins(histogram);
  const std::size_t n = bins.value.size();
  FASCICLE_CHECK(classes >= 2 && n >= static_cast<std::size_t>(classes), "at least as many filled bins as classes");
  std::vector<double> count(n + 1, 0), moment(n + 1, 0);  // cumulative, over the first bins
  for (std::size_t b = 0; b < n; ++b) {
    count[b + 1] = count[b] + bins.count[b];
    moment[b + 1] = moment[b] + bins.count[b] * (bins.value[b] - histogram.lowest);
  }
  // Contribution of a class with bins [begin, end) to the variance between classes, up to a constant.
  const auto gain = [&](std::size_t begin, std::size_t end) {
    const double m = moment[end] - moment[begin];
    return m * m / (count[end] - count[begin]);
  };
  std::vector<double> best(n + 1, 0);  // for the first bins, with the current number of classes
  for (std::size_t end = 1; end <= n; ++end) best[end] = gain(0, end);
  std::vector<std::vector<std::size_t>> starts;  // start of the last class, for each end
  for (int c = 2; c <= classes; ++c) {
    std::vector<double> better(n + 1, -1);
    std::vector<std::size_t> start(n + 1, 0);
    for (std::size_t end = c; end <= n; ++end) {
      for (std::size_t begin = c - 1; begin < end; ++begin) {
        const double total = best[begin] + gain(begin, end);
        if (total > better[end]) {
          better[end] = total;
          start[end] = begin;
        }
      }
    }
    best = std::move(better);
    starts.push_back(std::move(start));
  }
  std::vector<double> thresholds(classes - 1);
  std::size_t end = n;
  for (int c = classes - 2; c >= 0; --c) {
    end = starts[c][end];
    thresholds[c] = 0.5 * (bins.value[end - 1] + bins.value[end]);
  }
  return thresholds;
}

double FuzzyMeans::Membership(double value, std::size_t c) const {
  // u_c = 1 / sum over k of (d_c / d_k)^(2 / (m - 1)) [Bezdek 1981, eq. 11.3a].
  const double own = std::abs(value - centres[c]);
  if (own == 0) return 1;
  double sum = 0;
  for (const double centre : centres) {
    const double other = std::abs(value - centre);
    if (other == 0) return 0;
    sum += Power(own / other, 2 / (fuzziness - 1));
  }
  return 1 / sum;
}

std::size_t FuzzyMeans::ClassOf(double value) const {
  std::size_t nearest = 0;
  for (std::size_t c = 1; c < centres.size(); ++c) {
    if (std::abs(value - centres[c]) < std::abs(value - centres[nearest])) nearest = c;
  }
  return nearest;
}

FuzzyMeans FindFuzzyMeans(const Histogram& histogram, int classes, double fuzziness, const std::stop_token& stop) {
  constexpr int kMostIterations = 1000;
  constexpr double kTolerance = 1e-7;  // relative to the range
  const Bins bins = FilledBins(histogram);
  FuzzyMeans means;
  means.fuzziness = fuzziness;
  const std::vector<double> thresholds = OtsuThresholds(histogram, classes);
  for (int c = 0; c < classes; ++c) {
    double count = 0, moment = 0;
    for (std::size_t b = 0; b < bins.value.size(); ++b) {
      const bool above = c == 0 || bins.value[b] > thresholds[c - 1];
      const bool below = c == classes - 1 || bins.value[b] <= thresholds[c];
      if (!above || !below) continue;
      count += bins.count[b];
      moment += bins.count[b] * bins.value[b];
    }
    means.centres.push_back(moment / count);
  }
  while (!means.converged && means.iterations < kMostIterations) {
    ThrowIfStopped(stop);
    ++means.iterations;
    double moved = 0;
    std::vector<double> weight(classes, 0), moment(classes, 0);
    for (std::size_t b = 0; b < bins.value.size(); ++b) {
      for (int c = 0; c < classes; ++c) {
        const double u = Power(means.Membership(bins.value[b], c), fuzziness) * bins.count[b];
        weight[c] += u;
        moment[c] += u * bins.value[b];
      }
    }
    for (int c = 0; c < classes; ++c) {
      const double centre = moment[c] / weight[c];
      moved = std::max(moved, std::abs(centre - means.centres[c]));
      means.centres[c] = centre;
    }
    means.converged = moved <= kTolerance * (histogram.highest - histogram.lowest);
  }
  std::sort(means.centres.begin(), means.centres.end());
  return means;
}

}  // namespace fascicle
