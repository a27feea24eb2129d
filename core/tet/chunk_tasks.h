#ifndef FASCICLE_CORE_TET_CHUNK_TASKS_H_
#define FASCICLE_CORE_TET_CHUNK_TASKS_H_

#include "core/tet/branches.h"
#include "core/tet/forces.h"

// Functions shared by the loops over chunks.
namespace fascicle {

inline const double* Numbers(const NodalVector& values) { return values.data()->data(); }
inline double* Numbers(NodalVector& values) { return values.data()->data(); }

// The kernels for the model's element.
template <class S>
const ElementKernels<S>& KernelsOf(const TetModel& model, const Kernels& kernels) {
  constexpr bool kIsFloat = std::is_same_v<S, float>;
  const auto choose = [](const auto& in_double, const auto& in_float) -> const ElementKernels<S>& {
    if constexpr (kIsFloat) {
      return in_float;
    } else {
      return in_double;
    }
  };
  switch (model.order()) {
    case ElementOrder::kLinear:
      return choose(kernels.linear, kernels.linear_float);
    case ElementOrder::kQuadratic:
      return choose(kernels.quadratic, kernels.quadratic_float);
    case ElementOrder::kHexahedral:
      return choose(kernels.hexahedral, kernels.hexahedral_float);
    case ElementOrder::kHexahedralQuadratic:
      break;
  }
  return choose(kernels.hexahedral_quadratic, kernels.hexahedral_quadratic_float);
}

// Calls visitor(kernels for the model's element and number type).
template <class Visitor>
void VisitKernels(const TetModel& model, const Kernels& kernels, const Visitor& visitor) {
  model.VisitBlocks([&]<class S>(const BlockArrays<S>&) { visitor(KernelsOf<S>(model, kernels)); });
}

// Whether a chunk's elements have patches.
inline bool HasPatches(const TetModel& model, const Chunk& chunk) {
  const ElementChunks& chunks = model.chunks();
  if (!chunks.element_patch.empty()) return chunks.element_patch[kBlock * chunk.block_begin] != Sharing::kNone;
  return chunks.patch_sums.target[chunk.node_begin] != Sharing::kNone;
}

// A task with a chunk's elements and law; the caller adds the loads and results.
template <class S>
ChunkTask<S> TaskOf(const TetModel& model, const Chunk& chunk, const Sharing& sharing) {
  const ElementChunks& chunks = model.chunks();
  const BlockArrays<S>& arrays = model.blocks<S>();
  const TetGroup& group = model.groups()[chunk.group];
  ChunkTask<S> task;
  task.points = &arrays.points[model.points_per_element() * chunk.block_begin];
  task.fibres = &arrays.fibres[chunk.block_begin];
  task.local = &chunks.local[model.nodes_per_element() * kBlock * chunk.block_begin];
  task.elements = chunk.tet_end - chunk.tet_begin;
  task.nodes = &chunks.nodes[chunk.node_begin];
  task.node_count = chunk.node_end - chunk.node_begin;
  task.patch = &chunks.patch[chunk.node_begin];
  if (!chunks.element_patch.empty()) task.element_patch = &chunks.element_patch[kBlock * chunk.block_begin];
  if (!sharing.target.empty()) task.target = &sharing.target[chunk.node_begin];
  task.law = std::visit([&](const auto& laws) -> const void* { return &laws[chunk.law]; }, group.laws);
  task.law_kind = static_cast<int>(group.laws.index());
  return task;
}

// The law that a viscoelastic chunk's branches follow.
inline const void* BranchLawOf(const TetModel& model, const Chunk& chunk) {
  return std::visit([&](const auto& laws) -> const void* { return &laws[chunk.law]; },
                    model.groups()[chunk.group].branch_laws);
}

// The arguments of the laws of a chunk's task besides the deformation.
template <class S>
void SetDrive(const TetModel& model, const FibreDrive& drive, const Chunk& chunk, ChunkTask<S>& task) {
  task.activation = drive.activation.data();
  if (drive.branches != nullptr && chunk.branch_point != Chunk::kElastic) {
    task.branch_law = BranchLawOf(model, chunk);
    task.branch_factor = drive.branches->factor[static_cast<std::size_t>(&chunk - model.chunks().chunks.data())];
    task.branch_stress = &drive.branches->stress[kBranchTensor * chunk.branch_point];
  }
  if (drive.inverse_step == 0 || !model.depends_on_rate()) return;
  task.previous = Numbers(*drive.previous);
  task.inverse_step = drive.inverse_step;
}

// Calls visit(chunk, its number) for all chunks, in parallel.
template <class Visit>
void ForChunks(const TetModel& model, ThreadTeam& team, const Visit& visit) {
  const std::vector<Chunk>& chunks = model.chunks().chunks;
  team.For(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) visit(chunks[c], c);
  });
}

template <class Visit>
void ForPatches(const VolumePatches& patches, ThreadTeam& team, const Visit& visit) {
  ForNodes(team, patches.size(), visit);
}

// Adds up the slots of shared places, kComponents numbers each.
template <int kComponents>
void AddSlots(const Sharing& sharing, const double* slot_sums, ThreadTeam& team, double* sums) {
  team.For(sharing.shared.size(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double sum[kComponents] = {};
      for (std::int32_t k = sharing.begin[i]; k < sharing.begin[i + 1]; ++k) {
        for (int c = 0; c < kComponents; ++c) sum[c] += slot_sums[kComponents * sharing.slots[k] + c];
      }
      for (int c = 0; c < kComponents; ++c) sums[kComponents * sharing.shared[i] + c] = sum[c];
    }
  });
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_CHUNK_TASKS_H_
