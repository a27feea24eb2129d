#ifndef FASCICLE_CORE_SCENE_METHOD_H_
#define FASCICLE_CORE_SCENE_METHOD_H_

#include <array>
#include <optional>

#include "core/geometry/bounds.h"
#include "core/scene/fields.h"

namespace fascicle {

// The method that steps a scene. Settings of the other methods are ignored.
enum class Method { kTet, kVoxel, kEulerian };
// The names in scene.proto.
inline constexpr std::array<const char*, 3> kMethodNames = {"tet", "voxel", "eulerian"};

enum class Stepping { kExplicit, kMixed, kBackwardEuler, kNewmark, kBdf2, kQuasiStatic };

// Shape functions of an element: tetrahedra of 4 or 10 nodes, hexahedra of 8 or 27 nodes.
enum class ElementOrder { kLinear, kQuadratic, kHexahedral, kHexahedralQuadratic };
constexpr bool IsHexahedral(ElementOrder element) {
  return element == ElementOrder::kHexahedral || element == ElementOrder::kHexahedralQuadratic;
}

// Where the volume energy of nearly incompressible laws acts: on averages (of tetrahedra: around nodes, of hexahedra:
// over the element), or at each point separately, which locks.
enum class VolumeForm { kNodal, kElement };
enum class Precision { kDouble, kSingle };

// Solver for the linear systems of Newton's method; automatic: iterative for large systems.
enum class LinearSolver { kAutomatic, kDirect, kIterative };

struct TetMethod {
  Stepping stepping = Stepping::kExplicit;
  ElementOrder element = ElementOrder::kLinear;
  VolumeForm volume = VolumeForm::kNodal;
  Precision precision = Precision::kDouble;
  std::optional<double> time_step;  // [s]; automatic when absent
  LinearSolver linear_solver = LinearSolver::kAutomatic;
  double newton_tolerance = 1e-8;    // relative force at which Newton iterations end
  double safety = 0.9;               // fraction of the stable step
  double solver_tolerance = 1e-8;    // relative residual of the linear solves of damping
  double spectral_radius = 1;        // of kNewmark at infinite frequency; 1: undamped
  std::optional<double> step_error;  // largest error of an implicit step with inertia, see core/tet/step_error.h
};
template <>
inline constexpr auto kFieldNames<TetMethod> = FieldNames("stepping", "element", "volume", "precision", "time_step",
                                                          "linear_solver", "newton_tolerance", "safety",
                                                          "solver_tolerance", "spectral_radius", "step_error");

enum class VoxelStepping { kStatic, kDynamic };

struct VoxelMethod {
  VoxelStepping stepping = VoxelStepping::kStatic;
  bool mean_dilatation = false;     // whether the dilatation of a brick is averaged, which prevents locking
  std::optional<double> time_step;  // [s]; the frame interval when absent
  double tolerance = 1e-8;          // relative residual at which solutions end
  bool start_loaded = false;        // whether to start in equilibrium with the loads at time 0
};
template <>
inline constexpr auto kFieldNames<VoxelMethod> = FieldNames("stepping", "dilatation", "time_step", "tolerance",
                                                            "start_loaded");

enum class VolumeTreatment {
  kNone,            // only the law's own bulk modulus
  kDivergenceFree,  // div v = 0, with drift
  kPreserved,       // div v = (1 - J)/(dt J), without drift [Fan 2013, 3.3]
};

struct EulerianMethod {
  double cell_size = 0;        // [m]
  double margin = 0.5;         // relative to the body's largest extent
  std::optional<Bounds> room;  // extent of the grid, in place of the margin [m]
  VolumeTreatment volume = VolumeTreatment::kPreserved;
  double stabilization = 0.05;
  bool implicit_elasticity = false;
  std::optional<double> time_step;  // upper bound [s]
  bool maccormack = false;
  bool rigid_grids = false;  // whether grids travel with the rigid part of their bodies' motion
};
template <>
inline constexpr auto kFieldNames<EulerianMethod> = FieldNames("cell_size", "margin", "", "volume", "stabilization",
                                                               "elastic_force", "time_step", "advection",
                                                               "grid_motion");
template <>
inline constexpr auto kFieldNames<Bounds> = FieldNames("lowest", "highest");

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_METHOD_H_
