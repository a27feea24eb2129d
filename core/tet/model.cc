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

NodalVector TetModel::InitialPositions() const {
  NodalVector x = rest_positions_;
  for (const TetBody& body : bodies_) {
    const std::vector<Vec3>& displacement = body.source->tet().initial_displacement;
    if (displacement.empty()) continue;
    for (std::size_t n = 0; n < displacement.size(); ++n) x[body.node_begin + n] += displacement[n];
    if (order() == ElementOrder::kHexahedralQuadratic) PlaceInTheMiddle(body, x);
    if (order() != ElementOrder::kQuadratic) continue;
    for (std::size_t e = body.tet_begin; e < body.tet_end; ++e) {
      for (int k = 0; k < 6; ++k) {
        const auto& [i, j] = kTetEdges[k];
        x[edge_nodes_[e][k]] = 0.5 * (x[tetrahedra_[e][i]] + x[tetrahedra_[e][j]]);
      }
    }
  }
  return x;
}

// Moves the higher nodes of a body to the middle of the corners between which they lie.
void TetModel::PlaceInTheMiddle(const TetBody& body, NodalVector& x) const {
  ForHigherNodes(body, [&](std::int32_t node, std::span<const std::int32_t> corners) {
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t corner : corners) sum += x[corner];
    x[node] = sum / static_cast<double>(corners.size());
  });
}

double TetModel::PrestretchOf(std::size_t tet) const {
  const auto body = std::upper_bound(bodies_.begin(), bodies_.end(), tet,
                                     [](std::size_t t, const TetBody& b) { return t < b.tet_end; });
  const std::vector<double>& prestretch = body->source->tet().prestretch;
  return prestretch.empty() ? 1 : prestretch[static_cast<std::size_t>(source_element_[tet])];
}

}  // namespace fascicle
