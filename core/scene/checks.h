#ifndef FASCICLE_CORE_SCENE_CHECKS_H_
#define FASCICLE_CORE_SCENE_CHECKS_H_

#include "core/scene/scene.h"

// The checks run by CheckScene, one per file. Each adds the problems of its subject.
namespace fascicle::scene_checks {

// At least one body unless there is a skeleton; each has the shape of the method, not empty, a positive density and a
// unique name.
void CheckBodies(const Scene& scene, Problems& problems);
// Materials of the parts of a body: every element has an existing one. Viscoelasticity of all of them.
void CheckMaterials(const Scene& scene, Problems& problems);
// Activations within [0, 1], of bodies and of their parts; activation scales.
void CheckActivations(const Scene& scene, Problems& problems);
// The start of the scene, which only the tet method has; initial displacements and velocities: one for each node,
// finite.
void CheckInitialState(const Scene& scene, Problems& problems);
// Fibre directions, if a law needs them: one for each tetrahedron, finite and of unit length.
void CheckFibres(const Scene& scene, Problems& problems);
// Every curve of the scene: as many values as times, times increasing, all finite.
void CheckCurves(const Scene& scene, Problems& problems);
// Constraints refer to a region of the body and do not prescribe different motions of a node.
void CheckConstraints(const Scene& scene, Problems& problems);
// Loads are on regions that exist, have nodes, and have surface faces if the load needs them.
void CheckLoads(const Scene& scene, Problems& problems);
// Loads or gravity without a support, or a floor, that balances them: the body would accelerate indefinitely.
void CheckSupports(const Scene& scene, Problems& problems);
// Floors have a unit normal, and no body starts inside of one.
void CheckFloors(const Scene& scene, Problems& problems);
// Rigid bodies have a proper shape, pose and motion, and a name of their own; no body starts deep inside of one.
void CheckRigidBodies(const Scene& scene, Problems& problems);
// Contacts are between different bodies that exist, which do not rub or stick yet; only the eulerian method has them.
void CheckContacts(const Scene& scene, Problems& problems);
// A skeleton: as many shapes, motions and activations as bones, coordinates and muscles; names apart from those of
// rigid bodies and floors; constant gravity.
void CheckSkeleton(const Scene& scene, Problems& problems);
// Probes refer to existing nodes; number of frames; duration.
void CheckOutput(const Scene& scene, Problems& problems);

// Reports that a body of a method other than tet is viscoelastic.
void RefuseViscoelasticity(const Body& body, const std::string& method, const std::string& path, Problems& problems);

// Reports rigid bodies in a scene of a method that does not support them.
void RefuseRigidBodies(const Scene& scene, const std::string& method, Problems& problems);

// The remaining checks report what a method does not support, and settings that only the method has.
// tet: single precision requires explicit or mixed stepping and elastic materials; rigid bodies that move freely,
// friction.
void CheckTet(const Scene& scene, Problems& problems);
// voxel: the two supported laws, viscoelasticity, activation, floors, rigid bodies, damping, and single axes of
// supports on images that are not aligned with the world.
void CheckVoxel(const Scene& scene, Problems& problems);
// eulerian: regions by tag, single axes, rigid bodies, damping, viscoelasticity, laws that depend on the rate;
// plasticity and plane force fields, also in scenes of other methods.
void CheckEulerian(const Scene& scene, Problems& problems);

}  // namespace fascicle::scene_checks

#endif  // FASCICLE_CORE_SCENE_CHECKS_H_
