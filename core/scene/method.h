#ifndef FASCICLE_CORE_SCENE_METHOD_H_
#define FASCICLE_CORE_SCENE_METHOD_H_

#include <array>
#include <optional>

#include "core/geometry/bounds.h"
#include "core/scene/fields.h"

namespace fascicle {

// What steps a scene. The settings of the other methods are not looked at.
enum class Method { kTet, kVoxel, kEulerian };
// As in scene.proto.
inline constexpr std::array<const char*, 3> kMethodNames = {"tet", "voxel", "eulerian"};

enum class Stepping { kExplicit, kMixed, kBackwardEuler, kNewmark, kBdf2, kQuasiStatic };

// Polynomial order of the displacement in an element: 4 or 10 nodes.
enum class ElementOrder { kLinear, kQuadratic };

// Where the volume energy of nearly incompressible laws acts: on averages around nodes, or in each element by itself,
// which locks.
enum class VolumeForm { kNodal, kElement };
enum class Precision { kDouble, kSingle };

// How the linear systems of Newton's method are solved; automatic: iteratively where they are large.
enum class LinearSolver { kAutomatic, kDirect, kIterative };

struct TetMethod {
  Stepping stepping = Stepping::kExplicit;
  ElementOrder element = ElementOrder::kLinear;
  VolumeForm volume = VolumeForm::kNodal;
  Precision precision = Precision::kDouble;
  std::optional<double> time_step;  // [s]; automatic when absent
  LinearSolver linear_solver = LinearSolver::kAutomatic;
  double newton_tolerance = 1e-8;  // relative force at which the iterations of implicit steps end
  double safety = 0.9;             // part of the stable step that is taken
  double solver_tolerance = 1e-8;  // relative residual of the linear solves of damping
};
template <>
inline constexpr auto kFieldNames<TetMethod> = FieldNames("stepping", "element", "volume", "precision", "time_step",
                                                          "linear_solver", "newton_tolerance", "safety",
                                                          "solver_tolerance");

enum class VoxelStepping { kStatic, kDynamic };

struct VoxelMethod {
  VoxelStepping stepping = VoxelStepping::kStatic;
  bool mean_dilatation = false;     // the volume strain of a brick as its mean, which does not lock
  std::optional<double> time_step;  // [s]; the frame interval when absent
  double tolerance = 1e-8;          // relative residual at which solutions end
  bool start_loaded = false;        // in equilibrium with what acts at time 0
};
template <>
inline constexpr auto kFieldNames<VoxelMethod> = FieldNames("stepping", "dilatation", "time_step", "tolerance",
                                                            "start_loaded");

enum class VolumeTreatment {
  kNone,            // the law's own resistance alone
  kDivergenceFree,  // div v = 0, which drifts
  kPreserved,       // div v = (1 - J)/(dt J), which does not [Fan 2013, 3.2]
};

struct EulerianMethod {
  double cell_size = 0;        // [m]
  double margin = 0.5;         // of a body's largest extent
  std::optional<Bounds> room;  // that bodies move in, in place of the margin [m]
  VolumeTreatment volume = VolumeTreatment::kPreserved;
  double stabilization = 0.05;
  bool implicit_elasticity = false;
  std::optional<double> time_step;  // the longest [s]
  bool maccormack = false;
};
template <>
inline constexpr auto kFieldNames<EulerianMethod> = FieldNames("cell_size", "margin", "", "volume", "stabilization",
                                                               "elastic_force", "time_step", "advection");
template <>
inline constexpr auto kFieldNames<Bounds> = FieldNames("lowest", "highest");

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_METHOD_H_
