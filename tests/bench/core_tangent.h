#ifndef FASCICLE_TESTS_BENCH_CORE_TANGENT_H_
#define FASCICLE_TESTS_BENCH_CORE_TANGENT_H_

#include "core/tet/stable_step.h"

namespace fascicle::bench {

// What core does for a force and a tangent at one state, behind one name for all benchmarks.
class CoreTangent {
 public:
  // What Evaluate leaves out of what the row says, for the reader of the figures; nullptr for nothing.
  static constexpr const char* kLeftOut = "core computes its elements' tangents but writes no matrix here";

  // Both must outlive this.
  CoreTangent(const TetModel& model, ThreadTeam& team) : model_(model), team_(team) {}

  void Evaluate(const FibreDrive& drive, const NodalVector& x) {
    ElasticForce(model_, drive, x, team_, workspace_, force_);
    stiffness_.Set(model_, drive, x, team_, workspace_);
  }
  // Of the last Evaluate: force [N], and the tangent times p.
  const NodalVector& force() const { return force_; }
  NodalVector Product(const NodalVector& p) {
    NodalVector product;
    stiffness_.Apply(model_, p, team_, workspace_, product);
    return product;
  }

 private:
  const TetModel& model_;
  ThreadTeam& team_;
  ForceWorkspace workspace_;
  TetStiffness stiffness_;
  NodalVector force_;
};

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_CORE_TANGENT_H_
