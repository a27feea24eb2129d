#include "core/tet/model.h"

#include <Eigen/LU>
#include <set>
#include <tuple>

#include "core/base/check.h"
#include "core/tet/chunk_order.h"

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

// The part of the volume modulus that remains with the elements when the rest acts on patches. Up to a Poisson's ratio
// of 0.3, which does not lock, all of it. Beyond, a multiple of the stresses that may crush a single element: its shear
// modulus and the active stress of its fibres at rest, which may be a hundred times larger. Quadratic elements tolerate
// a ten times larger multiple before they stiffen, and need it, because each of their points may be crushed separately.
template <class Law>
double ElementVolumeModulus(const Law& law, ElementOrder order) {
  constexpr double kDoesNotLock = 1.5;
  const double kept = order == ElementOrder::kLinear ? 0.3 : 3;
  const double modulus = law.VolumeModulus(), shear = law.ShearModulus();
  if (modulus <= kDoesNotLock * (1 + 1e-12) * shear) return modulus;
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

TetModel::TetModel(const Scene& scene, std::stop_token stop) : scene_(&scene) {
  building_.stop = std::move(stop);
  for (const Body& body : scene.bodies) AddBody(body);
  inverse_mass_.resize(nodes());
  for (std::size_t n = 0; n < nodes(); ++n) inverse_mass_[n].setConstant(1 / mass_[n]);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    AddLoads(*bodies_[b].source, bodies_[b]);
    AddSupports(*bodies_[b].source, static_cast<std::int32_t>(b));
    if (!scene.floors.empty()) AddContactNodes(bodies_[b]);
  }
  std::vector<std::int32_t> element_nodes;
  VisitElement([&]<class Element>(Element) {
    for (std::size_t e = 0; e < tetrahedra(); ++e) {
      for (const std::int32_t n : NodesOf<Element>(e)) element_nodes.push_back(n);
    }
  });
  HeedStop();
  Invert(element_nodes, nodes(), node_use_begin_, node_uses_);
  HeedStop();
  if (order() == ElementOrder::kLinear) SetSmoothing();
  SetChunks();
  if (scene.tet.precision == Precision::kSingle) {
    SetBlocks<float>();
  } else {
    SetBlocks<double>();
  }
  building_ = {};
  // Vectors that grew element by element have excess capacity.
  const auto shrink = [](auto&... vectors) { (vectors.shrink_to_fit(), ...); };
  shrink(rest_positions_, tetrahedra_, edge_nodes_, source_tetrahedron_, law_of_, mass_, mass_damping_);
  shrink(patches_.of_element, patches_.rest_volume, patches_.modulus, patches_.row, patches_.neighbour,
         patches_.weight);
  shrink(chunks_.chunks, chunks_.nodes, chunks_.local, chunks_.slot, chunks_.patch);
}

void TetModel::AddBody(const Body& body) {
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
  has_mass_damping_ |= entry.mass_damping != 0;
  has_strain_damping_ |= entry.HasStrainDamping();

  entry.activation = activations_;
  activations_ += 1 + body.tet().activations.more.size();

  AddNodes(body, entry);
  AddElements(body, entry);
  bodies_.push_back(entry);
}

// Adds the nodes of the mesh and, for quadratic elements, a mid-edge node for every edge, in the order in which
// elements first refer to them.
void TetModel::AddNodes(const Body& body, TetBody& entry) {
  const TetMesh& mesh = body.tet().mesh;
  entry.node_begin = nodes();
  rest_positions_.insert(rest_positions_.end(), mesh.nodes.begin(), mesh.nodes.end());
  entry.mesh_node_end = entry.node_end = nodes();
  if (order() == ElementOrder::kQuadratic) {
    const auto first = static_cast<std::int32_t>(entry.node_begin);
    for (const Tetrahedron& tet : mesh.tetrahedra) {
      HeedStop();
      std::array<std::int32_t, 6>& edges = edge_nodes_.emplace_back();
      for (int k = 0; k < 6; ++k) {
        const std::int32_t i = first + tet[kTetEdges[k][0]], j = first + tet[kTetEdges[k][1]];
        const auto [place, is_new] =
            building_.middles.try_emplace(std::minmax(i, j), static_cast<std::int32_t>(nodes()));
        if (is_new) rest_positions_.push_back(0.5 * (rest_positions_[i] + rest_positions_[j]));
        edges[k] = place->second;
      }
    }
    for (const CurvedEdge& edge : mesh.curved_edges) {
      const std::int32_t i = first + edge.ends[0], j = first + edge.ends[1];
      rest_positions_[building_.middles.at(std::minmax(i, j))] = edge.middle;
    }
    entry.node_end = nodes();
  }
  mass_.resize(entry.node_end, 0.0);
  mass_damping_.resize(entry.node_end, entry.mass_damping);
}

