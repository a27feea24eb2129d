#include "core/base/check.h"
#include "core/tet/chunk_order.h"
#include "core/tet/model_builder.h"

namespace fascicle {

// Divides the elements of each law, which are contiguous already, into chunks.
void TetModelBuilder::SortIntoChunks(const TetMesh& mesh, const TetBody& entry, std::span<const LawKey> laws,
                                     std::span<std::int32_t> sorted) {
  std::vector<Vec3> middles;
  for (std::size_t e = 0; e < ElementCount(mesh); ++e) middles.push_back(ElementCentroid(mesh, e));
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
      if (mesh.hexahedra.empty()) {
        for (const std::int32_t n : mesh.tetrahedra[t]) see(n);
      } else {
        for (const std::int32_t n : mesh.hexahedra[t]) see(n);
      }
      if (!model_.edge_nodes_.empty()) {
        for (const std::int32_t n : model_.edge_nodes_[entry.tet_begin + t]) see(n - entry.node_begin);
      }
      if (!model_.inner_nodes_.empty()) {
        for (const std::int32_t n : model_.inner_nodes_[entry.tet_begin + t]) see(n - entry.node_begin);
      }
    }
    return nodes;
  };
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin;
    while (end < sorted.size() && laws[sorted[end]] == laws[sorted[begin]]) ++end;
    for (const std::size_t chunk : CutIntoChunks(sorted.subspan(begin, end - begin), middles, count_nodes)) {
      chunk_ends_.push_back(entry.tet_begin + begin + chunk);
    }
    begin = end;
  }
}

// Finds the blocks and local node numbers of a chunk's elements.
template <class Element>
void TetModelBuilder::AddLocalNumbers(const Chunk& chunk, std::span<const std::int32_t> local_of) {
  model_.chunks_.local.resize(Element::kNodes * kBlock * chunk.block_end);
  model_.chunks_.patch.resize(chunk.node_end, Sharing::kNone);
  for (std::size_t slot = kBlock * chunk.block_begin; slot < kBlock * chunk.block_end; ++slot) {
    // Unused lanes of the last block repeat the last element.
    const std::size_t e = std::min(chunk.tet_begin + slot - kBlock * chunk.block_begin, chunk.tet_end - 1);
    if (e == model_.chunks_.slot.size()) model_.chunks_.slot.push_back(static_cast<std::int32_t>(slot));
    const auto element_nodes = model_.NodesOf<Element>(e);
    const bool has_patch = !model_.patches_.empty() && model_.patches_.of_element[e][0] != VolumePatches::kNone;
    if constexpr (Element::kIsHexahedron) {
      model_.chunks_.element_patch.push_back(has_patch ? model_.patches_.of_element[e][0] : Sharing::kNone);
    }
    for (int a = 0; a < Element::kNodes; ++a) {
      const std::int32_t local = local_of[element_nodes[a]];
      model_.chunks_.local[(Element::kNodes * (slot / kBlock) + a) * kBlock + slot % kBlock] =
          static_cast<std::uint16_t>(local);
      if (has_patch && !Element::kIsHexahedron && a < 4)
        model_.chunks_.patch[chunk.node_begin + local] = model_.patches_.of_element[e][a];
    }
  }
}

// Counts the points of a chunk with Maxwell branches.
void TetModelBuilder::AddBranches(Chunk& chunk) {
  const std::vector<PronySeries>& series = model_.groups_[chunk.group].series;
  if (series.empty() || series[chunk.law].terms.empty()) return;
  chunk.branch_point = model_.branch_points_;
  model_.branch_points_ += model_.points_per_element() * (chunk.block_end - chunk.block_begin);
  model_.most_branches_ = std::max(model_.most_branches_, series[chunk.law].terms.size());
}

