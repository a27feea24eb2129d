#include "core/voxel/multigrid.h"

#include <cmath>

#include "core/linalg/lanczos.h"

namespace fascicle {
namespace {

// Rigid pieces replace the next level if less than this fraction of its bricks would be solid and the level has few
// enough nodes for their matrix to be factored.
constexpr double kLeastFilling = 0.85;
constexpr std::int32_t kMostNodesOfPieces = 15000;
// Degree of the smoothing polynomials: on the finest level, and on coarser ones, where work is cheap.
constexpr int kSmoothing = 5, kSmoothingBelow = 8;
// The polynomials damp the part of the spectrum between this multiple of the largest eigenvalue and the eigenvalue
// itself.
constexpr float kDamped = 1.0f / 40;
constexpr int kPowerIterations = 12;
constexpr double kEigenvalueMargin = 1.1;

double VolumeOf(const VoxelMesh& mesh) { return mesh.voxels() * mesh.spacing().prod(); }

}  // namespace

struct VoxelMultigrid::Level {
  Level(const VoxelMesh& m, VoxelStiffness stiffness, std::optional<BrickRotations<float>> rotations)
      : mesh(&m), K(m, std::move(stiffness), std::move(rotations)) {}
  Level(VoxelMesh m, const LevelStiffness& fine, const FixedComponents& fixed, ThreadTeam& team)
      : own_mesh(std::move(m)), mesh(&own_mesh), K(own_mesh, fine, fixed, team) {}

  // `diagonal`: D, or empty.
  void SetUp(const std::vector<std::size_t>& fixed_numbers, VoxelField<float> diagonal, ThreadTeam& team) {
    shift = std::move(diagonal);
    for (const std::size_t k : fixed_numbers) {
      if (shift.size() > 0) shift.data()[k] = 0;
    }
    inverse_diagonal = K.Diagonal();
    for (std::size_t k = 0; k < inverse_diagonal.size(); ++k) {
      float& entry = inverse_diagonal.data()[k];
      if (shift.size() > 0) entry += shift.data()[k];
      entry = entry > 0 ? 1 / entry : 0;
    }
    for (const std::size_t k : fixed_numbers) inverse_diagonal.data()[k] = 0;
    for (VoxelField<float>* field : {&r, &x, &d, &q}) *field = VoxelField<float>(mesh->nodes());
    if (mesh == &own_mesh) first_result = VoxelField<float>(mesh->nodes());
    FindLargestEigenvalue(team);
  }

  // y = (K + D) x.
  void Multiply(const VoxelField<float>& of, ThreadTeam& team, VoxelField<float>& y) const {
    K.Apply(of, team, y);
    if (shift.size() == 0) return;
    const float *const by = shift.data(), *const from = of.data();
    float* const to = y.data();
    ForNumbers(team, y.size(), [=](std::size_t k) { to[k] += by[k] * from[k]; });
  }

  // For the matrix preconditioned by its diagonal, by power iteration.
  void FindLargestEigenvalue(ThreadTeam& team) {
    for (int c = 0; c < 3; ++c) {
      for (std::int32_t n = 0; n < mesh->nodes(); ++n) {
        d(n, c) =
            inverse_diagonal(n, c) > 0 ? static_cast<float>(HashedUnit(3 * static_cast<std::uint64_t>(n) + c)) : 0;
      }
    }
    double length = std::sqrt(Dot(team, d, d));
    for (int i = 0; i < kPowerIterations && length > 0; ++i) {
      Multiply(d, team, q);
      const auto scale = static_cast<float>(1 / length);
      ForNumbers(team, d.size(),
                 [this, scale](std::size_t k) { d.data()[k] = inverse_diagonal.data()[k] * q.data()[k] * scale; });
      length = std::sqrt(Dot(team, d, d));
    }
    largest_eigenvalue = static_cast<float>(kEigenvalueMargin * length);
  }

