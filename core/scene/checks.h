#ifndef FASCICLE_CORE_SCENE_CHECKS_H_
#define FASCICLE_CORE_SCENE_CHECKS_H_

#include "core/scene/scene.h"

// The checks that CheckScene runs, one to a file. Each adds what it finds to `problems` and leaves the rest alone.
namespace fascicle::scene_checks {

// At least one body; each of the method's shape and not empty, with a positive density and a name of its own.
void CheckBodies(const Scene& scene, Problems& problems);
// Materials of the parts of a body: one for each element, of those that there are.
void CheckMaterials(const Scene& scene, Problems& problems);
// Activations within [0, 1]; those of the parts of a body as materials are; what reaches each tetrahedron.
void CheckActivations(const Scene& scene, Problems& problems);
// Initial displacements: one for each node, finite.
void CheckInitialDisplacement(const Scene& scene, Problems& problems);
// Fibre directions where a law needs them: one for each tetrahedron, finite and of unit length.
void CheckFibres(const Scene& scene, Problems& problems);
// Every curve of the scene: as many values as times, times increasing, all finite.
void CheckCurves(const Scene& scene, Problems& problems);
// Constraints that name a region of the body and do not ask two things of one node.
void CheckConstraints(const Scene& scene, Problems& problems);
// Loads on regions that exist, have nodes, and have surface where the load needs one.
void CheckLoads(const Scene& scene, Problems& problems);
// A load or gravity that nothing, not even a floor, holds against: the body would fly away.
void CheckSupports(const Scene& scene, Problems& problems);
// Floors with a unit normal, that no body starts in.
void CheckFloors(const Scene& scene, Problems& problems);
// Probes that follow a node that exists; the number of frames; duration.
void CheckOutput(const Scene& scene, Problems& problems);

// What a method has no answer for; of scenes of other methods, what it alone knows. Their settings together.
// tet: single precision in steps that are solved for.
void CheckTet(const Scene& scene, Problems& problems);
// voxel: other laws than its two, activation, floors, damping that is not proportional to mass, single axes held across
// the axes of an image.
void CheckVoxel(const Scene& scene, Problems& problems);
// eulerian: tags of supports, single axes, floors, damping that is not proportional to mass, laws that depend on speed;
// numbers of plasticity and force fields, and force fields in scenes of other methods.
void CheckEulerian(const Scene& scene, Problems& problems);

}  // namespace fascicle::scene_checks

#endif  // FASCICLE_CORE_SCENE_CHECKS_H_
