#include "core/tet/model_builder.h"

#include <Eigen/LU>

#include "core/base/check.h"

namespace fascicle {
namespace {

// Where each of `count` numbers occurs in `targets`: places[begin[n] .. begin[n + 1]), ascending.
void Invert(std::span<const std::int32_t> targets, std::size_t count, std::vector<std::int32_t>& begin,
            std::vector<std::int32_t>& places) {
  begin.assign(count + 1, 0);
  for (const std::int32_t n : targets) {
    if (n >= 0) ++begin[n + 1];
  }
  for (std::size_t n = 0; n < count; ++n) begin[n + 1] += begin[n];
  places.resize(begin[count]);
  std::vector<std::int32_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (targets[i] >= 0) places[next[targets[i]]++] = static_cast<std::int32_t>(i);
  }
}

// Index of an element's part: 0 for the value of the whole body, k for the k-th of the others.
template <class Value>
std::int32_t PartOf(const Parts<Value>& parts, std::size_t tet) {
  return parts.of.empty() ? 0 : parts.of[tet];
}

const Material& MaterialOf(const Body& body, std::size_t tet) {
  const Parts<Material>& materials = body.tet().materials;
  const std::int32_t k = PartOf(materials, tet);
  return k == 0 ? body.material : materials.more[k - 1];
}

// The Maxwell branches of a part of a body.
const PronySeries& SeriesOf(const Body& body, std::int32_t part) {
  static const PronySeries kElastic;
  if (part == 0) return body.viscoelasticity;
  const std::vector<PronySeries>& of_parts = body.tet().viscoelasticity;
  return of_parts.empty() ? kElastic : of_parts[static_cast<std::size_t>(part) - 1];
}

// The part of the volume modulus that remains with the elements when the rest acts on patches. Up to a Poisson's ratio
// of 0.3, which does not lock, all of it. Beyond, a multiple of the stresses that may crush a single element: its shear
// modulus, with Maxwell branches the instantaneous one, and the active stress of its fibres at rest, which may be a
// hundred times larger. Quadratic elements tolerate a ten times larger multiple before they stiffen, and need it,
// because each of their points may be crushed separately. Hexahedra keep nothing: with as much as quadratic tetrahedra,
// those of 27 nodes would lose up to half of their accuracy, and their points would be crushed nearly as much.
template <class Law>
double ElementVolumeModulus(const Law& law, const PronySeries& series, ElementOrder order) {
  constexpr double kDoesNotLock = 1.5;
  const double kept = order == ElementOrder::kLinear ? 0.3 : 3;
  const double modulus = law.VolumeModulus();
  double shear = law.ShearModulus();
  if (modulus <= kDoesNotLock * (1 + 1e-12) * shear) return modulus;
  if (IsHexahedral(order)) return 0;
  double instantaneous = 1;
  for (const PronyTerm& term : series.terms) instantaneous += term.strength;
  shear *= instantaneous;
  const double active_stress = law.Stress(Mat3::Identity(), FibreState{Vec3::UnitX(), 1}).norm();
  return std::min(modulus, kept * (shear + active_stress));
}

// Whether the active stress of any law depends on the fibre's rate.
template <class Law>
bool DependsOnRate(const Law& law) {
  if constexpr (Law::kNeedsFibres) {
    const Mat3 F = Mat3::Identity();
    FibreState held{Vec3::UnitX(), 1};
    FibreState shortening = held;
    shortening.previous_stretch = 1.01;
    shortening.inverse_step = 100;
    return law.Stress(F, held) != law.Stress(F, shortening);
  } else {
    return false;
  }
}

}  // namespace

void TetModelBuilder::Build() {
  for (const Body& body : scene_.bodies) AddBody(body);
  SetInverseMass();
  for (std::size_t b = 0; b < model_.bodies_.size(); ++b) {
    AddLoads(model_.bodies_[b]);
    AddSupports(static_cast<std::int32_t>(b));
    if (!scene_.floors.empty()) AddContactNodes(model_.bodies_[b]);
  }
  AddContact();
  SetNodeUses();
  if (model_.order() == ElementOrder::kLinear) SetSmoothing();
  SetChunks();
  SetBlocks();
  DropExcessCapacity();
}

