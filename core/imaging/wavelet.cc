#include "core/imaging/wavelet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace fascicle {
namespace {

constexpr std::array<float, 5> kSpline = {1.0F / 16, 4.0F / 16, 6.0F / 16, 4.0F / 16, 1.0F / 16};
constexpr std::size_t kGrain = 16;  // rows

// Reflects an index at the outermost voxels as often as necessary.
std::int32_t Mirrored(std::int32_t at, std::int32_t size) {
  if (size == 1) return 0;
  const std::int32_t period = 2 * (size - 1);
  at = std::abs(at) % period;
  return at < size ? at : period - at;
}

std::array<std::int32_t, 5> Taps(std::int32_t at, std::int32_t step, std::int32_t size) {
  std::array<std::int32_t, 5> taps;
  for (int t = 0; t < 5; ++t) taps[t] = Mirrored(at + (t - 2) * step, size);
  return taps;
}

void BlurAlongRows(const std::vector<float>& from, const GridIndex& size, std::int32_t step, std::vector<float>& to,
                   ThreadTeam& team) {
  const auto length = static_cast<std::size_t>(size[0]);
  const std::int32_t reach = std::min(2 * step, size[0]);
  ForEach(team, from.size() / length, kGrain, [&](std::size_t row) {
    const float* in = &from[row * length];
    float* out = &to[row * length];
    const auto at_side = [&](std::int32_t i) {
      const auto taps = Taps(i, step, size[0]);
      float sum = 0;
      for (int t = 0; t < 5; ++t) sum += kSpline[t] * in[taps[t]];
      out[i] = sum;
    };
    for (std::int32_t i = 0; i < reach; ++i) at_side(i);
    for (std::int32_t i = reach; i < size[0] - reach; ++i) {
      float sum = 0;
      for (int t = 0; t < 5; ++t) sum += kSpline[t] * in[i + (t - 2) * step];
      out[i] = sum;
    }
    for (std::int32_t i = std::max(reach, size[0] - reach); i < size[0]; ++i) at_side(i);
  });
}

// Along j (axis 1) or k (axis 2): adds up whole rows.
void BlurAcrossRows(const std::vector<float>& from, const GridIndex& size, int axis, std::int32_t step,
                    std::vector<float>& to, ThreadTeam& team) {
  const auto length = static_cast<std::size_t>(size[0]);
  const std::size_t stride = axis == 1 ? length : length * size[1];
  ForEach(team, from.size() / length, kGrain, [&](std::size_t row) {
    const auto at = static_cast<std::int32_t>(axis == 1 ? row % size[1] : row / size[1]);
    const auto taps = Taps(at, step, size[axis]);
    const float* in[5];
    for (int t = 0; t < 5; ++t) in[t] = &from[row * length] + (taps[t] - at) * static_cast<std::ptrdiff_t>(stride);
    float* out = &to[row * length];
    for (std::size_t i = 0; i < length; ++i) {
      out[i] = kSpline[0] * in[0][i] + kSpline[1] * in[1][i] + kSpline[2] * in[2][i] + kSpline[3] * in[3][i] +
               kSpline[4] * in[4][i];
    }
  });
}

// Standard deviation of the noise, from the finest wavelet coefficients.
double NoiseOf(const std::vector<float>& image, const std::vector<float>& blurred, double gain) {
  constexpr std::size_t kSamples = 4'000'000;
  constexpr double kOfNormal = 0.674489750196;  // median of |x| for a standard deviation of 1
  const std::size_t step = image.size() / kSamples + 1;
  std::vector<float> sizes;
  for (std::size_t v = 0; v < image.size(); v += step) {
    // A masked background has no noise.
    if (image[v] != 0) sizes.push_back(std::abs(image[v] - blurred[v]));
  }
  if (sizes.empty()) return 0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle / kOfNormal / gain;
}

}  // namespace

std::vector<float> Blurred(const std::vector<float>& values, const GridIndex& size, int scale, ThreadTeam& team) {
  const std::int32_t step = std::int32_t{1} << (scale - 1);
  std::vector<float> once(values.size()), twice(values.size());
  BlurAlongRows(values, size, step, once, team);
  BlurAcrossRows(once, size, 1, step, twice, team);
  BlurAcrossRows(twice, size, 2, step, once, team);
  return once;
}

double NoiseGain(const GridIndex& size, int scale) {
  // Response of c_s to a single voxel along one axis.
  const auto response = [](int s) {
    std::vector<double> values = {1};
    for (int step = 1; s > 0; --s, step *= 2) {
      std::vector<double> wider(values.size() + 4 * step, 0);
      for (std::size_t i = 0; i < values.size(); ++i) {
        for (int t = 0; t < 5; ++t) wider[i + t * step] += static_cast<double>(kSpline[t]) * values[i];
      }
      values = std::move(wider);
    }
    return values;
  };
  const std::vector<double> fine = response(scale - 1), coarse = response(scale);
  const std::size_t shift = (coarse.size() - fine.size()) / 2;
  double of_fine = 1, of_coarse = 1, of_both = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (size[axis] == 1) continue;
    double fine2 = 0, coarse2 = 0, both = 0;
    for (const double value : fine) fine2 += value * value;
    for (const double value : coarse) coarse2 += value * value;
    for (std::size_t i = 0; i < fine.size(); ++i) both += fine[i] * coarse[i + shift];
    of_fine *= fine2;
    of_coarse *= coarse2;
    of_both *= both;
  }
  return std::sqrt(std::max(of_fine - 2 * of_both + of_coarse, 0.0));
}

VolumeImage WaveletFiltered(const VolumeImage& image, const WaveletFilter& filter, ThreadTeam& team) {
  if (filter.threshold == 0 || image.voxels() == 1) return image;
  VolumeImage result = image;
  std::vector<float> finer = image.values;
  double noise = 0;
  for (int scale = 1; scale <= filter.scales; ++scale) {
    std::vector<float> coarser = Blurred(finer, image.size, scale, team);
    const double gain = NoiseGain(image.size, scale);
    if (scale == 1) noise = NoiseOf(finer, coarser, gain);
    const auto least = static_cast<float>(filter.threshold * noise * gain);
    // The shrunk-off part is subtracted from the image, so that unchanged coefficients leave it unchanged to the last
    // bit.
    team.For(finer.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const float w = finer[v] - coarser[v];
        result.values[v] -= std::abs(w) <= least ? w : least * least / w;
      }
    });
    finer = std::move(coarser);
  }
  return result;
}

double EstimateNoise(const VolumeImage& image, ThreadTeam& team) {
  if (image.voxels() <= 1) return 0;
  return NoiseOf(image.values, Blurred(image.values, image.size, 1, team), NoiseGain(image.size, 1));
}

}  // namespace fascicle
