#ifndef FASCICLE_CORE_TET_MODEL_H_
#define FASCICLE_CORE_TET_MODEL_H_

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <stop_token>
#include <utility>
#include <variant>
#include <vector>

#include "core/geometry/mesh_edges.h"
#include "core/linalg/nodal_vector.h"
#include "core/scene/nodal_forces.h"
#include "core/scene/scene.h"
#include "core/tet/contact_model.h"
#include "core/tet/element.h"
#include "core/tet/element_blocks.h"
#include "core/tet/position_loads.h"
#include "core/tet/volume_patches.h"

namespace fascicle {

// Index nodes of an element * element + node: one node of one element.
using ElementNodeIndex = std::int32_t;

// Laws of one kind: std::variant<std::vector<LinearElastic>, ...>.
template <class... Laws>
std::variant<std::vector<Laws>...> LawTableOf(const std::variant<Laws...>&);
using LawTable = decltype(LawTableOf(std::declval<Material>()));

// A body's ranges in the model's arrays. Elements, tetrahedra or hexahedra, are counted by tet_begin and tet_end.
// Nodes: those of its mesh in their order, then the higher nodes of its elements.
struct TetBody {
  const Body* source = nullptr;
  std::size_t node_begin = 0, node_end = 0;
  std::size_t mesh_node_end = 0;
  std::size_t tet_begin = 0, tet_end = 0;
  std::size_t activation = 0;  // index of the body's own one in Controls::activations
  // Viscous stress S_v = 2 damping_mu Edot + damping_lambda tr(Edot) I [Pa s].
  double damping_mu = 0, damping_lambda = 0;
  double mass_damping = 0;  // [1/s]

  bool HasStrainDamping() const { return damping_mu != 0 || damping_lambda != 0; }
};

// Elements of one body whose laws are of the same kind, so that a loop over them can be compiled for that kind.
struct TetGroup {
  std::size_t body = 0;
  std::size_t tet_begin = 0, tet_end = 0;
  LawTable laws;  // the law of an element is laws[law_of()[element]]
  // For each law: its Maxwell branches, and the law without the volume term, which they follow. Empty if all of them
  // are elastic.
  std::vector<PronySeries> series;
  LawTable branch_laws;
};

// A load as nodal forces at scale 1; without nodes if it is one of TetModel::position_loads().
struct NodalLoad {
  std::vector<std::int32_t> nodes;  // ascending
  std::vector<Vec3> forces;         // [N]
};

// A region with prescribed motion.
struct Support {
  std::int32_t body = 0;
  std::vector<std::int32_t> nodes;  // ascending
  // The components of each node that belong to this support. A component prescribed by two supports belongs to the
  // first.
  std::vector<std::array<bool, 3>> owned;
};

// A surface node and its contact stiffness [N/m].
struct ContactNode {
  std::int32_t node = 0;
  double stiffness = 0;
};

// A scene prepared for stepping: nodes and elements of all bodies in common arrays, and everything that stays constant.
// Indices count through all bodies. The elements of a body are sorted by kind of law, then by law, and within a law so
// that neighbours in space are neighbours in memory. Immutable; may be shared between threads.
class TetModel {
 public:
  // CheckScene must have accepted the scene, which must outlive the model. Throws Stopped after a request of `stop`.
  explicit TetModel(const Scene& scene, std::stop_token stop = {});

  const Scene& scene() const { return *scene_; }
  const std::vector<TetBody>& bodies() const { return bodies_; }
  std::size_t nodes() const { return rest_positions_.size(); }
  std::size_t elements() const { return source_element_.size(); }

