#include "server/translate/materials.h"

#include <memory>
#include <stdexcept>
#include <utility>

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

template <class Numbers, class Values>
CurveTable TableOf(const Numbers& at, const Values& values) {
  return {{at.begin(), at.end()}, {values.begin(), values.end()}};
}

MuscleCurves PublishedSet(const v1::TabulatedMuscle& wire) {
  switch (wire.curves()) {
    case v1::PUBLISHED_CURVES_DE_GROOTE_2016:
      return CurvesOf(PublishedCurves::kDeGroote2016);
    case v1::PUBLISHED_CURVES_ALMONACID_2024:
      return CurvesOf(PublishedCurves::kAlmonacid2024);
    default:
      return CurvesOf(PublishedCurves::kThelen2003);
  }
}

MuscleCurves TranslateCurves(const v1::TabulatedMuscle& wire, const std::string& path, Problems& problems) {
  MuscleCurves curves = PublishedSet(wire);
  if (wire.curve_stress() == v1::CURVE_STRESS_FORCE) curves.stress = CurveStress::kForce;
  if (wire.curve_stress() == v1::CURVE_STRESS_CAUCHY) curves.stress = CurveStress::kCauchy;
  const auto replace = [&](const char* field, auto curve_of, const CurveTable& table, PointCurve& curve) {
    Problems own;
    curve = curve_of(table, curve, own);
    problems.Append(JoinPath(path, field), own);
  };
  if (wire.has_active_length()) {
    const auto& w = wire.active_length();
    replace("active_length", ActiveLengthCurve, TableOf(w.lengths(), w.values()), curves.active_length);
  }
  if (wire.has_passive_length()) {
    const auto& w = wire.passive_length();
    replace("passive_length", PassiveLengthCurve, TableOf(w.lengths(), w.values()), curves.passive_length);
  }
  if (wire.has_force_velocity()) {
    const auto& w = wire.force_velocity();
    replace("force_velocity", VelocityCurve, TableOf(w.velocities(), w.values()), curves.force_velocity);
  }
  return curves;
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

std::function<Material(std::span<const double>)> MakerOf(const v1::Material& material, const std::string& path,
                                                         Problems& problems) {
  if (!material.has_tabulated_muscle()) return LawOf(material)->make;
  const std::string of_law = JoinPath(path, "tabulated_muscle");
  auto curves = std::make_shared<const MuscleCurves>(TranslateCurves(material.tabulated_muscle(), of_law, problems));
  return [curves = std::move(curves)](std::span<const double> values) { return TabulatedMuscle(values, curves); };
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
  return MakerOf(*material, JoinPath(owner_path, "material"), problems)(ParametersOf(*material));
}

PronySeries TranslateViscoelasticity(const v1::Material& material, const std::string& path, Problems& problems) {
  if (!material.has_viscoelasticity()) return {};
  const v1::Viscoelasticity& wire = material.viscoelasticity();
  const std::string where = JoinPath(path, "viscoelasticity");
  if (wire.strengths_size() != wire.times_size()) {
    problems.Add(JoinPath(where, "times"),
                 "has " + std::to_string(wire.times_size()) + " values for " + std::to_string(wire.strengths_size()) +
                     " strengths",
                 "one time for each strength");
    return {};
  }
  if (!ObeysRules(wire)) return {};
  PronySeries series;
  for (int i = 0; i < wire.times_size(); ++i) series.terms.push_back({wire.strengths(i), wire.times(i)});
  return series;
}

Damping TranslateDamping(const v1::Body& body) {
  if (!ObeysRules(body.damping())) return {};
  return {body.damping().mass_proportional(), body.damping().stiffness_proportional(), body.damping().viscosity()};
}

}  // namespace fascicle::server
