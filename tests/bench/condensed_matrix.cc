#include "condensed_matrix.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/check.h"
#include "core/materials/spd.h"
#include "core/materials/tensor_algebra.h"
#include "core/tet/points.h"

namespace fascicle::bench {
namespace {

std::size_t PlaceOf(const std::vector<std::int32_t>& sorted, std::int32_t value) {
  return std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin();
}

}  // namespace

CondensedMatrix::CondensedMatrix(const TetModel& model) : model_(model), unknown_(model.nodes(), -1) {
  FASCICLE_CHECK(model.patches().empty() || model.patches().row.empty(), "patches that are not smoothed");
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    const auto free = (model.inverse_mass()[n].array() != 0).count();
    FASCICLE_CHECK(free == 0 || free == 3, "nodes that are free or held as a whole");
    if (free == 3) unknown_[n] = free_nodes_++;
  }
  model.VisitElement([&]<class Element>(Element) { FindNeighbours<Element>(); });
  SetPattern();
}

template <class Element>
void CondensedMatrix::FindNeighbours() {
  const VolumePatches& patches = model_.patches();
  std::vector<std::set<std::int32_t>> neighbours(free_nodes_), patch_nodes(patches.size());
  const auto couple = [&](const auto& nodes) {
    for (const std::int32_t i : nodes) {
      for (const std::int32_t j : nodes) {
        if (i >= j && j >= 0) neighbours[j].insert(i);
      }
    }
  };
  for (std::size_t e = 0; e < model_.elements(); ++e) {
    auto nodes = model_.NodesOf<Element>(e);
    for (std::int32_t& node : nodes) node = unknown_[node];
    couple(nodes);
    if (patches.empty() || patches.of_element[e][0] == VolumePatches::kNone) continue;
    for (const std::int32_t patch : patches.of_element[e]) {
      for (const std::int32_t node : nodes) {
        if (node >= 0) patch_nodes[patch].insert(node);
      }
    }
  }
  for (const auto& nodes : patch_nodes) {
    couple(nodes);
    patch_nodes_.emplace_back(nodes.begin(), nodes.end());
    patch_gradients_.emplace_back(nodes.size());
  }
  for (const auto& nodes : neighbours) neighbours_.emplace_back(nodes.begin(), nodes.end());
}

// Each node's column of 3x3 blocks as three columns.
void CondensedMatrix::SetPattern() {
  column_begin_.push_back(0);
  for (std::int32_t j = 0; j < free_nodes_; ++j) {
    for (int c = 0; c < 3; ++c) {
      for (const std::int32_t i : neighbours_[j]) {
        for (int r = i == j ? c : 0; r < 3; ++r) rows_.push_back(3 * i + r);
      }
      column_begin_.push_back(static_cast<std::int32_t>(rows_.size()));
    }
  }
  values_.resize(rows_.size());
}

void CondensedMatrix::Assemble(const FibreDrive& drive, const NodalVector& x, const Changes& changes,
                               ThreadTeam& team) {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (NodalVector& gradient : patch_gradients_) std::fill(gradient.begin(), gradient.end(), Vec3::Zero());
  UpdatePatches(model_, x, team, workspace_);
  model_.VisitElement([&]<class Element>(Element) { AddElements<Element>(drive, x, changes.projection); });
  AddPatches();
  if (changes.inertia == 0) return;
  for (std::size_t n = 0; n < model_.nodes(); ++n) {
    if (unknown_[n] >= 0) {
      AddBlock(unknown_[n], unknown_[n], changes.inertia * model_.mass()[n] * Mat3::Identity());
    }
  }
}

