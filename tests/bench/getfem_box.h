#ifndef FASCICLE_TESTS_BENCH_GETFEM_BOX_H_
#define FASCICLE_TESTS_BENCH_GETFEM_BOX_H_

#include <memory>

#include "core/geometry/tet_mesh.h"
#include "core/linalg/nodal_vector.h"

namespace fascicle::bench {

// A mesh of linear tetrahedra as a GetFEM model with the finite-strain brick that corresponds to NeoHookean,
// "Compressible_Neo_Hookean_Bonet"; without supports.
class GetfemBox {
 public:
  // mu, lambda [Pa].
  GetfemBox(const TetMesh& mesh, double mu, double lambda);
  ~GetfemBox();

  void SetPositions(const NodalVector& x);
  // Force and tangent matrix of all elements.
  void Assemble();
  // Of the last Assemble: forces [N], and the matrix times p.
  NodalVector Forces() const;
  NodalVector Product(const NodalVector& p) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_GETFEM_BOX_H_
