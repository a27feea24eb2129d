#ifndef FASCICLE_CORE_EULERIAN_FIBRE_SAMPLES_H_
#define FASCICLE_CORE_EULERIAN_FIBRE_SAMPLES_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/eulerian/grid.h"
#include "core/geometry/tet_mesh.h"
#include "core/muscle/fibre_field.h"

namespace fascicle {

// Fibre directions of tetrahedra, sampled at the nodes of a grid and evaluated at material points. Const, thread-safe.
class FibreSamples {
 public:
  // Nodes within a tetrahedron take its direction, other nodes that of the nearest of these, layer by layer. Without
  // tetrahedra, the single direction is used everywhere.
  FibreSamples(const TetMesh& mesh, const FibreField& fibres, const EulerianGrid& samples, ThreadTeam& team);

  // A unit vector; trilinear between nodes.
  Vec3 At(const Vec3& X) const;

 private:
  EulerianGrid samples_;
  std::vector<Vec3> direction_;  // at the nodes
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_FIBRE_SAMPLES_H_