  // x += q(A) r and r -= A q(A) r, where A is the matrix preconditioned by its diagonal and q a polynomial; the last
  // part of r only on request.
  enum class Start { kZero, kX };
  void Smooth(Start start, bool with_residual, ThreadTeam& team) {
    const float centre = 0.5f * (1 + kDamped) * largest_eigenvalue, half = 0.5f * (1 - kDamped) * largest_eigenvalue;
    const float sigma = centre / half;
    float rho = 1 / sigma;
    const int degree = mesh == &own_mesh ? kSmoothingBelow : kSmoothing;
    First(start, 1 / centre, team);
    for (int k = 1; k < degree; ++k) {
      const float next = 1 / (2 * sigma - rho);
      Multiply(d, team, q);
      Next(next * rho, 2 * next / half, team);
      rho = next;
    }
    if (!with_residual) return;
    Multiply(d, team, q);
    SubtractProduct(team);
  }
  void First(Start start, float factor, ThreadTeam& team) {
    float* const to = x.data();
    float* const step = d.data();
    const float* const residual = r.data();
    const float* const inverse = inverse_diagonal.data();
    ForNumbers(team, x.size(), [=](std::size_t k) {
      step[k] = factor * (inverse[k] * residual[k]);
      to[k] = start == Start::kZero ? step[k] : to[k] + step[k];
    });
  }
  void Next(float of_step, float of_residual, ThreadTeam& team) {
    float* const to = x.data();
    float* const step = d.data();
    float* const residual = r.data();
    const float* const product = q.data();
    const float* const inverse = inverse_diagonal.data();
    ForNumbers(team, x.size(), [=](std::size_t k) {
      residual[k] -= product[k];
      step[k] = of_step * step[k] + of_residual * (inverse[k] * residual[k]);
      to[k] += step[k];
    });
  }
  void SubtractProduct(ThreadTeam& team) {
    float* const residual = r.data();
    const float* const product = q.data();
    ForNumbers(team, r.size(), [=](std::size_t k) { residual[k] -= product[k]; });
  }

