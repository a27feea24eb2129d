#ifndef FASCICLE_TESTS_BENCH_BULLET_BOX_H_
#define FASCICLE_TESTS_BENCH_BULLET_BOX_H_

#include <memory>

#include "core/geometry/tet_mesh.h"
#include "core/linalg/nodal_vector.h"

namespace fascicle::bench {

// A mesh as a deformable body of Bullet, in float, with the stable neo-Hookean law of [Smith, de Goes & Kim 2018]: P =
// mu (1 - 1/(I1 + 1)) F + (lambda (J - 1) - 3/4 mu) cof F.
class BulletBox {
 public:
  // mu, lambda [Pa].
  BulletBox(const TetMesh& mesh, double mu, double lambda);
  ~BulletBox();

  void SetPositions(const NodalVector& x);
  // Deformation gradients and derived quantities, then nodal forces: what Bullet does before each step.
  void Evaluate();
  // Of the last Evaluate [N].
  NodalVector Forces() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_BULLET_BOX_H_
