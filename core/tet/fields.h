#ifndef FASCICLE_CORE_TET_FIELDS_H_
#define FASCICLE_CORE_TET_FIELDS_H_

#include <vector>

#include "core/scene/controls.h"
#include "core/scene/output_fields.h"
#include "core/tet/forces.h"
#include "core/tet/state.h"

// Fields of a state, as in scene.proto Field: component fastest (tensors xx yy zz xy yz xz). Stresses include the
// elastic and active parts, not the viscous one. Fibres count as isometric.
namespace fascicle {

// The controls that act on a state, and those after another step as long as the last one.
struct StateControls {
  const Controls& now;
  const Controls& later;
};

// Values at the mesh nodes or the elements of one body. Those of elements are averages over quadrature points, or
// follow from such averages (OutputFieldInfo::mean_of). Forces on a mid-edge node count half for each end of its edge.
std::vector<double> FieldValuesOf(const TetModel& model, std::size_t body, OutputField field, const TetState& state,
                                  const StateControls& controls, ThreadTeam& team);

// A field at nodes: its values at the mesh nodes, as above, and at all nodes of the body, where a force is that on the
// node itself; `all` is empty if the body has no other nodes.
struct NodeFieldValues {
  std::vector<double> on_mesh, all;
};
NodeFieldValues NodeFieldOf(const TetModel& model, std::size_t body, OutputField field, const TetState& state,
                            const StateControls& controls, ThreadTeam& team);

// Values at a probe, which may be inside of an element; not of nodal forces, which exist at nodes only.
std::vector<double> FieldValuesAt(const TetModel& model, const Probe& probe, OutputField field, const TetState& state,
                                  const Controls& now, ThreadTeam& team);

// Displacement of a probe [m].
Vec3 DisplacementAt(const TetModel& model, const Probe& probe, const TetState& state);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FIELDS_H_
