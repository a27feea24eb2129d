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

}  // namespace fascicle
