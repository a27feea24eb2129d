#include "core/eulerian/surface_samples.h"

#include <algorithm>
#include <cmath>

namespace fascicle {
namespace {

constexpr int kMostParts = 64;  // along an edge

double LongestEdge(const TriangleMesh& surface, const Triangle& triangle) {
  double longest = 0;
  for (int e = 0; e < 3; ++e) {
    longest = std::max(longest, (surface.nodes[triangle[e]] - surface.nodes[triangle[(e + 1) % 3]]).norm());
  }
  return longest;
}

}  // namespace

std::vector<SurfaceSample> SamplesOf(const TriangleMesh& surface, double spacing) {
  std::vector<SurfaceSample> samples;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const double parts = std::ceil(LongestEdge(surface, surface.triangles[t]) / spacing);
    const int n = static_cast<int>(std::clamp(parts, 1.0, static_cast<double>(kMostParts)));
    const auto add = [&](double i, double j) {
      const Vec3 weights((i / n), (j / n), 1 - (i + j) / n);
      samples.push_back({static_cast<std::int32_t>(t), weights, 1.0 / (n * n)});
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        add(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j + 1 < n) add(i + 2.0 / 3, j + 2.0 / 3);
      }
    }
  }
  return samples;
}

}  // namespace fascicle
