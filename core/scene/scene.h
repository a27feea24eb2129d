#ifndef FASCICLE_CORE_SCENE_SCENE_H_
#define FASCICLE_CORE_SCENE_SCENE_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/curve.h"
#include "core/base/problems.h"
#include "core/geometry/bounds.h"
#include "core/geometry/brick_mesh.h"
#include "core/geometry/region.h"
#include "core/geometry/tet_mesh.h"
#include "core/geometry/triangle_mesh.h"
#include "core/materials/material.h"
#include "core/muscle/fibre_field.h"

namespace fascicle {

// What is simulated, in SI and with everything resolved: the messages of scene.proto one for one, see there for the
// meaning. Built by the server's translation or by hand, then checked by CheckScene and never changed.

struct Rotation {
  Vec3 point = Vec3::Zero();  // [m]
  Vec3 axis = Vec3::UnitZ();  // unit
  Curve angle;                // [rad]
};

struct Motion {
  std::array<std::optional<Curve>, 3> translation;  // [m]
  std::optional<Rotation> rotation;
};

struct Constraint {
  std::int32_t region = 0;  // index into Body::regions
  std::array<bool, 3> axes = {true, true, true};
  Motion motion;
};

struct Traction {
  Vec3 vector = Vec3::Zero();
};  // [Pa] of rest area
struct NodalForce {
  Vec3 total = Vec3::Zero();
};  // [N]

struct Load {
  std::int32_t region = 0;  // index into Body::regions
  std::variant<Traction, NodalForce> kind;
  Curve scale = Curve::Constant(1);
  bool kept = false;  // the scale as a series: of a unit force it is the force [N]
};

struct Damping {
  double mass_proportional = 0;       // [1/s]
  double stiffness_proportional = 0;  // [s]
  double viscosity = 0;               // [Pa s]
};

// Plastic flow at constant volume [Fan 2013, 3.5; Bargteil et al. 2007].
struct Plasticity {
  double yield_stress = 0;  // von Mises Cauchy stress from which it flows [Pa]
  // Time in which what is beyond it flows away but for 1/e [s]; 0: at once, whatever the step.
  double relaxation_time = 0;
};

struct Body {
  std::string name;
  TetMesh mesh;           // of the tet method; of the eulerian one, for its fibres, or empty [m]
  BrickMesh bricks;       // of the voxel method [m]
  TriangleMesh surface;   // of the eulerian method [m]
  double density = 1060;  // [kg/m^3]
  Material material = NeoHookean(std::array{1e4, 0.3});
  // Materials beside `material`, and which one each element has: 0 for `material`, k for more_materials[k - 1].
  // All have `material` when empty.
  std::vector<Material> more_materials;
  std::vector<std::int32_t> material_of;
  FibreField fibres;  // empty, or one for each tetrahedron
  std::vector<Region> regions;
  std::vector<Constraint> constraints;
  std::vector<Load> loads;
  Curve activation = Curve::Constant(0);
  // Activations beside `activation`, and which one each tetrahedron follows, counted as the materials are.
  std::vector<Curve> more_activations;
  std::vector<std::int32_t> activation_of;
  // What each tetrahedron makes of its activation, in [0, 1]; 1 when empty.
  std::vector<double> activation_scale;
  // Displacement of each node from rest at time 0 [m]; none when empty. May tangle the mesh.
  std::vector<Vec3> initial_displacement;
  Damping damping;
  std::optional<Plasticity> plasticity;  // of the eulerian method
  // What the user should know of how the body came about; does not change results.
  std::vector<std::string> notes;

  // Of what frames show of the body: its surface, or else whichever mesh it has.
  const std::vector<Vec3>& nodes() const {
    if (!surface.nodes.empty()) return surface.nodes;
    return mesh.nodes.empty() ? bricks.nodes : mesh.nodes;
  }
  std::size_t elements() const { return mesh.tetrahedra.size() + bricks.bricks.size(); }
};

struct Gravity {
  Vec3 acceleration = Vec3::Zero();  // [m/s^2]
  Curve scale = Curve::Constant(1);
};

// A rigid half-space that bodies can't enter: all x with (x - point) . normal < 0.
struct Floor {
  std::string name;
  Vec3 point = Vec3::Zero();    // [m]
  Vec3 normal = Vec3::UnitZ();  // unit, out of the floor
};

// A force per deformed volume towards a plane.
struct Squeeze {
  Vec3 point = Vec3::Zero();    // [m]
  Vec3 normal = Vec3::UnitX();  // unit
  double force_density = 0;     // [N/m^3]
  double width = 0;             // [m]
  Curve scale = Curve::Constant(1);
};

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
  double safety = 0.9;
  double solver_tolerance = 1e-8;
};

enum class OutputField {
  kVelocity,
  kCauchyStress,
  kVonMisesStress,
  kPressure,
  kVolumeRatio,
  kFibreStretch,
  kFibreDirection
};

enum class VoxelStepping { kStatic, kDynamic };

struct VoxelMethod {
  VoxelStepping stepping = VoxelStepping::kStatic;
  bool mean_dilatation = false;     // the volume strain of a brick as its mean, which does not lock
  std::optional<double> time_step;  // [s]; the frame interval when absent
  double tolerance = 1e-8;          // relative residual at which solutions end
  bool start_loaded = false;        // in equilibrium with what acts at time 0
};

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

// What steps the scene; the settings of the others are not looked at.
enum class Method { kTet, kVoxel, kEulerian };

struct Probe {
  std::string name;
  std::int32_t body = 0;
  std::int32_t node = 0;
};

struct Output {
  double frame_interval = 0;  // [s]
  std::vector<OutputField> fields;
  std::vector<Probe> probes;
  std::optional<double> settle_speed;  // [m/s]
};

struct Scene {
  std::string name;
  std::vector<Body> bodies;
  Gravity gravity;
  std::vector<Floor> floors;
  Method method = Method::kTet;
  TetMethod tet;
  VoxelMethod voxel;
  EulerianMethod eulerian;
  std::vector<Squeeze> squeezes;  // of the eulerian method
  double duration = 0;            // [s]
  Output output;
};

// Checks what concerns more than one field: constraints that contradict each other in a node, loads on regions without
// surface, fibres missing for a law that needs them, activation outside [0, 1], bodies without mass, bodies that start
// in a floor, frame counts,
// a whole body free to fly away under load (not a problem when gravity or loads are absent). One check per file in this
// room.
void CheckScene(const Scene& scene, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_SCENE_H_
