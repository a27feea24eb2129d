#include "core/tet/model_builder.h"

namespace fascicle {
namespace {

Quad Shifted(const Quad& quad, std::int32_t first) {
  return {first + quad[0], first + quad[1], first + quad[2], first + quad[3]};
}

}  // namespace

// The mid-edge node between two nodes of the model.
std::int32_t TetModelBuilder::MiddleOf(std::int32_t i, std::int32_t j) const {
  std::size_t b = model_.bodies_.size() - 1;
  while (model_.bodies_[b].node_begin > static_cast<std::size_t>(i)) --b;
  const auto first = static_cast<std::int32_t>(model_.bodies_[b].node_begin);
  return static_cast<std::int32_t>(model_.bodies_[b].mesh_node_end) + model_.edges_[b].Between(i - first, j - first);
}

// The nodes of a region, ascending: those of the mesh and, for quadratic elements, mid-edge nodes (EdgesWithin).
std::vector<std::int32_t> TetModelBuilder::NodesOfRegion(const Region& region, const TetBody& body) const {
  const auto first = static_cast<std::int32_t>(body.node_begin);
  std::vector<std::int32_t> nodes;
  for (const std::int32_t n : region.nodes) nodes.push_back(first + n);
  if (model_.order() == ElementOrder::kHexahedralQuadratic) AddNodesOfHexahedra(region, body, nodes);
  if (model_.order() != ElementOrder::kQuadratic) return nodes;
  const TetMesh& mesh = body.source->tet().mesh;
  const auto b = static_cast<std::size_t>(&body - model_.bodies_.data());
  const std::vector<bool> within = EdgesWithin(mesh, model_.edges_[b], BoundaryTriangles(mesh), region.nodes);
  for (std::size_t edge = 0; edge < within.size(); ++edge) {
    if (within[edge]) nodes.push_back(static_cast<std::int32_t>(body.mesh_node_end + edge));
  }
  return nodes;
}

// The faces and nodes on which loads of a region act. With quadratic elements a face acts on its mid-edge nodes,
// because the corner functions integrate to zero.
LoadedRegion TetModelBuilder::LoadedRegionIn(const Region& region, const TetBody& body) const {
  const auto first = static_cast<std::int32_t>(body.node_begin);
  LoadedRegion loaded;
  loaded.nodes = NodesOfRegion(region, body);
  if (model_.order() == ElementOrder::kHexahedral) {
    for (const Quad& side : region.sides) {
      loaded.faces.push_back(LoadedSide(Shifted(side, first), model_.rest_positions_));
    }
    for (const auto& [node, volume] : VolumesOfHexahedra(region, body.source->tet().mesh)) {
      loaded.volumes[first + node] = volume;
    }
    return loaded;
  }
  if (model_.order() == ElementOrder::kHexahedralQuadratic) {
    for (const PressureFace& face : FacesOf(region, body)) loaded.faces.push_back(LoadedFace(face));
    AddPointVolumes(region, body, loaded);
    return loaded;
  }
  for (const Triangle& t : region.triangles) {
    const Triangle n = {first + t[0], first + t[1], first + t[2]};
    const Vec3& X0 = model_.rest_positions_[n[0]];
    std::array<std::int32_t, 4> nodes = {};
    for (int c = 0; c < 3; ++c) {
      nodes[c] = model_.order() == ElementOrder::kLinear ? n[c] : MiddleOf(n[c], n[(c + 1) % 3]);
    }
    loaded.faces.emplace_back(0.5 * (model_.rest_positions_[n[1]] - X0).cross(model_.rest_positions_[n[2]] - X0), 3,
                              nodes);
  }
  AddVolumes(region, body, loaded);
  return loaded;
}

// The integrals of the shape functions over the region's elements. Those of quadratic elements with straight edges are
// -V/20 at corners and V/5 at mid-edge nodes.
void TetModelBuilder::AddVolumes(const Region& region, const TetBody& body, LoadedRegion& loaded) const {
  const auto first = static_cast<std::int32_t>(body.node_begin);
  for (const std::int32_t e : region.elements) {
    const Tetrahedron& tet = body.source->tet().mesh.tetrahedra[e];
    const double volume = SignedVolume(body.source->tet().mesh, static_cast<std::size_t>(e));
    const bool is_linear = model_.order() == ElementOrder::kLinear;
    for (const std::int32_t n : tet) loaded.volumes[first + n] += is_linear ? volume / 4 : -volume / 20;
    if (is_linear) continue;
    for (const auto& [i, j] : kTetEdges) loaded.volumes[MiddleOf(first + tet[i], first + tet[j])] += volume / 5;
  }
}

void TetModelBuilder::AddLoads(const TetBody& body) {
  const Body& source = *body.source;
  for (const Load& load : source.loads) {
    if (DependsOnPositions(load)) {
      AddPositionLoad(load, body);
      model_.loads_.emplace_back();
      continue;
    }
    const auto forces = NodalForcesOf(load, LoadedRegionIn(source.regions[load.region], body));
    NodalLoad& entry = model_.loads_.emplace_back();
    for (const auto& [n, force] : forces) {
      entry.nodes.push_back(n);
      entry.forces.push_back(force);
    }
  }
}

// The faces of a region with all of their nodes.
std::vector<PressureFace> TetModelBuilder::FacesOf(const Region& region, const TetBody& body) const {
  const auto first = static_cast<std::int32_t>(body.node_begin);
  std::vector<PressureFace> faces;
  if (IsHexahedral(model_.order())) {
    for (const Quad& side : region.sides) faces.push_back(FaceOf(Shifted(side, first)));
    return faces;
  }
  for (const Triangle& t : region.triangles) {
    PressureFace& face = faces.emplace_back();
    for (int c = 0; c < 3; ++c) {
      face.nodes[c] = first + t[c];
      if (model_.order() == ElementOrder::kQuadratic) {
        face.nodes[3 + c] = MiddleOf(first + t[c], first + t[(c + 1) % 3]);
      }
    }
  }
  return faces;
}

// The mean position of a region over its area, or over its nodes if it has no faces.
MeanPosition TetModelBuilder::MeanOf(const Region& region, const TetBody& body) const {
  const LoadedRegion loaded = LoadedRegionIn(region, body);
  std::map<std::int32_t, double> weights;
  double sum = 0;
  for (const LoadedRegion::Face& face : loaded.faces) {
    for (int c = 0; c < face.count; ++c) {
      weights[face.nodes[c]] += face.share[c];
      sum += face.share[c];
    }
  }
  if (weights.empty()) {
    for (const std::int32_t n : loaded.nodes) weights[n] = 1;
    sum = static_cast<double>(loaded.nodes.size());
  }
  MeanPosition mean;
  for (const auto& [node, weight] : weights) {
    mean.nodes.push_back(node);
    mean.weights.push_back(weight / sum);
  }
  return mean;
}

void TetModelBuilder::AddPositionLoad(const Load& load, const TetBody& body) {
  const Region& region = body.source->regions[load.region];
  PositionLoads& loads = model_.position_loads_;
  if (const auto* pressure = std::get_if<Pressure>(&load.kind)) {
    loads.pressures.push_back({model_.loads_.size(), pressure->value, FacesOf(region, body)});
  }
  if (const auto* spring = std::get_if<LineSpring>(&load.kind)) {
    const TetBody& other = model_.bodies_[spring->body];
    LineSpringLoad& entry = loads.line_springs.emplace_back();
    entry.load = model_.loads_.size();
    entry.ends = {MeanOf(region, body), MeanOf(other.source->regions[spring->region], other)};
    entry.stiffness = spring->stiffness;
    entry.tension_only = spring->tension_only;
    entry.largest_scale = *std::max_element(load.scale.values.begin(), load.scale.values.end());
    entry.rest_length =
        spring->rest_length.value_or(DistanceBetween(entry.ends[0], entry.ends[1], model_.rest_positions_));
  }
  if (const auto* springs = std::get_if<Springs>(&load.kind)) {
    SpringLoad& entry = loads.springs.emplace_back();
    entry.load = model_.loads_.size();
    entry.largest_scale = *std::max_element(load.scale.values.begin(), load.scale.values.end());
    entry.entries = SpringsOnFaces(model_.order(), FacesOf(region, body), model_.rest_positions_, springs->stiffness);
    if (!entry.entries.empty()) return;
    const std::vector<std::int32_t> nodes = NodesOfRegion(region, body);
    for (const std::int32_t n : nodes) {
      entry.entries.push_back({n, n, springs->stiffness / static_cast<double>(nodes.size())});
    }
  }
}

void TetModelBuilder::AddSupports(std::int32_t body_index) {
  const TetBody& body = model_.bodies_[body_index];
  const Body& source = *body.source;
  for (const Constraint& constraint : source.constraints) {
    Support& support = model_.supports_.emplace_back();
    support.body = body_index;
    support.nodes = NodesOfRegion(source.regions[constraint.region], body);
    for (const std::int32_t n : support.nodes) {
      std::array<bool, 3> owned = {};
      for (int c = 0; c < 3; ++c) {
        owned[c] = constraint.axes[c] && model_.inverse_mass_[n][c] != 0;
        if (owned[c]) model_.inverse_mass_[n][c] = 0;
      }
      support.owned.push_back(owned);
    }
  }
}

// The surface area that each node has a share of [m^2].
std::map<std::int32_t, double> TetModelBuilder::SurfaceAreas(const TetBody& body) const {
  const auto first = static_cast<std::int32_t>(body.node_begin);
  const TetMesh& mesh = body.source->tet().mesh;
  std::map<std::int32_t, double> areas;
  if (IsHexahedral(model_.order())) {
    for (const Quad& quad : BoundaryOfHexahedra(mesh, stop_).quads) {
      const Quad side = Shifted(quad, first);
      const LoadedRegion::Face face = model_.order() == ElementOrder::kHexahedral
                                          ? LoadedSide(side, model_.rest_positions_)
                                          : LoadedFace(FaceOf(side));
      for (int c = 0; c < face.count; ++c) areas[face.nodes[c]] += face.share[c];
    }
    return areas;
  }
  for (const Triangle& t : BoundaryTriangles(mesh)) {
    const Triangle n = {first + t[0], first + t[1], first + t[2]};
    const Vec3& X0 = model_.rest_positions_[n[0]];
    const double area = 0.5 * (model_.rest_positions_[n[1]] - X0).cross(model_.rest_positions_[n[2]] - X0).norm();
    // The consistent weights of quadratic triangles are zero at corners, which could then penetrate the floor.
    const double corner = model_.order() == ElementOrder::kLinear ? 1. / 3 : 1. / 12;
    for (int c = 0; c < 3; ++c) {
      areas[n[c]] += corner * area;
      if (model_.order() == ElementOrder::kQuadratic) areas[MiddleOf(n[c], n[(c + 1) % 3])] += area / 4;
    }
  }
  return areas;
}

void TetModelBuilder::AddContactNodes(const TetBody& body) {
  const double modulus =
      std::visit([](const auto& law) { return law.BulkModulus() + 4 * law.ShearModulus() / 3; }, body.source->material);
  for (const auto& [node, area] : SurfaceAreas(body)) {
    model_.contact_nodes_.push_back({node, modulus * area * area * body.source->density / model_.mass_[node]});
  }
}

}  // namespace fascicle
