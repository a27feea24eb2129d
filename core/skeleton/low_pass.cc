#include "core/skeleton/low_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace fascicle {
namespace {

// The third-order Butterworth filter 1 / ((s + 1) (s^2 + s + 1)) by the bilinear transformation, as the first-order
// section followed by the second-order one. k = tan(pi cutoff interval). Starts at rest at the first sample.
void Filter(double k, std::vector<double>& x) {
  const double a = (k - 1) / (k + 1), b = k / (k + 1);
  const double scale = 1 / (1 + k + k * k);
  const double c1 = 2 * (k * k - 1) * scale, c2 = (1 - k + k * k) * scale, d = k * k * scale;
  double x1 = x.front(), y1 = x1, w1 = x1, w2 = x1, z1 = x1, z2 = x1;
  for (double& sample : x) {
    const double y = b * (sample + x1) - a * y1;
    x1 = sample;
    y1 = y;
    const double z = d * (y + 2 * w1 + w2) - c1 * z1 - c2 * z2;
    w2 = w1;
    w1 = y;
    z2 = z1;
    z1 = z;
    sample = z;
  }
}

}  // namespace

std::vector<double> LowPass(const std::vector<double>& samples, double interval, double cutoff) {
  const std::size_t n = samples.size();
  if (n < 2) return samples;
  const std::size_t pad = n / 2;
  std::vector<double> x(n + 2 * pad);
  std::copy(samples.begin(), samples.end(), x.begin() + static_cast<std::ptrdiff_t>(pad));
  for (std::size_t k = 1; k <= pad; ++k) {
    x[pad - k] = 2 * samples.front() - samples[k];
    x[pad + n - 1 + k] = 2 * samples.back() - samples[n - 1 - k];
  }
  const double warped = std::tan(std::numbers::pi * cutoff * interval);
  Filter(warped, x);
  std::reverse(x.begin(), x.end());
  Filter(warped, x);
  std::reverse(x.begin(), x.end());
  const auto begin = x.begin() + static_cast<std::ptrdiff_t>(pad);
  return {begin, begin + static_cast<std::ptrdiff_t>(n)};
}

}  // namespace fascicle
