#include "server/translate/materials.h"

#include <stdexcept>

#include "server/translate/values.h"

namespace fascicle::server {
namespace {

// The field of the law, whose message has fields named like the law's parameters. No law is named here.
const google::protobuf::FieldDescriptor* LawField(const v1::Material& material) {
  const auto* oneof = material.GetDescriptor()->FindOneofByName("law");
  return material.GetReflection()->GetOneofFieldDescriptor(material, oneof);
}

double Parameter(const google::protobuf::Message& law, const std::string& name) {
  const auto* field = law.GetDescriptor()->FindFieldByName(name);
  if (field == nullptr) throw std::logic_error("scene.proto lacks " + law.GetTypeName() + "." + name);
  return law.GetReflection()->GetDouble(law, field);
}

}  // namespace

const LawInfo* LawOf(const v1::Material& material) {
  const auto* field = LawField(material);
  if (field == nullptr) return nullptr;
  const LawInfo* law = FindLaw(field->name());
  if (law == nullptr) throw std::logic_error("core/materials lacks the law " + field->name());
  return law;
}

std::vector<double> ParametersOf(const v1::Material& material) {
  const auto& message = material.GetReflection()->GetMessage(material, LawField(material));
  std::vector<double> values;
  for (const ParameterInfo& parameter : LawOf(material)->parameters) {
    values.push_back(Parameter(message, parameter.name));
  }
  return values;
}

Material TranslateMaterial(const v1::Material* material, const std::string& owner_path, Problems& problems) {
  const Material neutral = Body().material;
  if (material == nullptr) {
    std::string names;
    for (const LawInfo& law : Laws()) names += (names.empty() ? "" : ", ") + std::string(law.name);
    problems.Add(JoinPath(owner_path, "material"), "is missing", "give one of: " + names);
    return neutral;
  }
  const LawInfo* law = LawOf(*material);
  if (law == nullptr || !ObeysRules(*material)) return neutral;
  return law->make(ParametersOf(*material));
}

Damping TranslateDamping(const v1::Body& body) {
  if (!ObeysRules(body.damping())) return {};
  return {body.damping().mass_proportional(), body.damping().stiffness_proportional(), body.damping().viscosity()};
}

}  // namespace fascicle::server
