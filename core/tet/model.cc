#include "core/tet/model.h"

#include "core/tet/model_builder.h"

namespace fascicle {

TetModel::TetModel(const Scene& scene, std::stop_token stop) : scene_(&scene) {
  VisitElement([this]<class Element>(Element) {
    nodes_per_element_ = Element::kNodes;
    points_per_element_ = Element::kPoints;
  });
  TetModelBuilder(scene, *this, std::move(stop)).Build();
}

double TetModel::ActivationOf(std::size_t tet, std::span<const double> activations) const {
  const std::size_t slot = chunks_.slot[tet];
  return VisitBlocks([&](const auto& arrays) {
    const auto& fibres = arrays.fibres[slot / kBlock];
    return activations[fibres.activation[slot % kBlock]] * static_cast<double>(fibres.activation_scale[slot % kBlock]);
  });
}

Mat3 TetModel::DmInverses::operator[](std::size_t point) const {
  const std::size_t points = model.points_per_element();
  const std::size_t slot = model.chunks_.slot[point / points];
  return model.VisitBlocks([&](const auto& arrays) {
    const auto& rest = arrays.points[points * (slot / kBlock) + point % points];
    Mat3 Dm_inverse;
    for (int k = 0; k < 9; ++k) Dm_inverse.data()[k] = rest.Dm_inverse[k][slot % kBlock];
    return Dm_inverse;
  });
}

double TetModel::RestVolumes::operator[](std::size_t point) const {
  const std::size_t points = model.points_per_element();
  const std::size_t slot = model.chunks_.slot[point / points];
  return model.VisitBlocks([&](const auto& arrays) {
    return static_cast<double>(arrays.points[points * (slot / kBlock) + point % points].volume[slot % kBlock]);
  });
}

Vec3 TetModel::Fibres::operator[](std::size_t tet) const {
  const std::size_t slot = model.chunks_.slot[tet];
  return model.VisitBlocks([&](const auto& arrays) {
    const auto& direction = arrays.fibres[slot / kBlock].direction;
    return Vec3(direction[0][slot % kBlock], direction[1][slot % kBlock], direction[2][slot % kBlock]);
  });
}

namespace {

// Adds the initial values of a body's nodes: of all, or of those of its mesh only.
void AddInitial(const std::vector<Vec3>& values, const TetBody& body, const MeshEdges& edges, NodalVector& sum) {
  if (values.empty()) return;
  for (std::size_t n = 0; n < values.size(); ++n) sum[body.node_begin + n] += values[n];
  if (values.size() == body.node_end - body.node_begin) return;
  for (std::size_t edge = 0; edge < edges.ends.size(); ++edge) {
    const auto& [i, j] = edges.ends[edge];
    sum[body.mesh_node_end + edge] += 0.5 * (values[i] + values[j]);
  }
}

}  // namespace

NodalVector TetModel::InitialPositions() const {
  NodalVector x = rest_positions_;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    AddInitial(bodies_[b].source->tet().initial_displacement, bodies_[b], edges_[b], x);
  }
  return x;
}

NodalVector TetModel::InitialVelocities() const {
  NodalVector v(nodes(), Vec3::Zero());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    AddInitial(bodies_[b].source->tet().initial_velocity, bodies_[b], edges_[b], v);
  }
  return v;
}

double TetModel::PrestretchOf(std::size_t tet) const {
  const auto body = std::upper_bound(bodies_.begin(), bodies_.end(), tet,
                                     [](std::size_t t, const TetBody& b) { return t < b.tet_end; });
  const std::vector<double>& prestretch = body->source->tet().prestretch;
  return prestretch.empty() ? 1 : prestretch[static_cast<std::size_t>(source_element_[tet])];
}

}  // namespace fascicle