  const NodalVector& rest_positions() const { return rest_positions_; }  // X [m]
  // X plus the bodies' initial displacements [m], and their initial velocities [m/s]. At mid-edge nodes that have none
  // of their own, means of those at the ends of the edge.
  NodalVector InitialPositions() const;
  NodalVector InitialVelocities() const;
  const std::vector<Tetrahedron>& corners() const { return tetrahedra_; }  // of tetrahedra; empty for hexahedra
  ElementOrder order() const { return scene_->tet.element; }
  // Calls visitor(an element of the model's type): LinearElement, QuadraticElement, HexahedralElement or
  // HexahedralQuadraticElement.
  template <class Visitor>
  decltype(auto) VisitElement(const Visitor& visitor) const {
    switch (order()) {
      case ElementOrder::kLinear:
        return visitor(LinearElement{});
      case ElementOrder::kQuadratic:
        return visitor(QuadraticElement{});
      case ElementOrder::kHexahedral:
        return visitor(HexahedralElement{});
      case ElementOrder::kHexahedralQuadratic:
        break;
    }
    return visitor(HexahedralQuadraticElement{});
  }
  // The nodes of an element: its corners in the order of Tetrahedron or Hexahedron, then the higher nodes.
  template <class Element>
  std::array<std::int32_t, Element::kNodes> NodesOf(std::size_t e) const {
    std::array<std::int32_t, Element::kNodes> nodes;
    [[maybe_unused]] const auto higher = [&] {
      if constexpr (Element::kIsHexahedron) {
        return std::copy(hexahedra_[e].begin(), hexahedra_[e].end(), nodes.begin());
      } else {
        return std::copy(tetrahedra_[e].begin(), tetrahedra_[e].end(), nodes.begin());
      }
    }();
    if constexpr (Element::kNodes == 10) std::copy(edge_nodes_[e].begin(), edge_nodes_[e].end(), higher);
    if constexpr (Element::kNodes == 27) std::copy(inner_nodes_[e].begin(), inner_nodes_[e].end(), higher);
    return nodes;
  }
  // Calls visit(node, corners) for each higher node of a body: a mid-edge node, or one of a side or the inside of a
  // hexahedron. `corners`: the nodes between which it lies, as a span.
  template <class Visit>
  void ForHigherNodes(const TetBody& body, const Visit& visit) const {
    VisitElement([&]<class Element>(Element) {
      std::vector<bool> seen(body.node_end - body.mesh_node_end, false);
      for (std::size_t e = body.tet_begin; e < body.tet_end && !seen.empty(); ++e) {
        const auto nodes = NodesOf<Element>(e);
        for (int a = Element::kCorners; a < Element::kNodes; ++a) {
          const std::size_t n = static_cast<std::size_t>(nodes[a]) - body.mesh_node_end;
          if (seen[n]) continue;
          seen[n] = true;
          const Parents parents = ParentsOf<Element>(a);
          std::array<std::int32_t, 8> corners;
          for (int i = 0; i < parents.count; ++i) corners[i] = nodes[parents.corners[i]];
          visit(nodes[a], std::span<const std::int32_t>(corners.data(), parents.count));
        }
      }
    });
  }
  // The edges of a body's mesh: its mid-edge nodes are mesh_node_end + their numbers. Empty unless elements are
  // quadratic.
  const MeshEdges& edges(std::size_t body) const { return edges_[body]; }
  int nodes_per_element() const { return nodes_per_element_; }
  int points_per_element() const { return points_per_element_; }
  const std::vector<TetGroup>& groups() const { return groups_; }
  const std::vector<std::int32_t>& law_of() const { return law_of_; }
  // Number of each element in its body's mesh.
  const std::vector<std::int32_t>& source_element() const { return source_element_; }
  const VolumePatches& patches() const { return patches_; }

  // The activation of an element: its own one of Controls::activations times its factor.
  double ActivationOf(std::size_t tet, std::span<const double> activations) const;
  // The elements in the layout of the loops over them.
  const ElementChunks& chunks() const { return chunks_; }
  template <class S>
  const BlockArrays<S>& blocks() const {
    return std::get<BlockArrays<S>>(blocks_);
  }
  // Calls visitor(blocks()).
  template <class Visitor>
  decltype(auto) VisitBlocks(const Visitor& visitor) const {
    return std::visit(visitor, blocks_);
  }

  // For point q of an element, at index points of an element * element + q: Dm^-1 [1/m], and its volume V [m^3]. These
  // and the fibres are read from the blocks one at a time.
  struct DmInverses {
    const TetModel& model;
    Mat3 operator[](std::size_t point) const;
  };
  struct RestVolumes {
    const TetModel& model;
    double operator[](std::size_t point) const;
  };
  struct Fibres {
    const TetModel& model;
    Vec3 operator[](std::size_t tet) const;
  };
  DmInverses Dm_inverse() const { return {*this}; }
  RestVolumes rest_volume() const { return {*this}; }
  Fibres fibres() const { return {*this}; }  // a0 times the prestretch; zero without fibres
  // The fibres' stretch at rest [1].
  double PrestretchOf(std::size_t tet) const;
  // The integral of the weight of an element's c-th patch over the element at rest [m^3].
  template <class Element>
  double CornerVolume(std::size_t tet, int c) const {
    double volume = 0;
    for (int q = 0; q < Element::kPoints; ++q) {
      volume += Element::PatchWeight(q, c) * rest_volume()[Element::kPoints * tet + q];
    }
    return volume;
  }
  // Lumped: see Element::kMassShare; of hexahedra, row sums or the scaled diagonal, which are the same if their sides
  // are flat and parallel [kg].
  const std::vector<double>& mass() const { return mass_; }
  // 1/m [1/kg]; zero for prescribed components.
  const NodalVector& inverse_mass() const { return inverse_mass_; }
  // Rayleigh damping of each node: mass_damping of its body [1/s].
  const std::vector<double>& mass_damping() const { return mass_damping_; }

