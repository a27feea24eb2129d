#ifndef FASCICLE_TESTS_BENCH_CORE_TANGENT_H_
#define FASCICLE_TESTS_BENCH_CORE_TANGENT_H_

#include "core/tet/saddle_matrix.h"

namespace fascicle::bench {

// The core's force and tangent at one state, with one interface for all benchmarks: the force of explicit steps and the
// block-sparse matrix of implicit steps.
class CoreTangent {
 public:
  // Both must outlive this.
  CoreTangent(const TetModel& model, ThreadTeam& team) : model_(model), team_(team), assembly_(model) {}

  void Evaluate(const FibreDrive& drive, const NodalVector& x) {
    ElasticForce(model_, drive, x, team_, workspace_, force_);
    potential_.drive = drive;
    assembly_.Assemble(potential_, x, {workspace_.pressure, workspace_.ratio, {}}, team_, workspace_);
  }
  // Of the last Evaluate: force [N], and the tangent times p.
  const NodalVector& force() const { return force_; }
  NodalVector Product(const NodalVector& p) {
    NodalVector product;
    Multiply(assembly_.matrix().pattern, assembly_.matrix().A, p, team_, product);
    return product;
  }

 private:
  const TetModel& model_;
  ThreadTeam& team_;
  ForceWorkspace workspace_;
  IncrementalPotential potential_;
  SaddleAssembly assembly_;
  NodalVector force_;
};

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_CORE_TANGENT_H_
