#include "core/scene/nodal_forces.h"

#include <Eigen/Geometry>

namespace fascicle {
namespace {

using Forces = std::map<std::int32_t, Vec3>;

bool ActsOnFaces(const Traction&) { return true; }
bool ActsOnFaces(const NodalForce&) { return false; }

Forces ForcesOf(const Traction& traction, const LoadedRegion& region) {
  Forces forces;
  for (const LoadedRegion::Face& face : region.faces) {
    for (int c = 0; c < face.count; ++c) {
      forces.try_emplace(face.nodes[c], Vec3::Zero()).first->second += face.area.norm() / face.count * traction.vector;
    }
  }
  return forces;
}

Forces ForcesOf(const NodalForce& force, const LoadedRegion& region) {
  Forces forces;
  for (const std::int32_t node : region.nodes) {
    forces.emplace(node, force.total / static_cast<double>(region.nodes.size()));
  }
  return forces;
}

}  // namespace

LoadedRegion LoadedRegionOf(const Region& region, const std::vector<Vec3>& X) {
  LoadedRegion loaded;
  loaded.nodes = region.nodes;
  for (const Triangle& t : region.triangles) {
    loaded.faces.push_back({0.5 * (X[t[1]] - X[t[0]]).cross(X[t[2]] - X[t[0]]), 3, {t[0], t[1], t[2]}});
  }
  for (const Quad& q : region.quads) {
    loaded.faces.push_back({(X[q[1]] - X[q[0]]).cross(X[q[3]] - X[q[0]]), 4, q});
  }
  return loaded;
}

bool NeedsSurface(const Load& load) {
  return std::visit([](const auto& kind) { return ActsOnFaces(kind); }, load.kind);
}

std::map<std::int32_t, Vec3> NodalForcesOf(const Load& load, const LoadedRegion& region) {
  return std::visit([&](const auto& kind) { return ForcesOf(kind, region); }, load.kind);
}

}  // namespace fascicle