void TetModelBuilder::AddBody(const Body& body) {
  TetBody entry;
  entry.source = &body;
  // C:Edot with C = lambda I(x)I + 2 mu I, as in scene.proto Damping.
  const auto [mu, bulk] = std::visit(
      [](const auto& law) {
        return std::pair{law.ShearModulus(), law.BulkModulus()};
      },
      body.material);
  entry.damping_mu = body.damping.stiffness_proportional * mu + body.damping.viscosity;
  entry.damping_lambda = body.damping.stiffness_proportional * (bulk - 2 * mu / 3);
  entry.mass_damping = body.damping.mass_proportional;
  model_.has_mass_damping_ |= entry.mass_damping != 0;
  model_.has_strain_damping_ |= entry.HasStrainDamping();

  entry.activation = activations_;
  activations_ += 1 + body.tet().activations.more.size();

  AddNodes(body, entry);
  AddElements(body, entry);
  model_.bodies_.push_back(entry);
}

// Adds the nodes of the mesh and, for quadratic elements, a mid-edge node for every edge, in the order of MeshEdges.
void TetModelBuilder::AddNodes(const Body& body, TetBody& entry) {
  const TetMesh& mesh = body.tet().mesh;
  entry.node_begin = model_.nodes();
  model_.rest_positions_.insert(model_.rest_positions_.end(), mesh.nodes.begin(), mesh.nodes.end());
  entry.mesh_node_end = entry.node_end = model_.nodes();
  MeshEdges& edges = model_.edges_.emplace_back();
  if (model_.order() == ElementOrder::kQuadratic) {
    edges = NumberEdges(mesh, stop_);
    const std::vector<Vec3> middles = EdgeMiddles(mesh, edges);
    model_.rest_positions_.insert(model_.rest_positions_.end(), middles.begin(), middles.end());
    const auto first = static_cast<std::int32_t>(entry.mesh_node_end);
    for (std::array<std::int32_t, 6> nodes : edges.of_tetrahedra) {
      for (std::int32_t& n : nodes) n += first;
      model_.edge_nodes_.push_back(nodes);
    }
    entry.node_end = model_.nodes();
  }
  if (model_.order() == ElementOrder::kHexahedralQuadratic) AddNodesOfHexahedra(mesh, entry);
  model_.mass_.resize(entry.node_end, 0.0);
  model_.mass_damping_.resize(entry.node_end, entry.mass_damping);
}

void TetModelBuilder::AddElements(const Body& body, TetBody& entry) {
  const TetShape& shape = body.tet();
  const std::size_t count = ElementCount(shape.mesh);
  entry.tet_begin = model_.elements();
  entry.tet_end = entry.tet_begin + count;
  std::vector<LawKey> laws(count);
  for (std::size_t t = 0; t < count; ++t) laws[t] = {MaterialOf(body, t).index(), PartOf(shape.materials, t)};
  std::vector<std::int32_t> sorted(count);
  for (std::size_t t = 0; t < count; ++t) sorted[t] = static_cast<std::int32_t>(t);
  std::stable_sort(sorted.begin(), sorted.end(), [&](std::int32_t a, std::int32_t b) { return laws[a] < laws[b]; });
  SortIntoChunks(shape.mesh, entry, laws, sorted);
  // AddNodes left the higher nodes in the mesh's order.
  const auto sort = [&](auto& higher_nodes) {
    if (higher_nodes.empty()) return;
    const auto first = higher_nodes.begin() + static_cast<std::ptrdiff_t>(entry.tet_begin);
    const std::vector unsorted(first, higher_nodes.end());
    for (std::size_t i = 0; i < count; ++i) higher_nodes[entry.tet_begin + i] = unsorted[sorted[i]];
  };
  sort(model_.edge_nodes_);
  sort(model_.inner_nodes_);
  for (const std::int32_t t : sorted) {
    HeedStop();
    AddElement(body, entry, t);
  }
  AddGroups(body, entry, laws);
}

// Adds element `tet` of the body's mesh.
void TetModelBuilder::AddElement(const Body& body, const TetBody& entry, std::int32_t tet) {
  const TetShape& shape = body.tet();
  const auto shifted = [&](auto nodes) {
    for (std::int32_t& n : nodes) n += static_cast<std::int32_t>(entry.node_begin);
    return nodes;
  };
  const std::size_t e = model_.elements();
  if (IsHexahedral(model_.order())) {
    model_.hexahedra_.push_back(shifted(shape.mesh.hexahedra[tet]));
  } else {
    model_.tetrahedra_.push_back(shifted(shape.mesh.tetrahedra[tet]));
  }
  model_.source_element_.push_back(tet);
  fibres_.push_back(shape.fibres.empty() ? Vec3(Vec3::Zero()) : shape.fibres[tet]);
  if (!shape.prestretch.empty()) fibres_.back() *= shape.prestretch[tet];
  activation_of_.push_back(static_cast<std::int32_t>(entry.activation) + PartOf(shape.activations, tet));
  activation_scale_.push_back(shape.activation_scale.empty() ? 1 : shape.activation_scale[tet]);
  model_.VisitElement([&]<class Element>(Element) {
    const double volume = AddPoints<Element>(e);
    const std::array<double, Element::kNodes> shares = MassShares<Element>(e, volume);
    const auto element_nodes = model_.NodesOf<Element>(e);
    for (int a = 0; a < Element::kNodes; ++a) model_.mass_[element_nodes[a]] += body.density * shares[a];
  });
}