  // Bm3 = -V Dm^-T, so that [f1 f2 f3] = P Bm3 [Teran 2003, 4.1].
  Mat3 Bm3(std::size_t point) const { return -rest_volume()[point] * Dm_inverse()[point].transpose(); }

  // The occurrences of node n in elements: node_uses()[node_use_begin()[n] .. node_use_begin()[n + 1]), ascending.
  const std::vector<std::int32_t>& node_use_begin() const { return node_use_begin_; }
  const std::vector<ElementNodeIndex>& node_uses() const { return node_uses_; }

  const std::vector<NodalLoad>& loads() const { return loads_; }
  const PositionLoads& position_loads() const { return position_loads_; }
  const std::vector<Support>& supports() const { return supports_; }
  // Nodes that may touch floors, in ascending order; empty without floors. The contact stiffness of a node is that of
  // the layer of elements above it: M A / h, with M the longitudinal modulus of its body's material, A the node's share
  // of the surface and h = mass / (density A). So contact does not reduce the stable step below that of the elements,
  // and the penetration depth decreases with the element size.
  const std::vector<ContactNode>& contact_nodes() const { return contact_nodes_; }
  // What may touch rigid bodies; empty without any.
  const ContactModel& contact() const { return contact_; }
  bool has_gravity() const { return scene_->gravity.acceleration != Vec3::Zero(); }
  bool has_damping() const { return has_mass_damping_ || has_strain_damping_; }
  bool has_mass_damping() const { return has_mass_damping_; }
  bool has_strain_damping() const { return has_strain_damping_; }
  // Whether any law depends on the rate of its fibres.
  bool depends_on_rate() const { return depends_on_rate_; }
  // Number of points of viscoelastic blocks, and of numbers that the state has of each: see branches.h.
  std::size_t branch_points() const { return branch_points_; }
  std::size_t branch_numbers() const { return (2 + most_branches_) * kBranchTensor; }

 private:
  friend class TetModelBuilder;

  void AddInitial(const std::vector<Vec3>& values, const TetBody& body, NodalVector& sum) const;

  const Scene* scene_;
  std::vector<TetBody> bodies_;
  std::vector<TetGroup> groups_;
  NodalVector rest_positions_;
  int nodes_per_element_ = 0, points_per_element_ = 0;
  std::vector<Tetrahedron> tetrahedra_;                    // for both kinds of tetrahedra
  std::vector<Hexahedron> hexahedra_;                      // for both kinds of hexahedra
  std::vector<std::array<std::int32_t, 6>> edge_nodes_;    // for quadratic elements
  std::vector<std::array<std::int32_t, 19>> inner_nodes_;  // for quadratic hexahedra: of edges, sides and centre
  std::vector<MeshEdges> edges_;                           // of each body
  std::vector<std::int32_t> source_element_;
  std::vector<std::int32_t> law_of_;
  VolumePatches patches_;
  ElementChunks chunks_;
  std::variant<BlockArrays<double>, BlockArrays<float>> blocks_;
  std::vector<double> mass_;
  NodalVector inverse_mass_;
  std::vector<double> mass_damping_;
  std::vector<std::int32_t> node_use_begin_;
  std::vector<ElementNodeIndex> node_uses_;
  std::vector<NodalLoad> loads_;
  PositionLoads position_loads_;
  std::vector<Support> supports_;
  std::vector<ContactNode> contact_nodes_;
  ContactModel contact_;
  bool has_mass_damping_ = false;
  bool has_strain_damping_ = false;
  bool depends_on_rate_ = false;
  std::size_t branch_points_ = 0, most_branches_ = 0;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_MODEL_H_