  VoxelMesh own_mesh;
  const VoxelMesh* mesh;
  LevelStiffness K;
  VoxelField<float> shift;  // D, zero at prescribed components; empty: none
  std::unique_ptr<VoxelTransfer> to_coarser;
  VoxelField<float> inverse_diagonal;  // zero at prescribed components
  float largest_eigenvalue = 0;
  VoxelField<float> first_result;  // of the first of two cycles; not on the finest level
  VoxelField<float> r, x, d, q;    // residual, result, step, K times the step
};

VoxelMultigrid::VoxelMultigrid(const VoxelMesh& mesh, const VoxelStiffness& stiffness, const FixedComponents& fixed,
                               ThreadTeam& team, const std::vector<double>& shift,
                               std::optional<BrickRotations<float>> rotations, std::int32_t most_factored)
    : fixed_(fixed) {
  levels_.push_back(std::make_unique<Level>(mesh, stiffness, std::move(rotations)));
  Level* level = levels_.back().get();
  for (std::size_t n = 0; n < fixed_.size(); ++n) {
    for (int d = 0; d < 3; ++d) {
      if (fixed_[n] >> d & 1) fixed_numbers_.push_back(d * VoxelField<float>::StrideOf(mesh.nodes()) + n);
    }
  }
  VoxelField<float> diagonal;
  if (!shift.empty()) diagonal = VoxelField<float>(mesh.nodes());
  for (std::size_t n = 0; n < shift.size(); ++n) {
    for (int d = 0; d < 3; ++d) diagonal.component(d)[n] = static_cast<float>(shift[n]);
  }
  level->SetUp(fixed_numbers_, std::move(diagonal), team);
  while (level->mesh->nodes() > most_factored) {
    VoxelMesh coarser = LevelStiffness::CoarserMesh(*level->mesh);
    if (coarser.nodes() >= level->mesh->nodes()) break;
    const double filling = VolumeOf(mesh) / VolumeOf(coarser);
    if (filling < kLeastFilling && level->mesh->nodes() <= kMostNodesOfPieces) {
      pieces_ = std::make_unique<RigidPieces>(level->K, level->shift, level->inverse_diagonal,
                                              level->largest_eigenvalue, team);
      ok_ = pieces_->ok();
      return;
    }
    levels_.push_back(
        std::make_unique<Level>(std::move(coarser), level->K, levels_.size() == 1 ? fixed_ : FixedComponents(), team));
    Level* const next = levels_.back().get();
    level->to_coarser = std::make_unique<VoxelTransfer>(*level->mesh, *next->mesh);
    VoxelField<float> coarser_diagonal;
    if (!shift.empty()) {
      coarser_diagonal = VoxelField<float>(next->mesh->nodes());
      level->to_coarser->Transpose(level->shift, team, coarser_diagonal);
    }
    next->SetUp({}, std::move(coarser_diagonal), team);
    level = next;
  }
  ok_ = FactorCoarsest(team);
}

VoxelMultigrid::~VoxelMultigrid() = default;

VoxelField<float>& VoxelMultigrid::side() { return levels_[0]->r; }
const VoxelField<float>& VoxelMultigrid::result() const { return levels_[0]->x; }

void VoxelMultigrid::Cycle(ThreadTeam& team) {
  for (const std::size_t k : fixed_numbers_) levels_[0]->r.data()[k] = 0;
  CycleFrom(0, team);
}

void VoxelMultigrid::CycleFrom(std::size_t l, ThreadTeam& team) {
  const bool is_last = l + 1 == levels_.size();
  if (is_last && !pieces_) {
    SolveCoarsest();
    return;
  }
  Level& level = *levels_[l];
  const auto clear_fixed = [&](VoxelField<float>& field) {
    if (l > 0) return;
    for (const std::size_t k : fixed_numbers_) field.data()[k] = 0;
  };
  level.Smooth(Level::Start::kZero, /*with_residual=*/true, team);
  clear_fixed(level.r);
  if (is_last) {
    pieces_->Correct(level.r, team, level.d);
  } else {
    CorrectByNext(l, team);
  }
  clear_fixed(level.d);
  level.Multiply(level.d, team, level.q);
  ForNumbers(team, level.x.size(), [&level](std::size_t k) {
    level.x.data()[k] += level.d.data()[k];
    level.r.data()[k] -= level.q.data()[k];
  });
  level.Smooth(Level::Start::kX, /*with_residual=*/false, team);
}

void VoxelMultigrid::CorrectByNext(std::size_t l, ThreadTeam& team) {
  Level& level = *levels_[l];
  Level& next = *levels_[l + 1];
  level.to_coarser->Transpose(level.r, team, next.r);
  CycleFrom(l + 1, team);
  if (l + 2 < levels_.size() || pieces_) ImproveBySecondCycle(l, team);
  level.to_coarser->Interpolate(next.x, team, level.d);
}

void VoxelMultigrid::ImproveBySecondCycle(std::size_t l, ThreadTeam& team) {
  Level& level = *levels_[l];
  Level& next = *levels_[l + 1];
  VoxelField<float>& first = next.first_result;
  std::swap(first, next.x);
  level.to_coarser->Transpose(level.r, team, next.r);
  next.Multiply(first, team, next.q);
  next.SubtractProduct(team);
  CycleFrom(l + 1, team);
  ForNumbers(team, first.size(), [&](std::size_t k) { next.x.data()[k] += first.data()[k]; });
}

void VoxelMultigrid::Apply(const VoxelField<double>& r, ThreadTeam& team, VoxelField<double>& z) {
  VoxelField<float>& to = side();
  const double size = std::sqrt(Dot(team, r, r));
  const double scale = size > 0 ? 1 / size : 0;  // keeps numbers away from the limits of single precision
  ForNumbers(team, r.size(), [&](std::size_t k) { to.data()[k] = static_cast<float>(scale * r.data()[k]); });
  Cycle(team);
  const VoxelField<float>& from = result();
  ForNumbers(team, r.size(), [&](std::size_t k) { z.data()[k] = size * static_cast<double>(from.data()[k]); });
}

bool VoxelMultigrid::FactorCoarsest(ThreadTeam& team) {
  const Level& level = *levels_.back();
  BlockMatrix matrix = AssembleLevel(level.K, level.shift);
  FreeComponents free(level.mesh->nodes());
  for (std::int32_t n = 0; n < level.mesh->nodes(); ++n) {
    for (int d = 0; d < 3; ++d) free[n][d] = level.inverse_diagonal(n, d) > 0;
  }
  IsolatePrescribed(matrix.pattern, free, team, matrix.values);
  return coarsest_.Factor(matrix.pattern, matrix.values);
}

void VoxelMultigrid::SolveCoarsest() {
  Level& level = *levels_.back();
  const std::span<double> side = coarsest_.side();
  for (std::int32_t n = 0; n < level.mesh->nodes(); ++n) {
    for (int d = 0; d < 3; ++d) side[3 * n + d] = static_cast<double>(level.r(n, d));
  }
  coarsest_.Solve();
  for (std::int32_t n = 0; n < level.mesh->nodes(); ++n) {
    // Motions of coarse nodes that move no free node are ignored.
    for (int d = 0; d < 3; ++d) {
      level.x(n, d) = level.inverse_diagonal(n, d) > 0 ? static_cast<float>(side[3 * n + d]) : 0;
    }
  }
}

std::string VoxelMultigrid::Description() const {
  std::string text;
  for (const auto& level : levels_) {
    if (!text.empty()) text += " + ";
    text += std::to_string(level->mesh->voxels());
    if (level->K.own_matrices() > 0) text += " (" + std::to_string(level->K.own_matrices()) + " of their own)";
  }
  text += " voxels";
  if (pieces_) text += " + " + std::to_string(pieces_->unknowns() / 6) + " pieces";
  return text;
}

std::size_t VoxelMultigrid::bytes() const {
  std::size_t sum = pieces_ ? pieces_->bytes() : 0;
  for (const auto& level : levels_) {
    sum += level->K.bytes() + (5 * level->r.size() + level->first_result.size() + level->shift.size()) * sizeof(float);
  }
  return sum;
}

}  // namespace fascicle