// Divides the elements of each law, which are contiguous already, into chunks.
template <class LawOf>
void TetModel::SortIntoChunks(const TetMesh& mesh, const TetBody& entry, const LawOf& law,
                              std::span<std::int32_t> sorted) {
  std::vector<Vec3> middles;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) middles.push_back(Centroid(mesh, t));
  std::vector<std::size_t> last_count(entry.node_end - entry.node_begin, 0);
  std::size_t counts = 0;
  const auto count_nodes = [&](std::span<const std::int32_t> elements) {
    HeedStop();
    ++counts;
    std::size_t nodes = 0;
    const auto see = [&](std::size_t n) {
      nodes += last_count[n] != counts;
      last_count[n] = counts;
    };
    for (const std::int32_t t : elements) {
      for (const std::int32_t n : mesh.tetrahedra[t]) see(n);
      if (edge_nodes_.empty()) continue;
      for (const std::int32_t n : edge_nodes_[entry.tet_begin + t]) see(n - entry.node_begin);
    }
    return nodes;
  };
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin;
    while (end < sorted.size() && law(sorted[end]) == law(sorted[begin])) ++end;
    for (const std::size_t chunk : CutIntoChunks(sorted.subspan(begin, end - begin), middles, count_nodes)) {
      building_.chunk_ends.push_back(entry.tet_begin + begin + chunk);
    }
    begin = end;
  }
}

void TetModel::AddElements(const Body& body, TetBody& entry) {
  const TetShape& shape = body.tet();
  const std::size_t count = shape.mesh.tetrahedra.size();
  entry.tet_begin = tetrahedra();
  entry.tet_end = entry.tet_begin + count;
  std::vector<std::size_t> kinds(count);
  for (std::size_t t = 0; t < count; ++t) kinds[t] = MaterialOf(body, t).index();
  const auto law = [&](std::int32_t t) { return std::pair{kinds[t], PartOf(shape.materials, t)}; };
  std::vector<std::int32_t> sorted(count);
  for (std::size_t t = 0; t < count; ++t) sorted[t] = static_cast<std::int32_t>(t);
  std::stable_sort(sorted.begin(), sorted.end(), [&](std::int32_t a, std::int32_t b) { return law(a) < law(b); });
  SortIntoChunks(shape.mesh, entry, law, sorted);
  // AddNodes left the edges in the mesh's order.
  if (!edge_nodes_.empty()) {
    const std::vector<std::array<std::int32_t, 6>> edges(
        edge_nodes_.begin() + static_cast<std::ptrdiff_t>(entry.tet_begin), edge_nodes_.end());
    for (std::size_t i = 0; i < count; ++i) edge_nodes_[entry.tet_begin + i] = edges[sorted[i]];
  }

  for (const std::int32_t t : sorted) {
    HeedStop();
    Tetrahedron shifted;
    for (int c = 0; c < 4; ++c) {
      shifted[c] = shape.mesh.tetrahedra[t][c] + static_cast<std::int32_t>(entry.node_begin);
    }
    const std::size_t e = tetrahedra();
    tetrahedra_.push_back(shifted);
    source_tetrahedron_.push_back(t);
    building_.fibres.push_back(shape.fibres.empty() ? Vec3(Vec3::Zero()) : shape.fibres[t]);
    building_.activation_of.push_back(static_cast<std::int32_t>(entry.activation) + PartOf(shape.activations, t));
    building_.activation_scale.push_back(shape.activation_scale.empty() ? 1 : shape.activation_scale[t]);
    VisitElement([&]<class Element>(Element) {
      const auto element_nodes = NodesOf<Element>(e);
      const double volume = AddPoints<Element>(e);
      for (int a = 0; a < Element::kNodes; ++a) {
        mass_[element_nodes[a]] += body.density * volume * Element::kMassShare[a];
      }
    });
  }
  law_of_.resize(tetrahedra());
  for (std::size_t i = 0; i < count;) {
    std::size_t end = i;
    while (end < count && kinds[sorted[end]] == kinds[sorted[i]]) ++end;
    TetGroup& group = groups_.emplace_back();
    group.body = bodies_.size();
    group.tet_begin = entry.tet_begin + i;
    group.tet_end = entry.tet_begin + end;
    FillGroup(body, group);
    i = end;
  }
}

