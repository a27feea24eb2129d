#ifndef FASCICLE_CORE_VOXEL_SCENE_BODY_H_
#define FASCICLE_CORE_VOXEL_SCENE_BODY_H_

#include <memory>
#include <stop_token>
#include <vector>

#include "core/base/problems.h"
#include "core/scene/controls.h"
#include "core/scene/support_moment.h"
#include "core/voxel/model.h"

namespace fascicle {

// A body of a scene prepared for the voxel solvers: positions and directions in the coordinates of the grid,
// constraints as supports, loads as nodal forces. Immutable; may be shared between threads.
class VoxelSceneBody {
 public:
  // CheckScene must have accepted the scene, which must outlive this object.
  VoxelSceneBody(const Scene& scene, const Body& body);

  const Body& source() const { return *source_; }
  const VoxelModel& model() const { return *model_; }
  // One for each constraint.
  const std::vector<VoxelSupport>& supports() const { return supports_; }

  // Loads and gravity under the controls of the body [N].
  void SetForces(const BodyControls& controls, VoxelField<double>& force) const;
  // Prescribed displacements [m]; other components are left unchanged.
  void Prescribe(const BodyControls& controls, VoxelField<double>& displacement) const;

  // What each support does to the body, along the world axes, where `reaction` is the force on every node [N] at its
  // displacement [m]. A component shared by two supports counts for the first.
  std::vector<Reaction> SumOverSupports(const VoxelField<double>& reaction,
                                        const VoxelField<double>& displacement) const;

  // From the axes of the grid to those of the world.
  const Mat3& direction() const { return grid_.direction; }
  Vec3 ToWorld(const Vec3& along_grid) const { return direction() * along_grid; }
  double volume() const { return static_cast<double>(model_->mesh().voxels()) * grid_.spacing.prod(); }  // [m^3]

 private:
  // A load as nodal forces at scale 1, along the axes of the grid.
  struct NodalLoad {
    std::vector<std::int32_t> nodes;
    std::vector<Vec3> forces;  // [N]
  };
  void AddSupports(const std::vector<GridIndex>& places);
  void AddLoads();

  const Scene* scene_;
  const Body* source_;
  VoxelGrid grid_;
  std::unique_ptr<VoxelModel> model_;
  std::vector<VoxelSupport> supports_;
  std::vector<NodalLoad> loads_;
  std::vector<double> gravity_share_;  // for each node: its mass if gravity acts, otherwise empty [kg]
};

// Reports unsupported parts of bodies with their rigid body modes, where the scene asks for an equilibrium. CheckScene
// must have accepted the scene. Paths are `bodies[i].constraints`. Throws Stopped after a stop request.
void CheckVoxelSupports(const Scene& scene, Problems& problems, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_SCENE_BODY_H_
