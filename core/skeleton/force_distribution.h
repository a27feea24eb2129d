#ifndef FASCICLE_CORE_SKELETON_FORCE_DISTRIBUTION_H_
#define FASCICLE_CORE_SKELETON_FORCE_DISTRIBUTION_H_

#include <Eigen/Core>

#include <vector>

namespace fascicle {

// The activations by which muscles exert given generalized forces with the least effort [Teran 2003, 7]:
//
//   minimize sum a_m^2   subject to   sum_m capacity_jm a_m = demand_j,   0 <= a_m <= 1
//
// Where no activations do that, those whose generalized forces are nearest to the demand in the least-squares sense,
// each component relative to the largest of its capacities.
struct Distribution {
  Eigen::VectorXd activations;  // one for each muscle
  // demand - capacity * activations: what each coordinate lacks, to be borne by something else [N m or N]. Zero, to
  // rounding, if `feasible`.
  Eigen::VectorXd lack;
  bool feasible = true;
};

// Solves such problems one after the other; each begins with the active bounds of the last one. Not thread-safe.
class ForceDistributor {
 public:
  // capacity: coordinates x muscles, the generalized forces at full activation (moment arm times force); demand: one
  // for each coordinate. All finite.
  Distribution Solve(const Eigen::MatrixXd& capacity, const Eigen::VectorXd& demand);

 private:
  std::vector<bool> active_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_FORCE_DISTRIBUTION_H_
