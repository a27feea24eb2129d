#include "server/translate/unused_fields.h"

#include <initializer_list>
#include <string>

#include <google/protobuf/descriptor.h>

#include "core/base/problems.h"

namespace fascicle::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

bool IsGivenAndNotZero(const Message& message, const FieldDescriptor& field) {
  const auto& reflection = *message.GetReflection();
  if (!reflection.HasField(message, &field)) return false;
  return field.cpp_type() != FieldDescriptor::CPPTYPE_DOUBLE || reflection.GetDouble(message, &field) != 0;
}

void AddNotes(const Message& message, const std::string& path, std::initializer_list<const char*> fields,
              const std::string& why, std::vector<std::string>& notes) {
  for (const char* name : fields) {
    const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(name);
    if (IsGivenAndNotZero(message, *field)) notes.push_back(JoinPath(path, name) + ": has no effect " + why);
  }
}

void AddNotesOnMaterial(const v1::Material& material, const std::string& path, const std::string& why,
                        std::vector<std::string>& notes) {
  AddNotes(material.muscle(), JoinPath(path, "muscle"), {"max_velocity"}, why, notes);
  AddNotes(material.tabulated_muscle(), JoinPath(path, "tabulated_muscle"), {"max_velocity"}, why, notes);
}

// Of a law with a force-velocity curve that no velocity scales.
void AddNotesOnCurves(const v1::Material& material, const std::string& path, std::vector<std::string>& notes) {
  if (material.tabulated_muscle().max_velocity() != 0) return;
  AddNotes(material.tabulated_muscle(), JoinPath(path, "tabulated_muscle"), {"force_velocity"}, "without max_velocity",
           notes);
}

void AddNotesOnMotion(const v1::Body& body, const std::string& path, const std::string& why,
                      std::vector<std::string>& notes) {
  AddNotes(body, path, {"initial_velocity"}, why, notes);
  AddNotes(body.damping(), JoinPath(path, "damping"), {"mass_proportional", "stiffness_proportional", "viscosity"}, why,
           notes);
  AddNotesOnMaterial(body.material(), JoinPath(path, "material"), why, notes);
  for (int i = 0; i < body.region_materials_size(); ++i) {
    const std::string part = JoinPath(path, IndexPath("region_materials", static_cast<std::size_t>(i)));
    AddNotesOnMaterial(body.region_materials(i).material(), JoinPath(part, "material"), why, notes);
  }
}

void AddNotesOnMethod(const v1::Scene& scene, std::vector<std::string>& notes) {
  const v1::Stepping stepping = scene.tet().stepping();
  const bool is_explicit = stepping == v1::STEPPING_UNSPECIFIED || stepping == v1::STEPPING_EXPLICIT;
  const bool is_mixed = stepping == v1::STEPPING_MIXED;
  if (is_explicit || is_mixed) {
    AddNotes(scene.tet(), "tet", {"newton_tolerance", "linear_solver"}, "without implicit or quasi-static stepping",
             notes);
  } else {
    AddNotes(scene.tet(), "tet", {"safety"}, "in implicit and quasi-static stepping", notes);
  }
  if (!is_mixed) AddNotes(scene.tet(), "tet", {"solver_tolerance"}, "without mixed stepping", notes);
  if (stepping != v1::STEPPING_NEWMARK) AddNotes(scene.tet(), "tet", {"spectral_radius"}, "without Newmark", notes);
  if (is_explicit || is_mixed || stepping == v1::STEPPING_QUASI_STATIC) {
    AddNotes(scene.tet(), "tet", {"step_error"}, "without implicit stepping with inertia", notes);
  }
  if (scene.voxel().stepping() != v1::VOXEL_STEPPING_DYNAMIC) {
    AddNotes(scene.voxel(), "voxel", {"time_step", "start_loaded"}, "in static stepping", notes);
  }
}

}  // namespace

void AddUnusedSkeletonNotes(const v1::Scene& scene, std::vector<std::string>& notes) {
  const v1::Skeleton& skeleton = scene.skeleton();
  std::vector<std::string> of_muscles;
  if (skeleton.strength() != v1::MUSCLE_STRENGTH_FORCE_LENGTH) {
    for (int m = 0; m < skeleton.muscles_size() && of_muscles.empty(); ++m) {  // the others are like the first
      AddNotes(skeleton.muscles(m), JoinPath("skeleton", IndexPath("muscles", static_cast<std::size_t>(m))),
               {"optimal_fibre_length", "tendon_slack_length", "pennation", "active_width", "passive_strain",
                "passive_shape"},
               "while `skeleton.strength` is constant", of_muscles);
    }
  }
  notes.insert(notes.end(), of_muscles.begin(), of_muscles.end());
  if (!scene.bodies().empty()) return;
  std::vector<const FieldDescriptor*> given;
  scene.tet().GetReflection()->ListFields(scene.tet(), &given);
  for (const FieldDescriptor* field : given) notes.push_back("tet." + field->name() + ": has no effect without bodies");
}

void AddUnusedFieldNotes(const v1::Scene& scene, std::vector<Body>& bodies) {
  if (bodies.empty()) return;
  AddNotesOnMethod(scene, bodies.front().notes);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const v1::Body& body = scene.bodies(static_cast<int>(i));
    const std::string path = IndexPath("bodies", i);
    AddNotesOnCurves(body.material(), JoinPath(path, "material"), bodies[i].notes);
    for (int k = 0; k < body.region_materials_size(); ++k) {
      const std::string part = JoinPath(path, IndexPath("region_materials", static_cast<std::size_t>(k)));
      AddNotesOnCurves(body.region_materials(k).material(), JoinPath(part, "material"), bodies[i].notes);
    }
  }
  const bool quasi_static = scene.tet().stepping() == v1::STEPPING_QUASI_STATIC;
  const bool is_static = scene.has_voxel() && scene.voxel().stepping() != v1::VOXEL_STEPPING_DYNAMIC;
  if (!quasi_static && !is_static) return;
  const std::string why = quasi_static ? "in quasi-static stepping, which finds equilibria" : "in static stepping";
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    AddNotesOnMotion(scene.bodies(static_cast<int>(i)), IndexPath("bodies", i), why, bodies[i].notes);
  }
}

}  // namespace fascicle::server
