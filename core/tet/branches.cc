#include "core/tet/branches.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/tet/chunk_tasks.h"

namespace fascicle {
namespace {

constexpr std::size_t kTensor = kBranchTensor;  // numbers of a tensor for the elements of a block

// Twice the off-diagonal components count in a contraction of symmetric tensors.
constexpr std::array<double, 6> kWeights = {1, 1, 1, 2, 2, 2};

// Calls visit(chunk, its number, its series) for the viscoelastic chunks, in parallel.
template <class Visit>
void ForBranches(const TetModel& model, ThreadTeam& team, const Visit& visit) {
  ForChunks(model, team, [&](const Chunk& chunk, std::size_t c) {
    if (chunk.branch_point == Chunk::kElastic) return;
    visit(chunk, c, model.groups()[chunk.group].series[chunk.law]);
  });
}

std::size_t PointsOf(const TetModel& model, const Chunk& chunk) {
  return model.points_per_element() * (chunk.block_end - chunk.block_begin);
}

// S_p and the Green strain at all points of a chunk: two tensors each.
std::vector<double> StressesAndStrains(const TetModel& model, const Chunk& chunk, const NodalVector& x,
                                       const ForceWorkspace& workspace) {
  std::vector<double> values(2 * kTensor * PointsOf(model, chunk));
  ChunkTask<double> task = TaskOf<double>(model, chunk, model.chunks().node_sums);
  task.x = Numbers(x);
  task.branch_law = BranchLawOf(model, chunk);
  KernelsOf<double>(model, *workspace.kernels).branch_states(task, values.data());
  return values;
}

}  // namespace

std::vector<double> RelaxedBranches(const TetModel& model, const NodalVector& x, ThreadTeam& team,
                                    ForceWorkspace& workspace) {
  std::vector<double> state(model.branch_points() * model.branch_numbers(), 0.0);
  ForBranches(model, team, [&](const Chunk& chunk, std::size_t, const PronySeries&) {
    const std::vector<double> values = StressesAndStrains(model, chunk, x, workspace);
    for (std::size_t p = 0; p < PointsOf(model, chunk); ++p) {
      double* const record = &state[(chunk.branch_point + p) * model.branch_numbers()];
      for (std::size_t k = 0; k < 2 * kTensor; ++k) {
        const double value = values[2 * kTensor * p + k];
        record[k] = std::isfinite(value) ? value : 0;
      }
    }
  });
  return state;
}

void SetStepDrive(const TetModel& model, const std::vector<double>& state, double h, ThreadTeam& team,
                  BranchDrive& drive) {
  drive.factor.assign(model.chunks().chunks.size(), 0.0);
  drive.stress.resize(model.branch_points() * kTensor);
  ForBranches(model, team, [&](const Chunk& chunk, std::size_t c, const PronySeries& series) {
    double factor = 0;
    std::array<double, PronySeries::kMostTerms> decay = {};
    for (std::size_t i = 0; i < series.terms.size(); ++i) {
      const BranchStep step(series.terms[i], h);
      decay[i] = step.decay;
      factor += step.gain;
    }
    drive.factor[c] = factor;
    for (std::size_t p = chunk.branch_point; p < chunk.branch_point + PointsOf(model, chunk); ++p) {
      const double* const record = &state[p * model.branch_numbers()];
      double* const stress = &drive.stress[p * kTensor];
      for (std::size_t k = 0; k < kTensor; ++k) {
        double sum = -factor * record[k];
        for (std::size_t i = 0; i < series.terms.size(); ++i) sum += decay[i] * record[(2 + i) * kTensor + k];
        stress[k] = sum;
      }
    }
  });
}

void SetStateDrive(const TetModel& model, const std::vector<double>& state, ThreadTeam& team, BranchDrive& drive) {
  drive.factor.assign(model.chunks().chunks.size(), 0.0);
  drive.stress.resize(model.branch_points() * kTensor);
  ForBranches(model, team, [&](const Chunk& chunk, std::size_t, const PronySeries& series) {
    for (std::size_t p = chunk.branch_point; p < chunk.branch_point + PointsOf(model, chunk); ++p) {
      const double* const record = &state[p * model.branch_numbers()];
      double* const stress = &drive.stress[p * kTensor];
      for (std::size_t k = 0; k < kTensor; ++k) {
        double sum = 0;
        for (std::size_t i = 0; i < series.terms.size(); ++i) sum += record[(2 + i) * kTensor + k];
        stress[k] = sum;
      }
    }
  });
}

const Chunk& ChunkOf(const TetModel& model, std::size_t tet) {
  const std::vector<Chunk>& chunks = model.chunks().chunks;
  return *std::upper_bound(chunks.begin(), chunks.end(), tet,
                           [](std::size_t t, const Chunk& chunk) { return t < chunk.tet_end; });
}

Mat3 BranchStressAt(const TetModel& model, const BranchDrive& drive, std::size_t tet, int q) {
  const Chunk& chunk = ChunkOf(model, tet);
  if (chunk.branch_point == Chunk::kElastic) return Mat3::Zero();
  const auto slot = static_cast<std::size_t>(model.chunks().slot[tet]);
  const auto points = static_cast<std::size_t>(model.points_per_element());
  const std::size_t point =
      chunk.branch_point + points * (slot / kBlock - chunk.block_begin) + static_cast<std::size_t>(q);
  const double* const c = &drive.stress[kBranchTensor * point + slot % kBlock];
  const auto at = [c](int component) { return c[component * kBlock]; };
  return (Mat3() << at(0), at(3), at(5), at(3), at(1), at(4), at(5), at(4), at(2)).finished();
}

Mat3 MeanBranchStress(const TetModel& model, const BranchDrive& drive, std::size_t tet) {
  Mat3 sum = Mat3::Zero();
  const int points = model.points_per_element();
  for (int q = 0; q < points; ++q) sum += BranchStressAt(model, drive, tet, q);
  return sum / points;
}

double AdvanceBranches(const TetModel& model, const std::vector<double>& state, const NodalVector& x, double h,
                       ThreadTeam& team, ForceWorkspace& workspace, std::vector<double>& next) {
  next.resize(state.size());
  std::vector<double> work(model.chunks().chunks.size(), 0.0);
  ForBranches(model, team, [&](const Chunk& chunk, std::size_t c, const PronySeries& series) {
    const std::vector<double> values = StressesAndStrains(model, chunk, x, workspace);
    const RestPoint<double>* const rest =
        &model.blocks<double>().points[model.points_per_element() * chunk.block_begin];
    for (std::size_t p = 0; p < PointsOf(model, chunk); ++p) {
      const double* const before = &state[(chunk.branch_point + p) * model.branch_numbers()];
      double* const after = &next[(chunk.branch_point + p) * model.branch_numbers()];
      std::copy_n(before, model.branch_numbers(), after);
      std::copy_n(&values[2 * kTensor * p], 2 * kTensor, after);
      for (std::size_t i = 0; i < series.terms.size(); ++i) {
        const BranchStep step(series.terms[i], h);
        for (std::size_t k = 0; k < kTensor; ++k) {
          const std::size_t at = (2 + i) * kTensor + k;
          after[at] = step.decay * before[at] + step.gain * (after[k] - before[k]);
          const double strain = after[kTensor + k] - before[kTensor + k];
          work[c] += 0.5 * kWeights[k / kBlock] * rest[p].volume[k % kBlock] * (before[at] + after[at]) * strain;
        }
      }
    }
  });
  double total = 0;
  for (const double of_chunk : work) total += of_chunk;
  return total;
}

}  // namespace fascicle
