// Thresholds against all possible ones, and fuzzy means against the sums that define them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/imaging/classes.h"

namespace fascicle::testing {
namespace {

// Three overlapping distributions of values.
std::vector<float> Heaps(std::size_t count) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<float> values;
  for (std::size_t v = 0; v < count; ++v) {
    const int heap = static_cast<int>(random() % 10);
    values.push_back(heap < 5   ? 20 + 10 * normal(random)
                     : heap < 8 ? 100 + 15 * normal(random)
                                : 180 + 12 * normal(random));
  }
  return values;
}

// Between-class variance of the classes separated by thresholds, up to a constant.
double BetweenClasses(const Histogram& histogram, const std::vector<double>& thresholds) {
  std::vector<double> count(thresholds.size() + 1, 0), moment(thresholds.size() + 1, 0);
  for (std::size_t b = 0; b < histogram.counts.size(); ++b) {
    std::size_t c = 0;
    while (c < thresholds.size() && histogram.CentreOf(b) > thresholds[c]) ++c;
    count[c] += static_cast<double>(histogram.counts[b]);
    moment[c] += static_cast<double>(histogram.counts[b]) * histogram.CentreOf(b);
  }
  double sum = 0;
  for (std::size_t c = 0; c < count.size(); ++c) sum += count[c] > 0 ? moment[c] * moment[c] / count[c] : 0;
  return sum;
}

TEST(Histogram, CountsEveryValueOnce) {
  const std::vector<float> values = {0, 1, 2, 3, 4, 4, 10};
  const Histogram histogram = MakeHistogram(values, 5);
  EXPECT_EQ(histogram.counts, (std::vector<std::int64_t>{2, 2, 2, 0, 1}));
  EXPECT_EQ(histogram.filled(), 4u);
  EXPECT_EQ(histogram.BinOf(-5), 0u);
  EXPECT_EQ(histogram.BinOf(50), 4u);
  EXPECT_EQ(MakeHistogram(std::vector<float>{7, 7}, 5).filled(), 1u);
}

TEST(Otsu, FindsTheBestOfAllThresholds) {
  const Histogram histogram = MakeHistogram(Heaps(2000), 40);
  double best2 = 0, best3 = 0;
  for (double a = histogram.lowest; a < histogram.highest; a += histogram.width()) {
    best2 = std::max(best2, BetweenClasses(histogram, {a}));
    for (double b = a; b < histogram.highest; b += histogram.width()) {
      best3 = std::max(best3, BetweenClasses(histogram, {a, b}));
    }
  }
  EXPECT_NEAR(BetweenClasses(histogram, OtsuThresholds(histogram, 2)), best2, 1e-9 * best2);
  EXPECT_NEAR(BetweenClasses(histogram, OtsuThresholds(histogram, 3)), best3, 1e-9 * best3);
  EXPECT_GT(best3, best2);
}

TEST(Otsu, PartsHeapsWhereTheyAreThinnest) {
  const std::vector<double> thresholds = OtsuThresholds(MakeHistogram(Heaps(20000), 4096), 3);
  EXPECT_NEAR(thresholds[0], 60, 6);
  EXPECT_NEAR(thresholds[1], 140, 8);
}

TEST(Otsu, AsManyClassesAsValues) {
  EXPECT_EQ(OtsuThresholds(MakeHistogram(std::vector<float>{0, 0, 50, 100}, 101), 3).size(), 2u);
}

// Bezdek's iteration over the voxels themselves, step by step.
std::vector<double> PlainFuzzyMeans(const std::vector<float>& values, std::vector<double> centres, double m) {
  for (int iteration = 0; iteration < 400; ++iteration) {
    std::vector<double> above(centres.size(), 0), below(centres.size(), 0);
    for (const float value : values) {
      for (std::size_t c = 0; c < centres.size(); ++c) {
        double sum = 0;
        for (const double centre : centres) {
          sum += std::pow(std::abs(value - centres[c]) / std::abs(value - centre), 2 / (m - 1));
        }
        const double weight = std::pow(1 / sum, m);
        above[c] += weight * value;
        below[c] += weight;
      }
    }
    for (std::size_t c = 0; c < centres.size(); ++c) centres[c] = above[c] / below[c];
  }
  return centres;
}

TEST(FuzzyMeansTest, AgreesWithTheSumsOverVoxels) {
  const std::vector<float> values = Heaps(2000);
  const Histogram histogram = MakeHistogram(values, 65536);
  for (const double fuzziness : {1.6, 2.0, 3.0}) {
    const FuzzyMeans means = FindFuzzyMeans(histogram, 3, fuzziness);
    EXPECT_TRUE(means.converged);
    const std::vector<double> plain = PlainFuzzyMeans(values, {10, 90, 190}, fuzziness);
    for (int c = 0; c < 3; ++c) {
      // Half a bin, and the tolerance of the iteration.
      EXPECT_NEAR(means.centres[c], plain[c], histogram.width()) << fuzziness;
    }
  }
}

TEST(FuzzyMeansTest, MembershipsAddUpToOne) {
  const FuzzyMeans means = FindFuzzyMeans(MakeHistogram(Heaps(5000), 4096), 4, 2);
  for (double value = -50; value < 300; value += 7.3) {
    double sum = 0;
    std::size_t most = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      const double u = means.Membership(value, c);
      EXPECT_GE(u, 0);
      sum += u;
      if (u > means.Membership(value, most)) most = c;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_EQ(most, means.ClassOf(value));
  }
  EXPECT_EQ(means.Membership(means.centres[1], 1), 1);
  EXPECT_EQ(means.Membership(means.centres[1], 2), 0);
}

}  // namespace
}  // namespace fascicle::testing