// The volume of an element that belongs to each of its nodes. `volume`: that of the element.
template <class Element>
std::array<double, Element::kNodes> TetModelBuilder::MassShares(std::size_t e, double volume) const {
  std::array<double, Element::kNodes> shares = {};
  if constexpr (Element::kNodes == 27) {
    // The diagonal, scaled: row sums may be negative at the corners of distorted elements.
    double sum = 0;
    for (int a = 0; a < Element::kNodes; ++a) {
      for (int q = 0; q < Element::kPoints; ++q) {
        shares[a] += rest_volume_[Element::kPoints * e + q] * Element::Value(q, a) * Element::Value(q, a);
      }
      sum += shares[a];
    }
    for (double& share : shares) share *= volume / sum;
  } else if constexpr (Element::kIsHexahedron) {
    for (int a = 0; a < Element::kNodes; ++a) {
      for (int q = 0; q < Element::kPoints; ++q) {
        shares[a] += rest_volume_[Element::kPoints * e + q] * Element::Value(q, a);
      }
    }
  } else {
    for (int a = 0; a < Element::kNodes; ++a) shares[a] = volume * Element::kMassShare[a];
  }
  return shares;
}

// Groups the body's elements, which are sorted, by the kind of their law.
void TetModelBuilder::AddGroups(const Body& body, const TetBody& entry, std::span<const LawKey> laws) {
  const auto kind = [&](std::size_t e) { return laws[model_.source_element_[e]].first; };
  model_.law_of_.resize(entry.tet_end);
  for (std::size_t begin = entry.tet_begin; begin < entry.tet_end;) {
    std::size_t end = begin;
    while (end < entry.tet_end && kind(end) == kind(begin)) ++end;
    TetGroup& group = model_.groups_.emplace_back();
    group.body = model_.bodies_.size();
    group.tet_begin = begin;
    group.tet_end = end;
    FillGroup(body, group);
    begin = end;
  }
}

// Fills in the laws of a group, and the patches that receive part of its elements' volume modulus.
void TetModelBuilder::FillGroup(const Body& body, TetGroup& group) {
  const bool nodal = scene_.tet.volume == VolumeForm::kNodal;
  std::vector<double> given(group.tet_end - group.tet_begin, 0.0);
  const auto fill = [&]<class Law>(const Law&) {
    std::map<const Material*, std::int32_t> places;
    std::vector<Law> laws, branch_laws;
    std::vector<PronySeries> series;
    bool viscoelastic = false;
    std::vector<double> given_by_law;
    for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
      HeedStop();
      const Material& material = MaterialOf(body, model_.source_element_[e]);
      const auto [place, is_new] = places.try_emplace(&material, static_cast<std::int32_t>(laws.size()));
      if (is_new) {
        const Law& law = std::get<Law>(material);
        const double whole = law.VolumeModulus();
        series.push_back(SeriesOf(body, PartOf(body.tet().materials, model_.source_element_[e])));
        const double kept = nodal ? ElementVolumeModulus(law, series.back(), model_.order()) : whole;
        laws.push_back(law.WithVolumeModulus(kept));
        branch_laws.push_back(law.WithVolumeModulus(0));
        viscoelastic |= !series.back().terms.empty();
        given_by_law.push_back(whole - kept);
        model_.depends_on_rate_ |= DependsOnRate(law);
      }
      model_.law_of_[e] = place->second;
      given[e - group.tet_begin] = given_by_law[place->second];
    }
    group.laws = std::move(laws);
    if (!viscoelastic) return;
    group.series = std::move(series);
    group.branch_laws = std::move(branch_laws);
  };
  std::visit(fill, MaterialOf(body, model_.source_element_[group.tet_begin]));
  AddPatches(group, given);
}

// Dm^-1 and V at the points of an element; returns the sum of V.
template <class Element>
double TetModelBuilder::AddPoints(std::size_t tet) {
  const auto element_nodes = model_.NodesOf<Element>(tet);
  std::array<Vec3, Element::kNodes> X;
  for (int a = 0; a < Element::kNodes; ++a) X[a] = model_.rest_positions_[element_nodes[a]];
  double sum = 0;
  for (int q = 0; q < Element::kPoints; ++q) {
    const Mat3 Dm = EdgeMatrix(Element::Corners(X, q));
    const double volume = Element::PointWeight(q) * Dm.determinant() / 6;
    FASCICLE_CHECK(volume > 0, "an element of a checked mesh has positive volume");
    Dm_inverse_.push_back(Dm.inverse());
    rest_volume_.push_back(volume);
    sum += volume;
  }
  return sum;
}