// Fills in the laws of a group, and the patches that receive part of its elements' volume modulus.
void TetModel::FillGroup(const Body& body, TetGroup& group) {
  const bool nodal = scene_->tet.volume == VolumeForm::kNodal;
  std::vector<double> given(group.tet_end - group.tet_begin, 0.0);
  const auto fill = [&]<class Law>(const Law&) {
    std::map<const Material*, std::int32_t> places;
    std::vector<Law> laws;
    std::vector<double> given_by_law;
    for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
      HeedStop();
      const Material& material = MaterialOf(body, source_tetrahedron_[e]);
      const auto [place, is_new] = places.try_emplace(&material, static_cast<std::int32_t>(laws.size()));
      if (is_new) {
        const Law& law = std::get<Law>(material);
        const double whole = law.VolumeModulus();
        const double kept = nodal ? ElementVolumeModulus(law, order()) : whole;
        laws.push_back(law.WithVolumeModulus(kept));
        given_by_law.push_back(whole - kept);
        depends_on_rate_ |= DependsOnRate(law);
      }
      law_of_[e] = place->second;
      given[e - group.tet_begin] = given_by_law[place->second];
    }
    group.laws = std::move(laws);
  };
  std::visit(fill, MaterialOf(body, source_tetrahedron_[group.tet_begin]));
  AddPatches(group, given);
}

// Dm^-1 and V at the points of an element; returns the sum of V.
template <class Element>
double TetModel::AddPoints(std::size_t tet) {
  const auto element_nodes = NodesOf<Element>(tet);
  std::array<Vec3, Element::kNodes> X;
  for (int a = 0; a < Element::kNodes; ++a) X[a] = rest_positions_[element_nodes[a]];
  double sum = 0;
  for (int q = 0; q < Element::kPoints; ++q) {
    const Mat3 Dm = EdgeMatrix(Element::Corners(X, q));
    const double volume = Element::kPointWeight * Dm.determinant() / 6;
    FASCICLE_CHECK(volume > 0, "an element of a checked mesh has positive volume");
    building_.Dm_inverse.push_back(Dm.inverse());
    building_.rest_volume.push_back(volume);
    sum += volume;
  }
  return sum;
}

void TetModel::AddPatches(const TetGroup& group, std::span<const double> given) {
  patches_.of_element.resize(group.tet_end,
                             {VolumePatches::kNone, VolumePatches::kNone, VolumePatches::kNone, VolumePatches::kNone});
  std::map<std::int32_t, std::int32_t> patch_of_node;
  const std::size_t first = patches_.size();
  for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
    HeedStop();
    const double modulus = given[e - group.tet_begin];
    if (modulus == 0) continue;
    for (int c = 0; c < 4; ++c) {
      const auto [place, is_new] =
          patch_of_node.try_emplace(tetrahedra_[e][c], static_cast<std::int32_t>(patches_.size()));
      if (is_new) {
        patches_.rest_volume.push_back(0);
        patches_.modulus.push_back(0);
      }
      const std::int32_t patch = place->second;
      patches_.of_element[e][c] = patch;
      const double volume = VisitElement([&]<class Element>(Element) {
        double sum = 0;
        for (int q = 0; q < Element::kPoints; ++q) {
          sum += Element::Barycentric(q, c) * building_.rest_volume[Element::kPoints * e + q];
        }
        return sum;
      });
      patches_.rest_volume[patch] += volume;
      patches_.modulus[patch] += volume * modulus;
    }
  }
  for (std::size_t n = first; n < patches_.size(); ++n) patches_.modulus[n] /= patches_.rest_volume[n];
}

