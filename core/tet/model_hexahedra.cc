#include <algorithm>

#include "core/tet/model_builder.h"

namespace fascicle {
namespace {

using Element27 = HexahedralQuadraticElement;

}  // namespace

// Adds a node on every edge, on every side and in every hexahedron, in the order in which hexahedra first refer to
// them.
void TetModelBuilder::AddNodesOfHexahedra(const TetMesh& mesh, TetBody& entry) {
  for (const Hexahedron& hexahedron : mesh.hexahedra) {
    HeedStop();
    std::array<std::int32_t, 19>& inner = model_.inner_nodes_.emplace_back();
    for (int a = 8; a < 27; ++a) {
      inner[a - 8] = AddMiddle(ParentsOf<Element27>(a), hexahedron, static_cast<std::int32_t>(entry.node_begin));
    }
  }
  if (!mesh.curved_edges.empty()) CurveHexahedra(mesh, entry);
  entry.node_end = model_.nodes();
}

// The node between some corners of a hexahedron; a new one in their middle if there is none yet.
std::int32_t TetModelBuilder::AddMiddle(const Parents& parents, const Hexahedron& hexahedron, std::int32_t first) {
  const auto corner = [&](int i) { return first + hexahedron[parents.corners[i]]; };
  const auto node = static_cast<std::int32_t>(model_.nodes());
  if (parents.count <= 4) {
    Quad corners = parents.count == 2 ? Quad{corner(0), corner(0), corner(1), corner(1)}
                                      : Quad{corner(0), corner(1), corner(2), corner(3)};
    std::sort(corners.begin(), corners.end());
    const auto [place, is_new] = middles_of_hexahedra_.try_emplace(corners, node);
    if (!is_new) return place->second;
  }
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < parents.count; ++i) sum += model_.rest_positions_[corner(i)];
  model_.rest_positions_.push_back(sum / parents.count);
  return node;
}

// Moves mid-edge nodes to the curved edges, and the nodes of sides and centres between them.
void TetModelBuilder::CurveHexahedra(const TetMesh& mesh, const TetBody& entry) {
  const auto first = static_cast<std::int32_t>(entry.node_begin);
  for (const CurvedEdge& edge : mesh.curved_edges) {
    const std::int32_t i = first + edge.ends[0], j = first + edge.ends[1];
    model_.rest_positions_[MiddleOf(Quad{i, i, j, j})] = edge.middle;
  }
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    HeedStop();
    const std::array<std::int32_t, 19>& inner = model_.inner_nodes_[entry.tet_begin + h];
    QuadraticHexahedronNodes X;
    for (std::size_t a = 0; a < 8; ++a) X[a] = mesh.nodes[mesh.hexahedra[h][a]];
    for (std::size_t a = 8; a < 20; ++a) X[a] = model_.rest_positions_[inner[a - 8]];
    FillSidesAndCentre(X);
    for (std::size_t a = 20; a < 27; ++a) model_.rest_positions_[inner[a - 8]] = X[a];
  }
}

// Adds the nodes on edges, on sides and in hexahedra of a region: as of mid-edge nodes (NodesOfRegion), all corners
// must belong to it, on the boundary or in a hexahedron all of whose corners do.
void TetModelBuilder::AddNodesOfHexahedra(const Region& region, const TetBody& body,
                                          std::vector<std::int32_t>& nodes) const {
  const auto first = static_cast<std::int32_t>(body.node_begin);
  const TetMesh& mesh = body.source->tet().mesh;
  std::vector<bool> inside(mesh.nodes.size(), false);
  for (const std::int32_t n : region.nodes) inside[n] = true;
  const auto are_inside = [&](const auto& corners) {
    return std::all_of(corners.begin(), corners.end(), [&](std::int32_t n) { return inside[n]; });
  };
  std::vector<std::int32_t> inner;
  const auto add = [&](const Quad& corners) {
    if (!are_inside(corners)) return;
    inner.push_back(MiddleOf({first + corners[0], first + corners[1], first + corners[2], first + corners[3]}));
  };
  for (const Quad& side : BoundaryOfHexahedra(mesh, stop_).quads) {
    for (std::size_t c = 0; c < 4; ++c) add({side[c], side[c], side[(c + 1) % 4], side[(c + 1) % 4]});
    add(side);
  }
  for (std::size_t e = body.tet_begin; e < body.tet_end; ++e) {
    if (!are_inside(mesh.hexahedra[model_.source_element_[e]])) continue;
    inner.insert(inner.end(), model_.inner_nodes_[e].begin(), model_.inner_nodes_[e].end());
  }
  std::sort(inner.begin(), inner.end());
  inner.erase(std::unique(inner.begin(), inner.end()), inner.end());
  nodes.insert(nodes.end(), inner.begin(), inner.end());
}

// The integrals of the shape functions over the region's hexahedra, by their quadrature points.
void TetModelBuilder::AddPointVolumes(const Region& region, const TetBody& body, LoadedRegion& loaded) const {
  std::vector<bool> chosen(body.tet_end - body.tet_begin, false);
  for (const std::int32_t e : region.elements) chosen[e] = true;
  for (std::size_t e = body.tet_begin; e < body.tet_end; ++e) {
    if (!chosen[model_.source_element_[e]]) continue;
    const auto nodes = model_.NodesOf<Element27>(e);
    for (int q = 0; q < Element27::kPoints; ++q) {
      for (int a = 0; a < Element27::kNodes; ++a) {
        loaded.volumes[nodes[a]] += rest_volume_[Element27::kPoints * e + q] * Element27::Value(q, a);
      }
    }
  }
}

// A side of a hexahedron with its nodes.
PressureFace TetModelBuilder::FaceOf(const Quad& side) const {
  PressureFace face;
  std::copy(side.begin(), side.end(), face.nodes.begin());
  if (model_.order() == ElementOrder::kHexahedral) return face;
  for (std::size_t c = 0; c < 4; ++c) {
    face.nodes[4 + c] = MiddleOf(Quad{side[c], side[c], side[(c + 1) % 4], side[(c + 1) % 4]});
  }
  face.nodes[8] = MiddleOf(side);
  return face;
}

// A side of a hexahedron of 27 nodes with their shares of its area.
LoadedRegion::Face TetModelBuilder::LoadedFace(const PressureFace& side) const {
  LoadedRegion::Face face;
  face.count = 9;
  face.nodes = side.nodes;
  const std::vector<double> shares = SharesOf(model_.order(), side, model_.rest_positions_);
  std::copy(shares.begin(), shares.end(), face.share.begin());
  const auto at = [&](int c) { return model_.rest_positions_[side.nodes[c]]; };
  face.area = 0.5 * (at(2) - at(0)).cross(at(3) - at(1));
  return face;
}

}  // namespace fascicle
