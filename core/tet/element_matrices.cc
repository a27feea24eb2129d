#include "core/tet/element_matrices.h"

#include <algorithm>
#include <cmath>

#include "core/materials/spd.h"
#include "core/tet/chunk_tasks.h"

namespace fascicle {
namespace {

ChunkTask<double> TaskOf(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                         std::span<const double> acting, const Chunk& chunk) {
  ChunkTask<double> task = TaskOf<double>(model, chunk, model.chunks().node_sums);
  const TetBody& body = model.bodies()[model.groups()[chunk.group].body];
  task.x = Numbers(x);
  SetDrive(model, potential.drive, task);
  if (!model.patches().empty()) task.pressure = acting.data();
  if (potential.viscous_rate != 0 && body.HasStrainDamping()) {
    task.mu = body.damping_mu * potential.viscous_rate;
    task.lambda = body.damping_lambda * potential.viscous_rate;
    task.previous = Numbers(*potential.previous);
  }
  task.with_energy = true;
  return task;
}

const ElementKernels<double>& KernelsOf(const TetModel& model, const ForceWorkspace& workspace) {
  return model.order() == ElementOrder::kLinear ? workspace.kernels->linear : workspace.kernels->quadratic;
}

// Calls visit(element, PointPotential maker) with the law fixed.
template <class Visit>
void VisitLaw(const TetModel& model, const Chunk& chunk, const Visit& visit) {
  std::visit([&](const auto& laws) { visit(laws[chunk.law]); }, model.groups()[chunk.group].laws);
}

// As the kernels' forces, by PointPotential.
template <class Element>
ChunkReport PlainForces(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                        std::span<const double> acting, const Chunk& chunk, double* force, double* slot_sums) {
  const ElementChunks& chunks = model.chunks();
  const TetBody& body = model.bodies()[model.groups()[chunk.group].body];
  ChunkReport report;
  std::array<Vec3, kChunkNodes> sums;
  std::fill_n(sums.begin(), chunk.node_end - chunk.node_begin, Vec3::Zero());
  VisitLaw(model, chunk, [&]<class Law>(const Law& law) {
    for (std::size_t e = chunk.tet_begin; e < chunk.tet_end; ++e) {
      const auto values = ValuesOf<Element>(model, e, x);
      std::array<Vec3, Element::kNodes> forces;
      forces.fill(Vec3::Zero());
      for (int q = 0; q < Element::kPoints; ++q) {
        const std::size_t at = Element::kPoints * e + q;
        const Mat3 F = GradientAt<Element>(model, e, values, q);
        const double J = Determinant(F);
        if (!(J >= report.smallest_ratio)) report.smallest_ratio = J;
        const PointPotential<Element, Law> point(potential, model, body, law, e, q);
        report.energy += model.rest_volume()[at] * point.Energy(F);
        const Mat3 P = point.Stress(F) + PatchPressure<Element>(model.patches(), acting, e, q) * Cofactor(F);
        CornerValues corners;
        SetCornerForces(P, model.Dm_inverse()[at], model.rest_volume()[at], corners);
        Element::AddCorners(corners, q, forces);
      }
      const std::size_t slot = chunks.slot[e];
      const std::uint16_t* local = &chunks.local[Element::kNodes * kBlock * (slot / kBlock) + slot % kBlock];
      for (int a = 0; a < Element::kNodes; ++a) {
        sums[local[kBlock * a]] += forces[a];
        report.squares += forces[a].squaredNorm();
      }
    }
  });
  for (std::size_t i = chunk.node_begin; i < chunk.node_end; ++i) {
    const Vec3& sum = sums[i - chunk.node_begin];
    const std::int32_t target = chunks.node_sums.target[i];
    std::copy_n(sum.data(), 3,
                target >= 0 ? force + 3 * std::ptrdiff_t{target} : slot_sums + 3 * std::ptrdiff_t{~target});
    report.finite &= std::isfinite(sum.sum());
  }
  return report;
}

// As the kernels' matrices, by PointPotential.
template <class Element>
void SetPlainMatrices(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                      std::span<const double> acting, double projection, const Chunk& chunk, std::size_t begin,
                      std::size_t end, double* blocks, double* volumes) {
  constexpr int kNodes = Element::kNodes, kPairs = kNodes * (kNodes + 1) / 2;
  const TetBody& body = model.bodies()[model.groups()[chunk.group].body];
  std::fill_n(blocks, 9 * kPairs * (end - begin), 0.0);
  std::fill_n(volumes, 12 * kNodes * (end - begin), 0.0);
  VisitLaw(model, chunk, [&]<class Law>(const Law& law) {
    for (std::size_t e = begin; e < end; ++e, blocks += 9 * kPairs, volumes += 12 * kNodes) {
      const auto values = ValuesOf<Element>(model, e, x);
      for (int q = 0; q < Element::kPoints; ++q) {
        const double volume = model.rest_volume()[Element::kPoints * e + q];
        const Mat3 F = GradientAt<Element>(model, e, values, q);
        Mat9 H = PointPotential<Element, Law>(potential, model, body, law, e, q).Tangent(F);
        AddCofactorTangent(PatchPressure<Element>(model.patches(), acting, e, q), F, H);
        if (projection > 0) H += projection * (NearestPositive(H) - H);
        const auto G = ShapeGradients<Element>(model, e, q);
        const Mat3 cofactor = Cofactor(F);
        for (int b = 0; b < kNodes; ++b) {
          // Change of P with each component of node b.
          Eigen::Matrix<double, 9, 3> change = G(0, b) * H.template leftCols<3>();
          change += G(1, b) * H.template middleCols<3>(3);
          change += G(2, b) * H.template rightCols<3>();
          change *= volume;
          for (int a = b; a < kNodes; ++a) {
            Eigen::Map<Mat3>(blocks + 9 * (a * (a + 1) / 2 + b)) += G(0, a) * change.template topRows<3>() +
                                                                    G(1, a) * change.template middleRows<3>(3) +
                                                                    G(2, a) * change.template bottomRows<3>();
          }
          const Vec3 volume_change = volume * (cofactor * G.col(b));
          for (int c = 0; c < 4; ++c) {
            Eigen::Map<Vec3>(volumes + 3 * (kNodes * c + b)) += Element::Barycentric(q, c) * volume_change;
          }
        }
      }
    }
  });
}

// Matrices of up to kBlock elements.
struct BlockScratch {
  alignas(64) double blocks[9 * 55 * kBlock];
  alignas(64) double volumes[12 * 10 * kBlock];
};

// Sets the matrices of the elements of block b of a chunk.
template <class Element>
ElementMatrices MatricesOf(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                           std::span<const double> acting, double projection, const ForceWorkspace& workspace,
                           const Chunk& chunk, std::size_t b, double* blocks, double* volumes) {
  const std::size_t begin = chunk.tet_begin + kBlock * b;
  const std::size_t end = std::min(begin + kBlock, chunk.tet_end);
  if (potential.untangling || projection > 0) {
    SetPlainMatrices<Element>(model, potential, x, acting, projection, chunk, begin, end, blocks, volumes);
  } else {
    KernelsOf(model, workspace).matrices(TaskOf(model, potential, x, acting, chunk), b, {blocks, volumes});
  }
  return {begin, end - begin, Element::kNodes, blocks, volumes};
}

template <class Element>
void AddBlocks(const ElementMatrices& matrices, std::span<const std::int32_t> places, std::int32_t low,
               std::int32_t high, std::span<double> values) {
  constexpr std::size_t kPairs = Element::kNodes * (Element::kNodes + 1) / 2;
  constexpr std::size_t kAhead = 32;  // blocks whose places are asked for meanwhile
  const std::size_t count = kPairs * matrices.count;
  const std::int32_t* place = &places[kPairs * matrices.begin];
  const auto block_of = [](std::int32_t p) { return p < 0 ? ~p : p; };
  const double* block = matrices.blocks;
  for (std::size_t i = 0; i < count; ++i, block += 9) {
    if (i + kAhead < count) {
      const std::int32_t ahead = block_of(place[i + kAhead]);
      if (ahead >= low && ahead < high) {
        const double* line = &values[9 * static_cast<std::size_t>(ahead)];
        __builtin_prefetch(line, 1);
        __builtin_prefetch(line + 8, 1);
      }
    }
    const std::int32_t at = block_of(place[i]);
    if (at < low || at >= high) continue;
    double* to = &values[9 * static_cast<std::size_t>(at)];
    if (place[i] >= 0) {
      for (int k = 0; k < 9; ++k) to[k] += block[k];
    } else {
      for (int k = 0; k < 9; ++k) to[k] += block[3 * (k % 3) + k / 3];
    }
  }
}

}  // namespace

ElementEvaluation EvaluateElements(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                                   std::span<const double> acting, ThreadTeam& team, ForceWorkspace& workspace,
                                   NodalVector& force) {
  const Sharing& sharing = model.chunks().node_sums;
  force.resize(model.nodes());
  workspace.slot_sums.resize(std::max(workspace.slot_sums.size(), 3 * sharing.slots.size()));
  workspace.reports.resize(model.chunks().chunks.size());
  ForChunks(model, team, [&](const Chunk& chunk, std::size_t c) {
    if (potential.untangling) {
      workspace.reports[c] = model.VisitElement([&]<class Element>(Element) {
        return PlainForces<Element>(model, potential, x, acting, chunk, Numbers(force), workspace.slot_sums.data());
      });
      return;
    }
    ChunkTask<double> task = TaskOf(model, potential, x, acting, chunk);
    task.sums = Numbers(force);
    task.slot_sums = workspace.slot_sums.data();
    workspace.reports[c] = KernelsOf(model, workspace).forces(task);
  });
  AddSlots<3>(sharing, workspace.slot_sums.data(), team, Numbers(force));
  ElementEvaluation total;
  for (const ChunkReport& report : workspace.reports) {
    total.energy += report.energy;
    total.squares += report.squares;
    total.finite &= report.finite;
    if (!(report.smallest_ratio >= total.smallest_ratio)) total.smallest_ratio = report.smallest_ratio;
  }
  return total;
}

void ForElementMatrices(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                        std::span<const double> acting, double projection, ThreadTeam& team,
                        const ForceWorkspace& workspace, const std::function<void(const ElementMatrices&)>& visit) {
  model.VisitElement([&]<class Element>(Element) {
    ForChunks(model, team, [&](const Chunk& chunk, std::size_t) {
      BlockScratch scratch;
      for (std::size_t b = 0; b < chunk.block_end - chunk.block_begin; ++b) {
        visit(MatricesOf<Element>(model, potential, x, acting, projection, workspace, chunk, b, scratch.blocks,
                                  scratch.volumes));
      }
    });
  });
}

void AddStiffness(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                  std::span<const double> acting, double projection, std::span<const std::int32_t> places,
                  ThreadTeam& team, ForceWorkspace& workspace, std::span<double> values) {
  const std::vector<Chunk>& chunks = model.chunks().chunks;
  model.VisitElement([&]<class Element>(Element) {
    constexpr std::size_t kPairs = Element::kNodes * (Element::kNodes + 1) / 2;
    // Chunks at a time whose matrices are computed together, each element's kept; then each thread goes through all of
    // them and adds what falls into its part of the values. So they are added in the same order whatever the threads.
    const std::size_t wave = team.size() == 1 ? 1 : 2 * static_cast<std::size_t>(team.size());
    const std::size_t of_chunk = 9 * kPairs * kChunkElements;
    std::vector<double>& kept = workspace.wave_blocks;
    kept.resize(std::max(kept.size(), wave * of_chunk));
    const auto blocks = static_cast<std::int32_t>(values.size() / 9);
    for (std::size_t first = 0; first < chunks.size(); first += wave) {
      const std::size_t count = std::min(wave, chunks.size() - first);
      team.For(count, 1, [&](std::size_t begin, std::size_t end) {
        double volumes[12 * Element::kNodes * kBlock];
        for (std::size_t c = begin; c < end; ++c) {
          const Chunk& chunk = chunks[first + c];
          for (std::size_t b = 0; b < chunk.block_end - chunk.block_begin; ++b) {
            MatricesOf<Element>(model, potential, x, acting, projection, workspace, chunk, b,
                                &kept[c * of_chunk + 9 * kPairs * kBlock * b], volumes);
          }
        }
      });
      const int parts = team.size();
      team.For(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t part = begin; part < end; ++part) {
          const auto low = static_cast<std::int32_t>(std::int64_t{blocks} * static_cast<std::int64_t>(part) / parts);
          const auto high =
              static_cast<std::int32_t>(std::int64_t{blocks} * static_cast<std::int64_t>(part + 1) / parts);
          for (std::size_t c = 0; c < count; ++c) {
            const Chunk& chunk = chunks[first + c];
            AddBlocks<Element>({chunk.tet_begin, chunk.tet_end - chunk.tet_begin, Element::kNodes, &kept[c * of_chunk]},
                               places, low, high, values);
          }
        }
      });
    }
  });
}

}  // namespace fascicle