template <class Element>
void CondensedMatrix::AddElements(const FibreDrive& drive, const NodalVector& x, double projection) {
  const VolumePatches& patches = model_.patches();
  double squares = 0;
  for (const TetGroup& group : model_.groups()) {
    std::visit(
        [&](const auto& laws) {
          for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
            const auto nodes = model_.NodesOf<Element>(e);
            const auto positions = ValuesOf<Element>(model_, e, x);
            Eigen::Matrix<double, 3 * Element::kNodes, 3 * Element::kNodes> A;
            A.setZero();
            std::array<Vec3, Element::kNodes> forces;
            forces.fill(Vec3::Zero());
            for (int q = 0; q < Element::kPoints; ++q) {
              const Mat3 F = GradientAt<Element>(model_, e, positions, q);
              const double volume = model_.rest_volume()[Element::kPoints * e + q];
              const auto& law = laws[model_.law_of()[e]];
              const FibreState fibre = FibreAt<Element>(model_, e, drive, q);
              const double pressure = PatchPressure<Element>(patches, workspace_.pressure, e, q);
              CornerValues corners;
              SetCornerForces(law.Stress(F, fibre) + pressure * Cofactor(F),
                              model_.Dm_inverse()[Element::kPoints * e + q], volume, corners);
              Element::AddCorners(corners, q, forces);
              Mat9 H = law.Tangent(F, fibre);
              AddCofactorTangent(pressure, F, H);
              if (projection > 0) H += projection * (NearestPositive(H) - H);
              const auto G = ShapeGradients<Element>(model_, e, q);
              // dF/dx of the element: G(j, a) is the derivative of F_ij with respect to component i of node a.
              Eigen::Matrix<double, 9, 3 * Element::kNodes> dF;
              dF.setZero();
              for (int a = 0; a < Element::kNodes; ++a) {
                for (int j = 0; j < 3; ++j) {
                  for (int i = 0; i < 3; ++i) dF(3 * j + i, 3 * a + i) = G(j, a);
                }
              }
              A.noalias() += dF.transpose() * (volume * H * dF);
              if (patches.empty() || patches.of_element[e][0] == VolumePatches::kNone) continue;
              const Mat3 cofactor = Cofactor(F);
              for (int a = 0; a < Element::kNodes; ++a) {
                const std::int32_t node = unknown_[nodes[a]];
                if (node < 0) continue;
                const Vec3 change = volume * (cofactor * G.col(a));
                for (int c = 0; c < Element::kPatches; ++c) {
                  const std::int32_t patch = patches.of_element[e][c];
                  patch_gradients_[patch][PlaceOf(patch_nodes_[patch], node)] += Element::PatchWeight(q, c) * change;
                }
              }
            }
            for (const Vec3& f : forces) squares += f.squaredNorm();
            for (int a = 0; a < Element::kNodes; ++a) {
              for (int b = 0; b < Element::kNodes; ++b) {
                AddBlock(unknown_[nodes[a]], unknown_[nodes[b]], A.template block<3, 3>(3 * a, 3 * b));
              }
            }
          }
        },
        group.laws);
  }
  element_force_norm_ = std::sqrt(squares);
}

void CondensedMatrix::AddPatches() {
  const VolumePatches& patches = model_.patches();
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const double slope = PatchEnergy{patches.modulus[n]}.Slope(workspace_.ratio[n]) / patches.rest_volume[n];
    const std::vector<std::int32_t>& nodes = patch_nodes_[n];
    const NodalVector& gradient = patch_gradients_[n];
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      for (std::size_t i = j; i < nodes.size(); ++i) {
        AddBlock(nodes[i], nodes[j], slope * gradient[i] * gradient[j].transpose());
      }
    }
  }
}

// Blocks above the diagonal or of supported nodes are not stored.
void CondensedMatrix::AddBlock(std::int32_t row_node, std::int32_t column_node, const Mat3& block) {
  if (column_node < 0 || row_node < column_node) return;
  const std::size_t k = PlaceOf(neighbours_[column_node], row_node);
  for (int c = 0; c < 3; ++c) {
    const std::size_t column = column_begin_[3 * column_node + c];
    if (k == 0) {
      for (int r = c; r < 3; ++r) values_[column + r - c] += block(r, c);
    } else {
      for (int r = 0; r < 3; ++r) values_[column + 3 * k - c + r] += block(r, c);
    }
  }
}

std::vector<double> CondensedMatrix::ToComponents(const NodalVector& values) const {
  std::vector<double> components(size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    for (int c = 0; c < 3 && unknown_[n] >= 0; ++c) components[3 * unknown_[n] + c] = values[n][c];
  }
  return components;
}

void CondensedMatrix::AddComponents(const std::vector<double>& components, double part, NodalVector& values) const {
  for (std::size_t n = 0; n < values.size(); ++n) {
    for (int c = 0; c < 3 && unknown_[n] >= 0; ++c) values[n][c] += part * components[3 * unknown_[n] + c];
  }
}

}  // namespace fascicle::bench
