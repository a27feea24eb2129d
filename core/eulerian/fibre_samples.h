#ifndef FASCICLE_CORE_EULERIAN_FIBRE_SAMPLES_H_
#define FASCICLE_CORE_EULERIAN_FIBRE_SAMPLES_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/eulerian/grid.h"
#include "core/geometry/tet_mesh.h"
#include "core/muscle/fibre_field.h"

namespace fascicle {

// Fibre directions of tetrahedra at the nodes of a grid, to be asked for at points of the material. Const; may be asked
// from several threads at once.
class FibreSamples {
 public:
  // Nodes in a tetrahedron take its direction, others that of the nearest of these, layer by layer. One direction
  // without tetrahedra holds everywhere.
  FibreSamples(const TetMesh& mesh, const FibreField& fibres, const EulerianGrid& samples, ThreadTeam& team);

  // Unit; trilinear between nodes.
  Vec3 At(const Vec3& X) const;

 private:
  EulerianGrid samples_;
  std::vector<Vec3> direction_;  // at the nodes
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_FIBRE_SAMPLES_H_