// Sets the rows of W: theta from the corners' patches to the mean of each element, and back, weighted by the elements'
// volumes.
void TetModel::SetSmoothing() {
  std::vector<std::map<std::int32_t, double>> rows(patches_.size());
  for (std::size_t e = 0; e < tetrahedra(); ++e) {
    HeedStop();
    const VolumePatches::Corners& corners = patches_.of_element[e];
    if (corners[0] == VolumePatches::kNone) continue;
    for (const std::int32_t n : corners) {
      for (const std::int32_t m : corners) rows[n][m] += building_.rest_volume[e] / 16 / patches_.rest_volume[n];
    }
  }
  patches_.row.push_back(0);
  for (const auto& row : rows) {
    HeedStop();
    for (const auto& [m, weight] : row) {
      patches_.neighbour.push_back(m);
      patches_.weight.push_back(weight);
    }
    patches_.row.push_back(static_cast<std::int32_t>(patches_.neighbour.size()));
  }
}

// Finds the blocks and local node numbers of a chunk's elements.
template <class Element>
void TetModel::AddLocalNumbers(const Chunk& chunk, std::span<const std::int32_t> local_of) {
  chunks_.local.resize(Element::kNodes * kBlock * chunk.block_end);
  chunks_.patch.resize(chunk.node_end, Sharing::kNone);
  for (std::size_t slot = kBlock * chunk.block_begin; slot < kBlock * chunk.block_end; ++slot) {
    // Unused lanes of the last block repeat the last element.
    const std::size_t e = std::min(chunk.tet_begin + slot - kBlock * chunk.block_begin, chunk.tet_end - 1);
    if (e == chunks_.slot.size()) chunks_.slot.push_back(static_cast<std::int32_t>(slot));
    const auto element_nodes = NodesOf<Element>(e);
    const bool has_patch = !patches_.empty() && patches_.of_element[e][0] != VolumePatches::kNone;
    for (int a = 0; a < Element::kNodes; ++a) {
      const std::int32_t local = local_of[element_nodes[a]];
      chunks_.local[(Element::kNodes * (slot / kBlock) + a) * kBlock + slot % kBlock] =
          static_cast<std::uint16_t>(local);
      if (has_patch && a < 4) chunks_.patch[chunk.node_begin + local] = patches_.of_element[e][a];
    }
  }
}

// Lists the nodes of each chunk, ascending.
void TetModel::SetChunks() {
  VisitElement([&]<class Element>(Element) {
    std::vector<std::int32_t> local_of(nodes(), -1);
    std::size_t g = 0;
    for (const std::size_t chunk_end : building_.chunk_ends) {
      HeedStop();
      Chunk chunk;
      if (!chunks_.chunks.empty()) {
        chunk.tet_begin = chunks_.chunks.back().tet_end;
        chunk.block_begin = chunks_.chunks.back().block_end;
        chunk.node_begin = chunks_.chunks.back().node_end;
      }
      while (chunk.tet_begin >= groups_[g].tet_end) ++g;
      chunk.group = static_cast<std::int32_t>(g);
      chunk.law = law_of_[chunk.tet_begin];
      chunk.tet_end = chunk_end;
      chunk.block_end = chunk.block_begin + (chunk_end - chunk.tet_begin + kBlock - 1) / kBlock;
      for (std::size_t e = chunk.tet_begin; e < chunk_end; ++e) {
        for (const std::int32_t n : NodesOf<Element>(e)) {
          if (std::exchange(local_of[n], 0) < 0) chunks_.nodes.push_back(n);
        }
      }
      chunk.node_end = chunks_.nodes.size();
      FASCICLE_CHECK(chunk.node_end - chunk.node_begin <= kChunkNodes, "a chunk respects its limits");
      const auto first = chunks_.nodes.begin() + static_cast<std::ptrdiff_t>(chunk.node_begin);
      std::sort(first, chunks_.nodes.end());
      for (std::size_t i = chunk.node_begin; i < chunk.node_end; ++i) {
        local_of[chunks_.nodes[i]] = static_cast<std::int32_t>(i - chunk.node_begin);
      }
      AddLocalNumbers<Element>(chunk, local_of);
      for (std::size_t i = chunk.node_begin; i < chunk.node_end; ++i) local_of[chunks_.nodes[i]] = -1;
      chunks_.chunks.push_back(chunk);
    }
  });
  chunks_.node_sums = Sharing(chunks_.nodes, nodes());
  if (!patches_.empty()) chunks_.patch_sums = Sharing(chunks_.patch, patches_.size());
}