void TetModelBuilder::AddPatches(const TetGroup& group, std::span<const double> given) {
  model_.patches_.of_element.resize(
      group.tet_end, {VolumePatches::kNone, VolumePatches::kNone, VolumePatches::kNone, VolumePatches::kNone});
  const bool has_own = IsHexahedral(model_.order());
  const int patches_of_each = model_.VisitElement([]<class Element>(Element) { return Element::kPatches; });
  std::map<std::int32_t, std::int32_t> patch_of_owner;  // by node, or by hexahedron and number
  const std::size_t first = model_.patches_.size();
  for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
    HeedStop();
    const double modulus = given[e - group.tet_begin];
    if (modulus == 0) continue;
    for (int c = 0; c < patches_of_each; ++c) {
      const std::int32_t owner = has_own ? static_cast<std::int32_t>(4 * e + c) : model_.tetrahedra_[e][c];
      const auto [place, is_new] = patch_of_owner.try_emplace(owner, static_cast<std::int32_t>(model_.patches_.size()));
      if (is_new) {
        model_.patches_.rest_volume.push_back(0);
        model_.patches_.modulus.push_back(0);
      }
      const std::int32_t patch = place->second;
      model_.patches_.of_element[e][c] = patch;
      const double volume = model_.VisitElement([&]<class Element>(Element) {
        double sum = 0;
        for (int q = 0; q < Element::kPoints; ++q) {
          sum += Element::PatchWeight(q, c) * rest_volume_[Element::kPoints * e + q];
        }
        return sum;
      });
      model_.patches_.rest_volume[patch] += volume;
      model_.patches_.modulus[patch] += volume * modulus;
    }
  }
  for (std::size_t n = first; n < model_.patches_.size(); ++n)
    model_.patches_.modulus[n] /= model_.patches_.rest_volume[n];
}

// Sets the rows of W: theta from the corners' patches to the mean of each element, and back, weighted by the elements'
// volumes.
void TetModelBuilder::SetSmoothing() {
  std::vector<std::map<std::int32_t, double>> rows(model_.patches_.size());
  for (std::size_t e = 0; e < model_.elements(); ++e) {
    HeedStop();
    const VolumePatches::Corners& corners = model_.patches_.of_element[e];
    if (corners[0] == VolumePatches::kNone) continue;
    for (const std::int32_t n : corners) {
      for (const std::int32_t m : corners) rows[n][m] += rest_volume_[e] / 16 / model_.patches_.rest_volume[n];
    }
  }
  model_.patches_.row.push_back(0);
  for (const auto& row : rows) {
    HeedStop();
    for (const auto& [m, weight] : row) {
      model_.patches_.neighbour.push_back(m);
      model_.patches_.weight.push_back(weight);
    }
    model_.patches_.row.push_back(static_cast<std::int32_t>(model_.patches_.neighbour.size()));
  }
}

void TetModelBuilder::SetInverseMass() {
  model_.inverse_mass_.resize(model_.nodes());
  for (std::size_t n = 0; n < model_.nodes(); ++n) model_.inverse_mass_[n].setConstant(1 / model_.mass_[n]);
}

void TetModelBuilder::SetNodeUses() {
  std::vector<std::int32_t> element_nodes;
  model_.VisitElement([&]<class Element>(Element) {
    for (std::size_t e = 0; e < model_.elements(); ++e) {
      for (const std::int32_t n : model_.NodesOf<Element>(e)) element_nodes.push_back(n);
    }
  });
  HeedStop();
  Invert(element_nodes, model_.nodes(), model_.node_use_begin_, model_.node_uses_);
  HeedStop();
}

// Vectors that grew element by element have excess capacity.
void TetModelBuilder::DropExcessCapacity() {
  const auto shrink = [](auto&... vectors) { (vectors.shrink_to_fit(), ...); };
  shrink(model_.rest_positions_, model_.tetrahedra_, model_.hexahedra_, model_.edge_nodes_, model_.inner_nodes_,
         model_.source_element_, model_.law_of_, model_.mass_, model_.mass_damping_);
  VolumePatches& patches = model_.patches_;
  shrink(patches.of_element, patches.rest_volume, patches.modulus, patches.row, patches.neighbour, patches.weight);
  ElementChunks& chunks = model_.chunks_;
  shrink(chunks.chunks, chunks.nodes, chunks.local, chunks.slot, chunks.patch, chunks.element_patch);
}

}  // namespace fascicle
