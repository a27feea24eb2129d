#include "core/tet/element_matrices.h"

#include <algorithm>
#include <cmath>

#include "core/materials/spd.h"
#include "core/tet/chunk_tasks.h"
#include "core/tet/untangling_law.h"

namespace fascicle {
namespace {

ChunkTask<double> MatrixTaskOf(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                               std::span<const double> acting, const Chunk& chunk) {
  ChunkTask<double> task = TaskOf<double>(model, chunk, model.chunks().node_sums);
  const TetBody& body = model.bodies()[model.groups()[chunk.group].body];
  task.x = Numbers(x);
  SetDrive(model, potential.drive, chunk, task);
  if (!model.patches().empty()) task.pressure = acting.data();
  if (potential.viscous_rate != 0 && body.HasStrainDamping()) {
    task.mu = body.damping_mu * potential.viscous_rate;
    task.lambda = body.damping_lambda * potential.viscous_rate;
    task.previous = Numbers(*potential.previous);
  }
  task.with_energy = true;
  return task;
}

// As the kernels' forces, but with UntanglingLaw and element by element.
template <class Element>
ChunkReport UntanglingForces(const TetModel& model, const NodalVector& x, const Chunk& chunk, double* force,
                             double* slot_sums) {
  const ElementChunks& chunks = model.chunks();
  ChunkReport report;
  std::array<Vec3, kChunkNodes> sums;
  std::fill_n(sums.begin(), chunk.node_end - chunk.node_begin, Vec3::Zero());
  for (std::size_t e = chunk.tet_begin; e < chunk.tet_end; ++e) {
    const auto values = ValuesOf<Element>(model, e, x);
    std::array<Vec3, Element::kNodes> forces;
    forces.fill(Vec3::Zero());
    for (int q = 0; q < Element::kPoints; ++q) {
      const std::size_t at = Element::kPoints * e + q;
      const Mat3 F = GradientAt<Element>(model, e, values, q);
      const double J = Determinant(F);
      if (!(J >= report.smallest_ratio)) report.smallest_ratio = J;
      report.energy += model.rest_volume()[at] * UntanglingLaw::Energy(F);
      CornerValues corners;
      SetCornerForces(UntanglingLaw::Stress(F), model.Dm_inverse()[at], model.rest_volume()[at], corners);
      Element::AddCorners(corners, q, forces);
    }
    const std::size_t slot = chunks.slot[e];
    const std::uint16_t* local = &chunks.local[Element::kNodes * kBlock * (slot / kBlock) + slot % kBlock];
    for (int a = 0; a < Element::kNodes; ++a) {
      sums[local[kBlock * a]] += forces[a];
      report.squares += forces[a].squaredNorm();
    }
  }
  for (std::size_t i = chunk.node_begin; i < chunk.node_end; ++i) {
    const Vec3& sum = sums[i - chunk.node_begin];
    const std::int32_t target = chunks.node_sums.target[i];
    std::copy_n(sum.data(), 3,
                target >= 0 ? force + 3 * std::ptrdiff_t{target} : slot_sums + 3 * std::ptrdiff_t{~target});
    report.finite &= std::isfinite(sum.sum());
  }
  return report;
}

// Adds the matrix of a point to the blocks of its element's pairs of nodes.
template <class Element>
void AddPoint(const Mat9& H, const Eigen::Matrix<double, 3, Element::kNodes>& G, double volume, Mat3* pairs) {
  for (int b = 0; b < Element::kNodes; ++b) {
    // Derivative of P with respect to each component of node b.
    Eigen::Matrix<double, 9, 3> change = G(0, b) * H.leftCols<3>();
    change += G(1, b) * H.middleCols<3>(3);
    change += G(2, b) * H.rightCols<3>();
    change *= volume;
    for (int a = b; a < Element::kNodes; ++a) {
      pairs[a * (a + 1) / 2 + b] +=
          G(0, a) * change.topRows<3>() + G(1, a) * change.middleRows<3>(3) + G(2, a) * change.bottomRows<3>();
    }
  }
}

// As the kernels' stiffness, but element by element and with the tangent tangent_at(element, point, F). Points for
// which it is zero are left out.
template <class Element, class TangentAt>
void AddStiffness(const TetModel& model, const NodalVector& x, const Chunk& chunk, const ChunkBlocks& blocks,
                  const TangentAt& tangent_at) {
  constexpr int kPairs = Element::kNodes * (Element::kNodes + 1) / 2;
  for (std::size_t e = chunk.tet_begin; e < chunk.tet_end; ++e) {
    const auto values = ValuesOf<Element>(model, e, x);
    std::array<Mat3, kPairs> pairs;
    bool is_zero = true;
    for (int q = 0; q < Element::kPoints; ++q) {
      const Mat9 H = tangent_at(e, q, GradientAt<Element>(model, e, values, q));
      if (H.isZero(0)) continue;
      if (std::exchange(is_zero, false)) pairs.fill(Mat3::Zero());
      AddPoint<Element>(H, ShapeGradients<Element>(model, e, q), model.rest_volume()[Element::kPoints * e + q],
                        pairs.data());
    }
    if (is_zero) continue;
    const std::size_t slot = e - chunk.tet_begin;
    for (int pair = 0; pair < kPairs; ++pair) {
      const std::size_t at = kPairs * (slot / kBlock) + pair;
      Eigen::Map<Mat3> sum(blocks.sums + 9 * std::size_t{blocks.place[kBlock * at + slot % kBlock]});
      if (blocks.doubled != nullptr && (blocks.doubled[at] >> slot % kBlock & 1) != 0) {
        sum += pairs[pair] + pairs[pair].transpose();
      } else if ((blocks.turned[at] >> slot % kBlock & 1) != 0) {
        sum += pairs[pair].transpose();
      } else {
        sum += pairs[pair];
      }
    }
  }
}

template <class Element>
void AddUntanglingStiffness(const TetModel& model, const NodalVector& x, const Chunk& chunk,
                            const ChunkBlocks& blocks) {
  AddStiffness<Element>(model, x, chunk, blocks,
                        [](std::size_t, int, const Mat3& F) { return UntanglingLaw::Tangent(F); });
}

Mat9 ChangeByProjection(const Mat9& H) { return NearestPositive(H) - H; }

// Adds the change by projection. Kernels do not project tangents, since projections are rare.
template <class Element>
void AddProjection(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                   std::span<const double> acting, const Chunk& chunk, const ChunkBlocks& blocks) {
  if (potential.untangling) {
    AddStiffness<Element>(model, x, chunk, blocks, [](std::size_t, int, const Mat3& F) {
      return ChangeByProjection(UntanglingLaw::Tangent(F));
    });
    return;
  }
  const TetGroup& group = model.groups()[chunk.group];
  const TetBody& body = model.bodies()[group.body];
  const auto add = [&]<class Law>(const std::vector<Law>& laws) {
    AddStiffness<Element>(model, x, chunk, blocks, [&](std::size_t e, int q, const Mat3& F) {
      Mat9 H = PointTangent<Element, Law>(potential, model, body, laws[chunk.law], e, q).At(F);
      AddCofactorTangent(PatchPressure<Element>(model.patches(), acting, e, q), F, H);
      return ChangeByProjection(H);
    });
  };
  std::visit(add, group.laws);
}

void SetBoth(const StiffnessLayout::Target& target, const Mat3& block, BlockValues& values) {
  values[target.high] = block.transpose();
  values[target.low] = block;
}

// Adds up the blocks of all chunks, to which add(chunk, blocks) adds its elements.
template <class Add>
void AssembleBlocks(const TetModel& model, const StiffnessLayout& layout, ThreadTeam& team, ForceWorkspace& workspace,
                    BlockValues& values, const Add& add) {
  const std::vector<Chunk>& chunks = model.chunks().chunks;
  BlockValues& slots = workspace.slot_blocks;
  slots.resize(layout.slots().size());
  team.For(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<double> sums;
    for (std::size_t c = begin; c < end; ++c) {
      const Chunk& chunk = chunks[c];
      const std::span<const StiffnessLayout::Target> targets = layout.TargetsOf(c);
      sums.assign(9 * targets.size(), 0.0);
      add(chunk, ChunkBlocks{layout.PlacesOf(chunk.block_begin), layout.TurnedOf(chunk.block_begin),
                             layout.DoubledOf(chunk.block_begin), sums.data()});
      for (std::size_t i = 0; i < targets.size(); ++i) {
        const Eigen::Map<const Mat3> block(&sums[9 * i]);
        if (targets[i].low >= 0) {
          SetBoth(targets[i], block, values);
        } else {
          slots[~targets[i].low] = block;
        }
      }
    }
  });
  ForNodes(team, layout.shared().size(), [&](std::size_t i) {
    Mat3 sum = Mat3::Zero();
    for (std::int32_t k = layout.slot_begin()[i]; k < layout.slot_begin()[i + 1]; ++k) sum += slots[layout.slots()[k]];
    SetBoth(layout.shared()[i], sum, values);
  });
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
        return UntanglingForces<Element>(model, x, chunk, Numbers(force), workspace.slot_sums.data());
      });
      return;
    }
    ChunkTask<double> task = MatrixTaskOf(model, potential, x, acting, chunk);
    task.sums = Numbers(force);
    task.slot_sums = workspace.slot_sums.data();
    workspace.reports[c] = KernelsOf<double>(model, *workspace.kernels).forces(task);
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

void AssembleStiffness(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                       std::span<const double> acting, const StiffnessLayout& layout, ThreadTeam& team,
                       ForceWorkspace& workspace, BlockValues& values) {
  AssembleBlocks(model, layout, team, workspace, values, [&](const Chunk& chunk, const ChunkBlocks& blocks) {
    if (!potential.untangling) {
      KernelsOf<double>(model, *workspace.kernels).stiffness(MatrixTaskOf(model, potential, x, acting, chunk), blocks);
      return;
    }
    model.VisitElement([&]<class Element>(Element) { AddUntanglingStiffness<Element>(model, x, chunk, blocks); });
  });
}

void AssembleProjection(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                        std::span<const double> acting, const StiffnessLayout& layout, ThreadTeam& team,
                        ForceWorkspace& workspace, BlockValues& values) {
  AssembleBlocks(model, layout, team, workspace, values, [&](const Chunk& chunk, const ChunkBlocks& blocks) {
    model.VisitElement(
        [&]<class Element>(Element) { AddProjection<Element>(model, potential, x, acting, chunk, blocks); });
  });
}

}  // namespace fascicle