template <class S>
void TetModel::SetBlocks() {
  BlockArrays<S> arrays;
  const std::size_t blocks = chunks_.chunks.empty() ? 0 : chunks_.chunks.back().block_end;
  const int points = points_per_element();
  arrays.points.resize(points * blocks);
  arrays.fibres.resize(blocks);
  for (const Chunk& chunk : chunks_.chunks) {
    HeedStop();
    for (std::size_t slot = kBlock * chunk.block_begin; slot < kBlock * chunk.block_end; ++slot) {
      const std::size_t e = std::min(chunk.tet_begin + (slot - kBlock * chunk.block_begin), chunk.tet_end - 1);
      const std::size_t block = slot / kBlock, lane = slot % kBlock;
      const bool is_element = slot - kBlock * chunk.block_begin < chunk.tet_end - chunk.tet_begin;
      for (int q = 0; q < points; ++q) {
        RestPoint<S>& point = arrays.points[points * block + q];
        for (int k = 0; k < 9; ++k) {
          point.Dm_inverse[k][lane] = static_cast<S>(building_.Dm_inverse[points * e + q].data()[k]);
        }
        point.volume[lane] = is_element ? static_cast<S>(building_.rest_volume[points * e + q]) : S(0);
      }
      BlockFibres<S>& fibres = arrays.fibres[block];
      for (int c = 0; c < 3; ++c) fibres.direction[c][lane] = static_cast<S>(building_.fibres[e][c]);
      fibres.activation[lane] = building_.activation_of[e];
      fibres.activation_scale[lane] = static_cast<S>(building_.activation_scale[e]);
    }
  }
  blocks_ = std::move(arrays);
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

// The nodes of a region, ascending: those of the mesh and, for quadratic elements, mid-edge nodes. A mid-edge node
// belongs to the region if both ends of its edge do and the edge lies on the boundary or in an element all of whose
// corners belong to the region. (An edge through the body between two sides of a region does not.)
std::vector<std::int32_t> TetModel::NodesOfRegion(const Region& region, const TetBody& body) const {
  const auto first = static_cast<std::int32_t>(body.node_begin);
  std::vector<std::int32_t> nodes;
  for (const std::int32_t n : region.nodes) nodes.push_back(first + n);
  if (order() == ElementOrder::kLinear) return nodes;
  std::vector<bool> inside(body.node_end - body.node_begin, false);
  for (const std::int32_t n : region.nodes) inside[n] = true;
  std::set<std::int32_t> middles;
  const auto add = [&](std::int32_t i, std::int32_t j) {
    if (inside[i] && inside[j]) middles.insert(building_.middles.at(std::minmax(first + i, first + j)));
  };
  for (const Triangle& t : BoundaryTriangles(body.source->tet().mesh)) {
    for (int c = 0; c < 3; ++c) add(t[c], t[(c + 1) % 3]);
  }
  for (const Tetrahedron& tet : body.source->tet().mesh.tetrahedra) {
    if (!std::all_of(tet.begin(), tet.end(), [&](std::int32_t n) { return inside[n]; })) continue;
    for (const auto& [i, j] : kTetEdges) add(tet[i], tet[j]);
  }
  nodes.insert(nodes.end(), middles.begin(), middles.end());
  return nodes;
}

// The faces and nodes on which loads of a region act. With quadratic elements a face acts on its mid-edge nodes,
// because the corner functions integrate to zero.
LoadedRegion TetModel::LoadedRegionIn(const Region& region, const TetBody& body) const {
  const auto first = static_cast<std::int32_t>(body.node_begin);
  LoadedRegion loaded;
  loaded.nodes = NodesOfRegion(region, body);
  for (const Triangle& t : region.triangles) {
    const Triangle n = {first + t[0], first + t[1], first + t[2]};
    const Vec3& X0 = rest_positions_[n[0]];
    LoadedRegion::Face& face = loaded.faces.emplace_back();
    face.area = 0.5 * (rest_positions_[n[1]] - X0).cross(rest_positions_[n[2]] - X0);
    face.count = 3;
    for (int c = 0; c < 3; ++c) {
      face.nodes[c] = order() == ElementOrder::kLinear ? n[c] : building_.middles.at(std::minmax(n[c], n[(c + 1) % 3]));
    }
  }
  return loaded;
}

void TetModel::AddLoads(const Body& source, const TetBody& body) {
  for (const Load& load : source.loads) {
    const auto forces = NodalForcesOf(load, LoadedRegionIn(source.regions[load.region], body));
    NodalLoad& entry = loads_.emplace_back();
    for (const auto& [n, force] : forces) {
      entry.nodes.push_back(n);
      entry.forces.push_back(force);
    }
  }
}

void TetModel::AddSupports(const Body& source, std::int32_t body_index) {
  for (const Constraint& constraint : source.constraints) {
    Support& support = supports_.emplace_back();
    support.body = body_index;
    support.nodes = NodesOfRegion(source.regions[constraint.region], bodies_[body_index]);
    for (const std::int32_t n : support.nodes) {
      std::array<bool, 3> owned = {};
      for (int c = 0; c < 3; ++c) {
        owned[c] = constraint.axes[c] && inverse_mass_[n][c] != 0;
        if (owned[c]) inverse_mass_[n][c] = 0;
      }
      support.owned.push_back(owned);
    }
  }
}

void TetModel::AddContactNodes(const TetBody& body) {
  const auto first = static_cast<std::int32_t>(body.node_begin);
  std::map<std::int32_t, double> areas;
  for (const Triangle& t : BoundaryTriangles(body.source->tet().mesh)) {
    const Triangle n = {first + t[0], first + t[1], first + t[2]};
    const Vec3& X0 = rest_positions_[n[0]];
    const double area = 0.5 * (rest_positions_[n[1]] - X0).cross(rest_positions_[n[2]] - X0).norm();
    // The consistent weights of quadratic triangles are zero at corners, which could then penetrate the floor.
    const double corner = order() == ElementOrder::kLinear ? 1. / 3 : 1. / 12;
    for (int c = 0; c < 3; ++c) {
      areas[n[c]] += corner * area;
      if (order() == ElementOrder::kQuadratic)
        areas[building_.middles.at(std::minmax(n[c], n[(c + 1) % 3]))] += area / 4;
    }
  }
  const double modulus =
      std::visit([](const auto& law) { return law.BulkModulus() + 4 * law.ShearModulus() / 3; }, body.source->material);
  for (const auto& [node, area] : areas) {
    contact_nodes_.push_back({node, modulus * area * area * body.source->density / mass_[node]});
  }
}

NodalVector TetModel::InitialPositions() const {
  NodalVector x = rest_positions_;
  for (const TetBody& body : bodies_) {
    const std::vector<Vec3>& displacement = body.source->tet().initial_displacement;
    if (displacement.empty()) continue;
    for (std::size_t n = 0; n < displacement.size(); ++n) x[body.node_begin + n] += displacement[n];
    if (order() == ElementOrder::kLinear) continue;
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
