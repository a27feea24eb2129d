#include "core/voxel/static_solver.h"

#include <algorithm>
#include <map>

#include "core/base/check.h"

namespace fascicle {
namespace {

// Where only the mean of the dilatation resists, coarse levels are those of bricks whose whole dilatation does, with a
// bulk modulus that does not lock: nested levels know nothing of a mean over finer bricks. What is left of the large
// modulus is up to conjugate gradients.
constexpr double kMostLambda = 4;  // times mu; Poisson's ratio 0.4

VoxelStiffness ForMultigrid(VoxelStiffness stiffness) {
  for (BrickModuli<double>& moduli : stiffness.moduli) {
    if (moduli.lambda_out == moduli.lambda) continue;
    moduli.lambda = moduli.lambda_out = std::min(moduli.lambda, kMostLambda * moduli.mu);
  }
  return stiffness;
}

}  // namespace

VoxelStaticSolver::VoxelStaticSolver(const VoxelModel& model, const std::vector<VoxelSupport>& supports,
                                     ThreadTeam& team)
    : model_(&model), team_(&team) {
  const VoxelMesh& mesh = model.mesh();
  FixedComponents fixed(mesh.nodes(), 0);
  std::map<std::size_t, double> values;
  for (const VoxelSupport& support : supports) {
    for (const GridIndex& at : support.nodes) {
      const std::int32_t node = mesh.NodeAt(at);
      FASCICLE_CHECK(node >= 0, "a support of a node that does not exist was not checked");
      for (int d = 0; d < 3; ++d) {
        if (!support.components[d]) continue;
        fixed[node] |= static_cast<std::uint8_t>(1 << d);
        values[d * VoxelField<double>::StrideOf(mesh.nodes()) + node] = support.displacement[d];
      }
    }
  }
  for (const auto& [number, value] : values) {
    fixed_numbers_.push_back(number);
    fixed_values_.push_back(value);
  }
  multigrid_ = std::make_unique<VoxelMultigrid>(mesh, ForMultigrid(model.stiffness()), fixed, team);
}

StaticSolution VoxelStaticSolver::Solve(const VoxelLoads& loads, const StaticSettings& settings,
                                        const VoxelField<double>* start) {
  StaticSolution solution;
  const std::int32_t nodes = model_->mesh().nodes();
  VoxelField<double>& u = solution.displacement;
  u = start != nullptr ? *start : VoxelField<double>(nodes);
  for (std::size_t k = 0; k < fixed_numbers_.size(); ++k) u.data()[fixed_numbers_[k]] = fixed_values_[k];
  VoxelField<double> f(nodes);
  AddForces(*model_, loads, f);
  if (!multigrid_->ok()) return solution;
  solution.iterations =
      SolveVoxels(*team_, model_->K(), *multigrid_, fixed_numbers_, f, settings.tolerance, settings.max_iterations, u);
  solution.reaction = VoxelField<double>(nodes);
  model_->K().Apply(u, *team_, solution.reaction);
  solution.energy = 0.5 * Dot(*team_, u, solution.reaction);
  ForNumbers(*team_, f.size(), [&](std::size_t k) { solution.reaction.data()[k] -= f.data()[k]; });
  return solution;
}

std::size_t VoxelStaticSolver::bytes() const {
  // u, f, and three vectors of conjugate gradients.
  return multigrid_->bytes() + 5 * 3 * VoxelField<double>::StrideOf(model_->mesh().nodes()) * sizeof(double) +
         model_->stiffness().scale.size() * sizeof(float) + model_->mesh().nodes() * sizeof(std::uint8_t) +
         fixed_numbers_.size() * (sizeof(std::size_t) + sizeof(double));
}

}  // namespace fascicle
