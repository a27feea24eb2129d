#ifndef FASCICLE_CORE_SCENE_OUTPUT_FIELDS_H_
#define FASCICLE_CORE_SCENE_OUTPUT_FIELDS_H_

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "core/base/problems.h"
#include "core/base/types.h"
#include "core/scene/method.h"
#include "core/scene/shape.h"

namespace fascicle {

// The fields that frames may contain, as scene.proto's Field. To add one: a value there and here, a row of the table in
// output_fields.cc, and its formula in PutField.
enum class OutputField {
  kVelocity,
  kCauchyStress,
  kVonMisesStress,
  kPressure,
  kVolumeRatio,
  kFibreStretch,
  kFibreDirection,
  kGreenLagrangeStrain,
  kLogarithmicStrain,
  kPrincipalStrains,
  kPrincipalStresses,
  kPrincipalStressDirections,
  kStrainEnergyDensity,
  kFibreStress,
  kActiveFibreStress,
  kPassiveFibreStress,
  kInternalForce,
  kReactionForce,
  kPennationAngle
};

// Where the values of a field are; kBrick: in each voxel or hexahedron.
enum class FieldLocation { kNode, kTetrahedron, kBrick };

// The input from which a field is computed at each point.
enum class FieldSource {
  kMotion,       // of nodes: MaterialPoint::v; its values are at nodes
  kNodalForce,   // MaterialPoint::force; its values are at nodes
  kDeformation,  // F, J, a0 and line_of_action
  kStress,       // sigma; averages over cells are taken of the tensor
  kFibreStress,  // sigma, passive_sigma, F and a0
  kEnergy        // energy_density
};

// Properties of a field.
struct OutputFieldInfo {
  OutputField field;
  const char* name;  // as in scene.proto
  const char* unit;
  std::size_t components;
  FieldSource from;
  std::array<bool, 3> methods = {true, true, true};  // those that provide it: tet, voxel, eulerian
  bool needs_fibres = false;
  bool is_direction = false;  // of unit length, or zero if there is no direction
  // The field whose averages over an element are taken: itself, or the tensor from whose average it follows
  // (PutFromMean).
  OutputField mean_of = field;
};

constexpr std::size_t kMostComponents = 9;

// Whether the values of a field are at nodes in every method.
inline bool IsNodal(const OutputFieldInfo& info) {
  return info.from == FieldSource::kMotion || info.from == FieldSource::kNodalForce;
}

// The table, in the order of OutputField.
std::span<const OutputFieldInfo> OutputFields();
const OutputFieldInfo& InfoOf(OutputField field);
// Null if there is no such field.
const OutputFieldInfo* FindOutputField(std::string_view name);

// The state of a body at a point. Only the inputs of the field must be set.
struct MaterialPoint {
  Vec3 v = Vec3::Zero();      // [m/s]
  Mat3 F = Mat3::Identity();  // deformation gradient [1]
  double J = 1;               // det F [1]
  Vec3 a0 = Vec3::Zero();     // rest direction of the fibre; zero: none
  Mat3 sigma = Mat3::Zero();  // Cauchy stress [Pa]
  // Cauchy stress of the same deformation without activation [Pa].
  Mat3 passive_sigma = Mat3::Zero();
  double energy_density = 0;            // elastic, per rest volume [J/m^3]
  Vec3 force = Vec3::Zero();            // on a node [N]
  Vec3 line_of_action = Vec3::UnitX();  // of muscles; unit
};

// The field at a point: InfoOf(field).components values. Directions are not normalized yet (F a0), so that they can be
// averaged.
void PutField(OutputField field, const MaterialPoint& at, double* values);

// The field from the average of InfoOf(field).mean_of: directions normalized, principal values of the averaged tensor,
// otherwise the average itself.
void PutFromMean(OutputField field, const double* mean, double* values);

// Normalizes directions from PutField or their averages; zero stays zero.
void NormalizeDirections(std::span<double> values);

// Where frames have the values of a field of a body of that shape, and their number.
FieldLocation LocationOf(const OutputFieldInfo& info, const Shape& shape);
std::size_t PlacesOf(const OutputFieldInfo& info, const Shape& shape);

// What a scene offers to its fields.
struct FieldMeans {
  Method method = Method::kTet;
  bool fibres = false;          // whether any body has fibres
  bool line_of_action = false;  // whether Output::line_of_action is given
};

// Adds a problem at `path` if the field is already in `before`, or the scene cannot provide it.
void CheckOutputField(OutputField field, std::span<const OutputField> before, const FieldMeans& scene,
                      const std::string& path, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_OUTPUT_FIELDS_H_
