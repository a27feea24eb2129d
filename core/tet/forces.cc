#include "core/tet/forces.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/tet/chunk_tasks.h"
#include "core/tet/points.h"

namespace fascicle {
namespace {

// Inputs and outputs of a loop over elements; null pointers for unused ones.
struct Action {
  bool elastic = true;
  const FibreDrive* drive = nullptr;
  const NodalVector* x = nullptr;
  const NodalVector* v = nullptr;
  bool with_energy = false;
};

template <class S>
ChunkTask<S> TaskOf(const TetModel& model, const Chunk& chunk, const Action& action, const ForceWorkspace& workspace) {
  ChunkTask<S> task = TaskOf<S>(model, chunk, model.chunks().node_sums);
  task.x = Numbers(*action.x);
  task.with_energy = action.with_energy;
  if (action.elastic) {
    SetDrive(model, *action.drive, task);
    if (!model.patches().empty()) task.pressure = workspace.pressure.data();
  } else {
    task.law = nullptr;
  }
  const TetBody& body = model.bodies()[model.groups()[chunk.group].body];
  if (action.v != nullptr) {
    task.v = Numbers(*action.v);
    task.mu = body.damping_mu;
    task.lambda = body.damping_lambda;
  }
  return task;
}

ForceReport AllForces(const TetModel& model, const Action& action, ThreadTeam& team, ForceWorkspace& workspace,
                      NodalVector& force) {
  const ElementChunks& chunks = model.chunks();
  force.resize(model.nodes());
  workspace.slot_sums.resize(std::max(workspace.slot_sums.size(), 3 * chunks.node_sums.slots.size()));
  workspace.reports.resize(chunks.chunks.size());
  ForceReport total;
  if (action.elastic) total.valid = UpdatePatches(model, *action.x, team, workspace);
  VisitKernels(model, *workspace.kernels, [&]<class S>(const ElementKernels<S>& kernels) {
    ForChunks(model, team, [&](const Chunk& chunk, std::size_t c) {
      ChunkTask<S> task = TaskOf<S>(model, chunk, action, workspace);
      task.sums = Numbers(force);
      task.slot_sums = workspace.slot_sums.data();
      workspace.reports[c] = kernels.forces(task);
    });
  });
  AddSlots<3>(chunks.node_sums, workspace.slot_sums.data(), team, Numbers(force));
  for (const ChunkReport& report : workspace.reports) {
    total.valid &= report.finite && report.smallest_ratio > 0;
    total.dissipated_power += report.dissipated_power;
    if (!(report.smallest_ratio >= total.smallest_ratio)) total.smallest_ratio = report.smallest_ratio;
  }
  return total;
}

// Contribution of a corner with rest shape gradient g to the diagonal of -D, per unit volume: twice the dissipation of
// a unit velocity of that corner along each axis i, where Edot = sym(F_i x g) with F_i row i of F.
Vec3 CornerDiagonal(const Mat3& F, const Vec3& g, double mu, double lambda) {
  const Vec3 rate = F * g;  // F_i . g for each i
  Vec3 diagonal;
  for (int i = 0; i < 3; ++i) {
    diagonal[i] = mu * (F.row(i).squaredNorm() * g.squaredNorm() + rate[i] * rate[i]) + lambda * rate[i] * rate[i];
  }
  return diagonal;
}

// Adds the diagonal of -D of one element to its chunk's nodes.
template <class Element>
void AddDiagonal(const TetModel& model, const TetBody& body, const NodalVector& x, std::size_t e,
                 std::array<Vec3, kChunkNodes>& sums) {
  const std::size_t slot = model.chunks().slot[e];
  const std::uint16_t* local = &model.chunks().local[Element::kNodes * kBlock * (slot / kBlock) + slot % kBlock];
  const auto positions = ValuesOf<Element>(model, e, x);
  for (int q = 0; q < Element::kPoints; ++q) {
    const Mat3 F = GradientAt<Element>(model, e, positions, q);
    const auto gradients = ShapeGradients<Element>(model, e, q);
    const double volume = model.rest_volume()[Element::kPoints * e + q];
    for (int a = 0; a < Element::kNodes; ++a) {
      sums[local[kBlock * a]] += volume * CornerDiagonal(F, gradients.col(a), body.damping_mu, body.damping_lambda);
    }
  }
}

// An element's share of the patches' energy [J]: the energy density of each patch times the volume of the element's
// part in it.
template <class Element>
double PatchEnergyOf(const TetModel& model, const ForceWorkspace& workspace, std::size_t e) {
  const VolumePatches& patches = model.patches();
  if (patches.empty() || patches.of_element[e][0] == VolumePatches::kNone) return 0;
  double energy = 0;
  for (int c = 0; c < Element::kPatches; ++c) {
    const std::int32_t n = patches.of_element[e][c];
    energy += model.CornerVolume<Element>(e, c) * PatchEnergy{patches.modulus[n]}.Value(workspace.ratio[n]);
  }
  return energy;
}

}  // namespace

ForceReport ElasticForce(const TetModel& model, const FibreDrive& drive, const NodalVector& x, ThreadTeam& team,
                         ForceWorkspace& workspace, NodalVector& force) {
  return AllForces(model, {true, &drive, &x}, team, workspace, force);
}

ForceReport ElasticAndViscousForce(const TetModel& model, const FibreDrive& drive, const NodalVector& x,
                                   const NodalVector& v, ThreadTeam& team, ForceWorkspace& workspace,
                                   NodalVector& force) {
  return AllForces(model, {true, &drive, &x, &v}, team, workspace, force);
}

void ViscousForce(const TetModel& model, const NodalVector& x, const NodalVector& v, ThreadTeam& team,
                  ForceWorkspace& workspace, NodalVector& force) {
  AllForces(model, {false, nullptr, &x, &v}, team, workspace, force);
}

void ViscousDiagonal(const TetModel& model, const NodalVector& x, ThreadTeam& team, ForceWorkspace& workspace,
                     NodalVector& diagonal) {
  const ElementChunks& chunks = model.chunks();
  diagonal.resize(model.nodes());
  workspace.slot_sums.resize(std::max(workspace.slot_sums.size(), 3 * chunks.node_sums.slots.size()));
  model.VisitElement([&]<class Element>(Element) {
    ForChunks(model, team, [&](const Chunk& chunk, std::size_t) {
      const TetBody& body = model.bodies()[model.groups()[chunk.group].body];
      std::array<Vec3, kChunkNodes> sums;
      std::fill_n(sums.begin(), chunk.node_end - chunk.node_begin, Vec3::Zero());
      for (std::size_t e = chunk.tet_begin; e < chunk.tet_end; ++e) {
        AddDiagonal<Element>(model, body, x, e, sums);
      }
      for (std::size_t i = chunk.node_begin; i < chunk.node_end; ++i) {
        const std::int32_t target = chunks.node_sums.target[i];
        double* to = target >= 0 ? diagonal[target].data() : &workspace.slot_sums[3 * std::size_t(~target)];
        std::copy_n(sums[i - chunk.node_begin].data(), 3, to);
      }
    });
  });
  AddSlots<3>(chunks.node_sums, workspace.slot_sums.data(), team, Numbers(diagonal));
}

double ElasticEnergy(const TetModel& model, std::size_t body, const FibreDrive& drive, const NodalVector& x,
                     ThreadTeam& team) {
  ForceWorkspace workspace;
  workspace.reports.resize(model.chunks().chunks.size());
  UpdatePatches(model, x, team, workspace);
  const Action action{true, &drive, &x, nullptr, true};
  VisitKernels(model, *workspace.kernels, [&]<class S>(const ElementKernels<S>& kernels) {
    ForChunks(model, team, [&](const Chunk& chunk, std::size_t c) {
      if (model.groups()[chunk.group].body != body) return;
      workspace.reports[c] = kernels.forces(TaskOf<S>(model, chunk, action, workspace));
    });
  });
  double total = 0;
  for (const ChunkReport& report : workspace.reports) total += report.energy;
  const TetBody& elements = model.bodies()[body];
  return model.VisitElement([&]<class Element>(Element) {
    return total + team.Sum(elements.tet_end - elements.tet_begin, [&](std::size_t begin, std::size_t end) {
      double energy = 0;
      for (std::size_t e = elements.tet_begin + begin; e < elements.tet_begin + end; ++e) {
        energy += PatchEnergyOf<Element>(model, workspace, e);
      }
      return energy;
    });
  });
}

bool UpdatePatches(const TetModel& model, const NodalVector& x, ThreadTeam& team, ForceWorkspace& workspace) {
  const VolumePatches& patches = model.patches();
  if (patches.empty()) return true;
  for (auto* values : {&workspace.raw_ratio, &workspace.ratio, &workspace.own_pressure, &workspace.pressure}) {
    values->resize(patches.size());
  }
  const Sharing& sharing = model.chunks().patch_sums;
  workspace.slot_sums.resize(std::max(workspace.slot_sums.size(), sharing.slots.size()));
  VisitKernels(model, *workspace.kernels, [&]<class S>(const ElementKernels<S>& kernels) {
    ForChunks(model, team, [&](const Chunk& chunk, std::size_t) {
      if (!HasPatches(model, chunk)) return;
      ChunkTask<S> task = TaskOf<S>(model, chunk, sharing);
      task.x = Numbers(x);
      task.sums = workspace.raw_ratio.data();
      task.slot_sums = workspace.slot_sums.data();
      kernels.corner_volumes(task);
    });
  });
  AddSlots<1>(sharing, workspace.slot_sums.data(), team, workspace.raw_ratio.data());
  ForPatches(patches, team, [&](std::size_t n) { workspace.raw_ratio[n] /= patches.rest_volume[n]; });
  std::atomic<bool> valid = true;
  team.For(patches.size(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
    patches.SmoothRows(begin, end, workspace.raw_ratio, workspace.ratio);
    workspace.kernels->patch_pressure(end - begin, &patches.modulus[begin], &workspace.ratio[begin],
                                      &workspace.own_pressure[begin]);
    bool positive = true;
    for (std::size_t n = begin; n < end; ++n) positive &= workspace.ratio[n] > 0;
    if (!positive) valid.store(false, std::memory_order_relaxed);
  });
  team.For(patches.size(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
    patches.SmoothRows(begin, end, workspace.own_pressure, workspace.pressure);
  });
  return valid.load();
}

}  // namespace fascicle
