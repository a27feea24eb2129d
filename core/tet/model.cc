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

// Adds the initial values of a body's nodes: of all, or of those of its mesh; higher nodes then take the mean of their
// corners.
void TetModel::AddInitial(const std::vector<Vec3>& values, const TetBody& body, NodalVector& sum) const {
  for (std::size_t n = 0; n < values.size(); ++n) sum[body.node_begin + n] += values[n];
  if (values.empty() || values.size() == body.node_end - body.node_begin) return;
  ForHigherNodes(body, [&](std::int32_t node, std::span<const std::int32_t> corners) {
    Vec3 mean = Vec3::Zero();
    for (const std::int32_t corner : corners) mean += values[static_cast<std::size_t>(corner) - body.node_begin];
    sum[node] += mean / static_cast<double>(corners.size());
  });
}

NodalVector TetModel::InitialPositions() const {
  NodalVector x = rest_positions_;
  for (const TetBody& body : bodies_) AddInitial(body.source->tet().initial_displacement, body, x);
  return x;
}

NodalVector TetModel::InitialVelocities() const {
  NodalVector v(nodes(), Vec3::Zero());
  for (const TetBody& body : bodies_) AddInitial(body.source->tet().initial_velocity, body, v);
  return v;
}

double TetModel::PrestretchOf(std::size_t tet) const {
  const auto body = std::upper_bound(bodies_.begin(), bodies_.end(), tet,
                                     [](std::size_t t, const TetBody& b) { return t < b.tet_end; });
  const std::vector<double>& prestretch = body->source->tet().prestretch;
  return prestretch.empty() ? 1 : prestretch[static_cast<std::size_t>(source_element_[tet])];
}

}  // namespace fascicle
