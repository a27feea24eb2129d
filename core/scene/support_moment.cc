#include "core/scene/support_moment.h"

#include <numeric>

#include "core/scene/nodal_forces.h"

namespace fascicle {

Vec3 CentroidOf(const Region& region, const std::vector<Vec3>& nodes) {
  Vec3 moment = Vec3::Zero(), sum = Vec3::Zero();
  double area = 0;
  for (const LoadedRegion::Face& face : LoadedRegionOf(region, nodes).faces) {
    for (int c = 0; c < face.count; ++c) moment += face.share[c] * nodes[face.nodes[c]];
    area += face.area.norm();
  }
  if (area > 0) return moment / area;
  if (region.nodes.empty()) return std::accumulate(nodes.begin(), nodes.end(), sum) / static_cast<double>(nodes.size());
  for (const std::int32_t node : region.nodes) sum += nodes[node];
  return sum / static_cast<double>(region.nodes.size());
}

MomentReference MomentReferenceOf(const Scene& scene, std::size_t body, std::int32_t region) {
  const Body& source = scene.bodies[body];
  MomentReference reference = {CentroidOf(source.regions[region], source.nodes()), std::nullopt};
  for (const SupportMoment& moment : scene.output.moments) {
    if (static_cast<std::size_t>(moment.body) != body || moment.region != region) continue;
    if (moment.point) reference.point = *moment.point;
    reference.axis = moment.axis;
  }
  return reference;
}

}  // namespace fascicle