// Lists the nodes of each chunk, ascending.
void TetModelBuilder::SetChunks() {
  model_.VisitElement([&]<class Element>(Element) {
    std::vector<std::int32_t> local_of(model_.nodes(), -1);
    std::size_t g = 0;
    for (const std::size_t chunk_end : chunk_ends_) {
      HeedStop();
      Chunk chunk;
      if (!model_.chunks_.chunks.empty()) {
        chunk.tet_begin = model_.chunks_.chunks.back().tet_end;
        chunk.block_begin = model_.chunks_.chunks.back().block_end;
        chunk.node_begin = model_.chunks_.chunks.back().node_end;
      }
      while (chunk.tet_begin >= model_.groups_[g].tet_end) ++g;
      chunk.group = static_cast<std::int32_t>(g);
      chunk.law = model_.law_of_[chunk.tet_begin];
      chunk.tet_end = chunk_end;
      chunk.block_end = chunk.block_begin + (chunk_end - chunk.tet_begin + kBlock - 1) / kBlock;
      for (std::size_t e = chunk.tet_begin; e < chunk_end; ++e) {
        for (const std::int32_t n : model_.NodesOf<Element>(e)) {
          if (std::exchange(local_of[n], 0) < 0) model_.chunks_.nodes.push_back(n);
        }
      }
      chunk.node_end = model_.chunks_.nodes.size();
      FASCICLE_CHECK(chunk.node_end - chunk.node_begin <= kChunkNodes, "a chunk respects its limits");
      AddBranches(chunk);
      const auto first = model_.chunks_.nodes.begin() + static_cast<std::ptrdiff_t>(chunk.node_begin);
      std::sort(first, model_.chunks_.nodes.end());
      for (std::size_t i = chunk.node_begin; i < chunk.node_end; ++i) {
        local_of[model_.chunks_.nodes[i]] = static_cast<std::int32_t>(i - chunk.node_begin);
      }
      AddLocalNumbers<Element>(chunk, local_of);
      for (std::size_t i = chunk.node_begin; i < chunk.node_end; ++i) local_of[model_.chunks_.nodes[i]] = -1;
      model_.chunks_.chunks.push_back(chunk);
    }
  });
  model_.chunks_.node_sums = Sharing(model_.chunks_.nodes, model_.nodes());
  if (!model_.patches_.empty() && model_.chunks_.element_patch.empty()) {
    model_.chunks_.patch_sums = Sharing(model_.chunks_.patch, model_.patches_.size());
  }
}

template <class S>
BlockArrays<S> TetModelBuilder::MakeBlocks() const {
  BlockArrays<S> arrays;
  const std::size_t blocks = model_.chunks_.chunks.empty() ? 0 : model_.chunks_.chunks.back().block_end;
  const int points = model_.points_per_element();
  arrays.points.resize(points * blocks);
  arrays.fibres.resize(blocks);
  for (const Chunk& chunk : model_.chunks_.chunks) {
    HeedStop();
    for (std::size_t slot = kBlock * chunk.block_begin; slot < kBlock * chunk.block_end; ++slot) {
      const std::size_t e = std::min(chunk.tet_begin + (slot - kBlock * chunk.block_begin), chunk.tet_end - 1);
      const std::size_t block = slot / kBlock, lane = slot % kBlock;
      const bool is_element = slot - kBlock * chunk.block_begin < chunk.tet_end - chunk.tet_begin;
      for (int q = 0; q < points; ++q) {
        RestPoint<S>& point = arrays.points[points * block + q];
        for (int k = 0; k < 9; ++k) {
          point.Dm_inverse[k][lane] = static_cast<S>(Dm_inverse_[points * e + q].data()[k]);
        }
        point.volume[lane] = is_element ? static_cast<S>(rest_volume_[points * e + q]) : S(0);
      }
      BlockFibres<S>& fibres = arrays.fibres[block];
      for (int c = 0; c < 3; ++c) fibres.direction[c][lane] = static_cast<S>(fibres_[e][c]);
      fibres.activation[lane] = activation_of_[e];
      fibres.activation_scale[lane] = static_cast<S>(activation_scale_[e]);
    }
  }
  return arrays;
}

void TetModelBuilder::SetBlocks() {
  if (scene_.tet.precision == Precision::kSingle) {
    model_.blocks_ = MakeBlocks<float>();
  } else {
    model_.blocks_ = MakeBlocks<double>();
  }
}

}  // namespace fascicle
