#include "core/scene/nodal_forces.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace fascicle {
namespace {

using Forces = std::map<std::int32_t, Vec3>;

LoadedPart PartOf(const Traction&) { return LoadedPart::kFaces; }
LoadedPart PartOf(const NodalForce&) { return LoadedPart::kNodes; }
LoadedPart PartOf(const Pressure&) { return LoadedPart::kFaces; }
LoadedPart PartOf(const BodyForce&) { return LoadedPart::kElements; }
LoadedPart PartOf(const Springs&) { return LoadedPart::kNodes; }
LoadedPart PartOf(const LineSpring&) { return LoadedPart::kNodes; }

Forces ForcesOf(const Traction& traction, const LoadedRegion& region) {
  Forces forces;
  for (const LoadedRegion::Face& face : region.faces) {
    for (int c = 0; c < face.count; ++c) {
      forces.try_emplace(face.nodes[c], Vec3::Zero()).first->second += face.share[c] * traction.vector;
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

Forces ForcesOf(const Pressure& pressure, const LoadedRegion& region) {
  Forces forces;
  for (const LoadedRegion::Face& face : region.faces) {
    for (int c = 0; c < face.count; ++c) {
      forces.try_emplace(face.nodes[c], Vec3::Zero()).first->second -= pressure.value / face.count * face.area;
    }
  }
  return forces;
}

Forces ForcesOf(const BodyForce& force, const LoadedRegion& region) {
  Forces forces;
  for (const auto& [node, volume] : region.volumes) forces.emplace(node, volume * force.density);
  return forces;
}

Forces ForcesOf(const Springs&, const LoadedRegion&) { return {}; }
Forces ForcesOf(const LineSpring&, const LoadedRegion&) { return {}; }

using Volumes = std::map<std::int32_t, double>;

Volumes VolumesOf(const Region& region, const TetShape& shape) {
  Volumes volumes;
  if (!shape.mesh.hexahedra.empty()) return VolumesOfHexahedra(region, shape.mesh);
  for (const std::int32_t e : region.elements) {
    const double share = SignedVolume(shape.mesh, static_cast<std::size_t>(e)) / 4;
    for (const std::int32_t node : shape.mesh.tetrahedra[e]) volumes[node] += share;
  }
  return volumes;
}
Volumes VolumesOf(const Region& region, const VoxelShape& shape) {
  Volumes volumes;
  const double share = shape.mesh.grid.spacing.prod() / 8;
  for (const std::int32_t e : region.elements) {
    for (const std::int32_t node : shape.mesh.bricks[e]) volumes[node] += share;
  }
  return volumes;
}
Volumes VolumesOf(const Region&, const SurfaceShape&) { return {}; }

}  // namespace

std::map<std::int32_t, double> VolumesOfHexahedra(const Region& region, const TetMesh& mesh) {
  Volumes volumes;
  for (const std::int32_t e : region.elements) {
    const std::array<double, 8> shares = NodeVolumes(NodesOfHexahedron(mesh, static_cast<std::size_t>(e)));
    for (std::size_t a = 0; a < 8; ++a) volumes[mesh.hexahedra[e][a]] += shares[a];
  }
  return volumes;
}

LoadedRegion::Face::Face(const Vec3& a, int n, const std::array<std::int32_t, 4>& of) : area(a), count(n) {
  for (int c = 0; c < n; ++c) {
    nodes[c] = of[c];
    share[c] = a.norm() / n;
  }
}

LoadedRegion::Face LoadedSide(const Quad& side, const std::vector<Vec3>& X) {
  constexpr double kNear = 0.21132486540518711775;  // (1 - 1/sqrt(3)) / 2
  LoadedRegion::Face face;
  face.count = 4;
  std::copy(side.begin(), side.end(), face.nodes.begin());
  face.area = 0.5 * (X[side[2]] - X[side[0]]).cross(X[side[3]] - X[side[1]]);
  for (const double u : {kNear, 1 - kNear}) {
    for (const double v : {kNear, 1 - kNear}) {
      const Vec3 along_u = (1 - v) * (X[side[1]] - X[side[0]]) + v * (X[side[2]] - X[side[3]]);
      const Vec3 along_v = (1 - u) * (X[side[3]] - X[side[0]]) + u * (X[side[2]] - X[side[1]]);
      const double part = 0.25 * along_u.cross(along_v).norm();
      const std::array<double, 4> weight = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
      for (std::size_t c = 0; c < 4; ++c) face.share[c] += part * weight[c];
    }
  }
  return face;
}

LoadedRegion LoadedRegionOf(const Region& region, const std::vector<Vec3>& X) {
  LoadedRegion loaded;
  loaded.nodes = region.nodes;
  for (const Quad& side : region.sides) loaded.faces.push_back(LoadedSide(side, X));
  if (!region.sides.empty()) return loaded;  // the triangles are those of the sides
  for (const Triangle& t : region.triangles) {
    loaded.faces.emplace_back(0.5 * (X[t[1]] - X[t[0]]).cross(X[t[2]] - X[t[0]]), 3, Quad{t[0], t[1], t[2]});
  }
  for (const Quad& q : region.quads) {
    loaded.faces.emplace_back((X[q[1]] - X[q[0]]).cross(X[q[3]] - X[q[0]]), 4, q);
  }
  return loaded;
}

LoadedRegion LoadedRegionOf(const Region& region, const Body& body) {
  LoadedRegion loaded = LoadedRegionOf(region, body.nodes());
  loaded.volumes = std::visit([&](const auto& shape) { return VolumesOf(region, shape); }, body.shape);
  return loaded;
}

LoadedPart LoadedPartOf(const Load& load) {
  return std::visit([](const auto& kind) { return PartOf(kind); }, load.kind);
}

bool DependsOnPositions(const Load& load) {
  return std::holds_alternative<Pressure>(load.kind) || std::holds_alternative<Springs>(load.kind) ||
         std::holds_alternative<LineSpring>(load.kind);
}

std::map<std::int32_t, Vec3> NodalForcesOf(const Load& load, const LoadedRegion& region) {
  return std::visit([&](const auto& kind) { return ForcesOf(kind, region); }, load.kind);
}

}  // namespace fascicle
