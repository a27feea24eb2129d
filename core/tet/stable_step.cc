#include "core/tet/stable_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tet/chunk_tasks.h"
#include "core/tet/contact.h"

namespace fascicle {
namespace {

// Relative residual of the eigenvalue at which Lanczos stops; the error of the step is half of it.
constexpr double kEigenvalueTolerance = 0.02;

}  // namespace

void TetStiffness::Set(const TetModel& model, const FibreDrive& drive, const NodalVector& x, ThreadTeam& team,
                       ForceWorkspace& workspace) {
  const VolumePatches& patches = model.patches();
  drive_ = drive;
  x_ = &x;
  slopes_.resize(patches.size());
  pressure_change_.resize(patches.size());
  UpdatePatches(model, x, team, workspace);
  for (std::size_t n = 0; n < patches.size(); ++n) {
    slopes_[n] = PatchEnergy{patches.modulus[n]}.Slope(workspace.ratio[n]);
  }
}

void TetStiffness::Apply(const TetModel& model, const NodalVector& p, ThreadTeam& team, ForceWorkspace& workspace,
                         NodalVector& product) {
  const Sharing& sharing = model.chunks().node_sums;
  product.resize(model.nodes());
  workspace.slot_sums.resize(std::max(workspace.slot_sums.size(), 3 * sharing.slots.size()));
  ApplyToPatches(model, p, team, workspace);
  VisitKernels(model, *workspace.kernels, [&]<class S>(const ElementKernels<S>& kernels) {
    ForChunks(model, team, [&](const Chunk& chunk, std::size_t) {
      ChunkTask<S> task = TaskOf<S>(model, chunk, sharing);
      task.x = Numbers(*x_);
      task.p = Numbers(p);
      SetDrive(model, drive_, chunk, task);
      if (!model.patches().empty()) {
        task.pressure = workspace.pressure.data();
        task.pressure_change = pressure_change_.data();
      }
      task.sums = Numbers(product);
      task.slot_sums = workspace.slot_sums.data();
      kernels.stiffness_product(task);
    });
  });
  AddSlots<3>(sharing, workspace.slot_sums.data(), team, Numbers(product));
  AddFloorStiffness(model, p, product);
  AddContactBound(model, p, product);
  AddSpringStiffness(model, p, product);
}

void TetStiffness::ApplyToPatches(const TetModel& model, const NodalVector& p, ThreadTeam& team,
                                  ForceWorkspace& workspace) {
  const VolumePatches& patches = model.patches();
  if (patches.empty()) return;
  const Sharing& sharing = model.chunks().patch_sums;
  std::vector<double>& change = workspace.raw_ratio;
  VisitKernels(model, *workspace.kernels, [&]<class S>(const ElementKernels<S>& kernels) {
    ForChunks(model, team, [&](const Chunk& chunk, std::size_t) {
      if (!HasPatches(model, chunk)) return;
      ChunkTask<S> task = TaskOf<S>(model, chunk, sharing);
      task.x = Numbers(*x_);
      task.p = Numbers(p);
      task.sums = change.data();
      task.slot_sums = workspace.slot_sums.data();
      kernels.corner_volume_changes(task);
    });
  });
  AddSlots<1>(sharing, workspace.slot_sums.data(), team, change.data());
  ForPatches(patches, team, [&](std::size_t n) { change[n] /= patches.rest_volume[n]; });
  const auto smooth = [&](const std::vector<double>& in, std::vector<double>& out) {
    ForPatches(patches, team, [&](std::size_t n) { patches.SmoothRows(n, n + 1, in, out); });
  };
  smooth(change, pressure_change_);
  ForPatches(patches, team, [&](std::size_t n) { change[n] = slopes_[n] * pressure_change_[n]; });
  smooth(change, pressure_change_);
}

double LargestStableStep(const TetModel& model, const FibreDrive& drive, const NodalVector& x, bool explicit_damping,
                         ThreadTeam& team, ForceWorkspace& forces, StableStepWorkspace& workspace) {
  TetStiffness& stiffness = workspace.stiffness;
  NodalVector& inverse_root_mass = workspace.inverse_root_mass;
  LanczosWorkspace& lanczos = workspace.lanczos;
  inverse_root_mass.resize(model.nodes());
  ForNodes(team, model.nodes(), [&](std::size_t n) { inverse_root_mass[n] = model.inverse_mass()[n].cwiseSqrt(); });

  stiffness.Set(model, drive, x, team, forces);
  const auto apply_stiffness = [&](const NodalVector& p, NodalVector& q) {
    stiffness.Apply(model, p, team, forces, q);
  };
  // Not std::max, which would drop NaN.
  const double omega_squared =
      LargestEigenvalue(team, apply_stiffness, inverse_root_mass, kEigenvalueTolerance, lanczos);
  double rate = 0;  // 2 xi omega [1/s]
  if (explicit_damping && model.has_strain_damping()) {
    const auto apply_damping = [&](const NodalVector& p, NodalVector& q) {
      ViscousForce(model, x, p, team, forces, q);
      ForNodes(team, model.nodes(), [&](std::size_t n) { q[n] = -q[n]; });
    };
    rate = LargestEigenvalue(team, apply_damping, inverse_root_mass, kEigenvalueTolerance, lanczos);
  }
  if (!std::isfinite(omega_squared) || !std::isfinite(rate)) return std::numeric_limits<double>::quiet_NaN();
  // (omega dt)^2 + 2 rate dt = 4, in a form without cancellation.
  const double stiffness_part = omega_squared > 0 ? omega_squared : 0;
  return 4 / (rate + std::sqrt(rate * rate + 4 * stiffness_part));
}

}  // namespace fascicle
