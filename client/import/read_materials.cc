// <Material>: laws that fascicle has, too, parameter by parameter [FEBio Feature Manual, materials].
//
//   FEBio                                                      scene
//   neo-Hookean                                                neo_hookean
//   isotropic elastic, St.Venant-Kirchhoff                     st_venant_kirchhoff
//   Mooney-Rivlin; incomp neo-Hookean (c1 = G/2)               mooney_rivlin
//   muscle material, tendon material                           blemker_muscle, blemker_tendon
//   Ogden, Yeoh of up to three terms                           ogden, yeoh
//   trans iso Mooney-Rivlin                                    trans_iso_mooney_rivlin
//   uncoupled solid mixture of Mooney-Rivlin and
//     muscle material with g1 = g2 = g3 = 0                    muscle
//     tendon material with g1 = g2 = 0                         tendon
//     uncoupled fiber-exp-linear                               trans_iso_mooney_rivlin
//   ... and of these with a fibre of Mooney-Rivlin type and
//     uncoupled prescribed uniaxial active contraction         trans_iso_mooney_rivlin with active_stress
//
// One has no equal law here, and becomes the nearest one as a reported change: active_contraction [Guccione, McCulloch
// 1993].
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "client/import/sections.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

constexpr double kNoSlope = 1e-9;  // relative to c3

constexpr const char* kKnown =
    "supported are neo-Hookean, isotropic elastic, St.Venant-Kirchhoff, Mooney-Rivlin, incomp neo-Hookean, Ogden, "
    "Yeoh, "
    "trans iso Mooney-Rivlin, and uncoupled solid mixtures of Mooney-Rivlin with muscle material, tendon material, "
    "uncoupled "
    "fiber-exp-linear or uncoupled prescribed uniaxial active contraction";

// The parameters of a material or solid, each marked when it is read.
class Parameters {
 public:
  Parameters(pugi::xml_node node, XmlSource& source) : node_(node), source_(source) { source.Take(node); }

  pugi::xml_node node() const { return node_; }

  double Get(const char* name) {
    const pugi::xml_node child = node_.child(name);
    if (!child) {
      source_.Fail(node_, "has no " + std::string(name), "give <" + std::string(name) + ">");
      return 0;
    }
    return Value(child);
  }
  double GetOr(const char* name, double standard) {
    const pugi::xml_node child = node_.child(name);
    return child ? Value(child) : standard;
  }
  std::optional<Driven> GetDriven(const char* name) {
    const pugi::xml_node child = node_.child(name);
    return child ? std::optional(source_.DrivenNumber(child)) : std::nullopt;
  }
  // The first of two names that exists; names differ between versions.
  const char* Either(const char* first, const char* second) const { return node_.child(first) ? first : second; }

 private:
  double Value(pugi::xml_node child) {
    const Driven driven = source_.DrivenNumber(child);
    if (driven.controller) {
      source_.Fail(child, "changes in time", "laws have constant parameters; remove lc");
    }
    return driven.value;
  }

  pugi::xml_node node_;
  XmlSource& source_;
};

struct MooneyRivlinPart {
  double c1 = 0, c2 = 0;
};

class MaterialReader {
 public:
  MaterialReader(pugi::xml_node node, XmlSource& source, const UnitSystem& units, ImportedMaterial& material)
      : node_(node), source_(source), units_(units), material_(material) {}

  void Read(const std::string& type) {
    ReadCommon(node_);
    if (type == "neo-Hookean") {
      ReadIsotropic(*material_.law.mutable_neo_hookean());
    } else if (type == "isotropic elastic" || type == "St.Venant-Kirchhoff") {
      ReadIsotropic(*material_.law.mutable_st_venant_kirchhoff());
    } else if (type == "Mooney-Rivlin" || type == "incomp neo-Hookean") {
      Parameters parameters(node_, source_);
      const MooneyRivlinPart matrix = ReadMatrix(type, parameters);
      SetMooneyRivlin(matrix, BulkModulus(parameters));
    } else if (type == "Ogden") {
      ReadOgden();
    } else if (type == "Yeoh") {
      ReadYeoh();
    } else if (type == "trans iso Mooney-Rivlin") {
      ReadTransIso();
    } else if (type == "uncoupled solid mixture") {
      ReadMixture();
    } else if (type == "muscle material" || type == "tendon material") {
      ReadBlemker(type);
    } else {
      source_.TakeAll(node_);
      source_.Fail(node_, "the material " + Quoted(type) + " is not supported", kKnown);
    }
  }

 private:
  double Stress(double value) const { return value * units_.pascal; }

  // Parameters common to all materials.
  void ReadCommon(pugi::xml_node node) {
    if (const pugi::xml_node density = node.child("density")) {
      const Driven driven = source_.DrivenNumber(density);
      if (driven.value < 0) source_.Fail(density, "is negative");
      if (driven.value > 0) material_.density = driven.value * units_.density;
    }
    if (const pugi::xml_node axes = node.child("mat_axis")) {
      if (const auto read = ReadAxes(axes, source_)) material_.axes.push_back(*read);
    }
    for (const char* name : {"laugon", "atol", "minaug", "maxaug"}) {
      if (const pugi::xml_node child = node.child(name)) {
        source_.Tell(Notice::Kind::kNote, child, "volumes are preserved by K only, without augmentation");
      }
    }
    if (const pugi::xml_node model = node.child("pressure_model")) {
      const std::string text = source_.Text(model);
      if (text != "0" && text != "default") {
        source_.Fail(model, "the volume energy " + Quoted(text) + " is not supported",
                     "fascicle has K/2 (ln J)^2, model 0");
      }
    }
  }

  void ReadFibreOf(pugi::xml_node node) {
    material_.needs_fibres = true;
    if (const pugi::xml_node fibre = node.child("fiber")) {
      if (const auto read = ReadFibre(fibre, source_)) material_.fibre = *read;
    }
  }

  template <class Law>
  void ReadIsotropic(Law& law) {
    Parameters parameters(node_, source_);
    law.set_young_modulus(Stress(parameters.Get("E")));
    law.set_poisson_ratio(parameters.Get("v"));
  }

  static MooneyRivlinPart ReadMatrix(const std::string& type, Parameters& parameters) {
    if (type == "incomp neo-Hookean") return {0.5 * parameters.Get("G"), 0};
    return {parameters.Get("c1"), parameters.GetOr("c2", 0)};
  }

  // In a mixture, only some of the solids have one.
  static double BulkModulus(Parameters& parameters) { return parameters.Get("k"); }

  void SetMooneyRivlin(const MooneyRivlinPart& matrix, double bulk) {
    v1::MooneyRivlin& law = *material_.law.mutable_mooney_rivlin();
    law.set_c1(Stress(matrix.c1));
    law.set_c2(Stress(matrix.c2));
    law.set_bulk_modulus(Stress(bulk));
  }

  // Refuses terms beyond the third, unless they are 0.
  void RefuseFurtherTerms(Parameters& parameters) {
    for (const char* name : {"c4", "c5", "c6"}) {
      if (parameters.GetOr(name, 0) == 0) continue;
      source_.Fail(node_.child(name), "is a term beyond the third, of which the law has none",
                   "fit three terms to the same data: fascicle materials curve --data --fit");
    }
  }

  void ReadOgden() {
    Parameters parameters(node_, source_);
    v1::Ogden& law = *material_.law.mutable_ogden();
    law.set_c1(Stress(parameters.Get("c1")));
    law.set_m1(parameters.Get("m1"));
    law.set_c2(Stress(parameters.GetOr("c2", 0)));
    law.set_m2(parameters.GetOr("m2", 1));
    law.set_c3(Stress(parameters.GetOr("c3", 0)));
    law.set_m3(parameters.GetOr("m3", 1));
    law.set_bulk_modulus(Stress(BulkModulus(parameters)));
    for (const char* name : {"m4", "m5", "m6"}) parameters.GetOr(name, 1);
    RefuseFurtherTerms(parameters);
  }

  void ReadYeoh() {
    Parameters parameters(node_, source_);
    v1::Yeoh& law = *material_.law.mutable_yeoh();
    law.set_c1(Stress(parameters.Get("c1")));
    law.set_c2(Stress(parameters.GetOr("c2", 0)));
    law.set_c3(Stress(parameters.GetOr("c3", 0)));
    law.set_bulk_modulus(Stress(BulkModulus(parameters)));
    RefuseFurtherTerms(parameters);
  }

  // Fibres of `fibre`; if it has none, the law is that of the matrix.
  void SetTransIso(const MooneyRivlinPart& matrix, double bulk, Parameters& fibre, const char* lam_max) {
    const double c4 = fibre.GetOr("c4", 0);
    double c3 = fibre.GetOr("c3", 0), c5 = fibre.GetOr("c5", 0);
    if (c3 == 0 && c5 == 0) return SetMooneyRivlin(matrix, bulk);
    const double transition = Transition(fibre, lam_max);
    // FEBio's rule if the scale is absent: no kink at lam_max.
    if (c3 == 0 && c4 > 0) c3 = c5 / c4 * std::exp(-c4 * (transition - 1));
    // The stress is constant beyond lam_max; the law's slope must be positive.
    if (c5 == 0) c5 = kNoSlope * c3;
    v1::TransIsoMooneyRivlin& law = *material_.law.mutable_trans_iso_mooney_rivlin();
    law.set_c1(Stress(matrix.c1));
    law.set_c2(Stress(matrix.c2));
    law.set_c3(Stress(c3));
    law.set_c4(c4);
    law.set_c5(Stress(c5));
    law.set_lam_max(transition);
    law.set_bulk_modulus(Stress(bulk));
    ReadFibreOf(fibre.node());
  }

  // lam_max, which has no effect beyond the law's limit of 10.
  double Transition(Parameters& fibre, const char* lam_max) {
    constexpr double kLargest = 10;
    const double transition = fibre.Get(lam_max);
    if (!(transition > kLargest)) return transition;
    source_.Remark(Notice::Kind::kNote, fibre.node().child(lam_max), "is taken as 10: no fibre stretches tenfold");
    return kLargest;
  }

  void ReadTransIso() {
    Parameters parameters(node_, source_);
    const MooneyRivlinPart matrix = ReadMatrix("Mooney-Rivlin", parameters);
    SetTransIso(matrix, BulkModulus(parameters), parameters, "lam_max");
    if (const pugi::xml_node fibre = node_.child("fiber")) source_.TakeAll(fibre);
    if (const pugi::xml_node active = node_.child("active_contraction")) ReadSarcomeres(active);
  }

  // Cauchy stress T(lambda) C(t) along the fibre with T = Tmax Ca0^2 / (Ca0^2 + ECa50^2), ECa50 = Ca0max /
  // sqrt(exp(beta (lambda lr - l0)) - 1) [Guccione, McCulloch 1993]. The nearest law has the second Piola-Kirchhoff
  // stress T(1) C(t).
  void ReadSarcomeres(pugi::xml_node node) {
    Parameters parameters(node, source_);
    source_.TakeAll(node);
    const std::string_view type = node.attribute("type").as_string("active_contraction");
    if (type != "active_contraction") {
      source_.Remark(Notice::Kind::kNotTaken, node,
                     "the active contraction " + Quoted(std::string(type)) + " has no law here",
                     "use uncoupled prescribed uniaxial active contraction in an uncoupled solid mixture");
      return;
    }
    const std::optional<Driven> scale = parameters.GetDriven("ascl");
    const double calcium = parameters.GetOr("ca0", 1), given = parameters.GetOr("camax", 0);
    const double largest = given > 0 ? given : calcium;
    const double growth = std::exp(parameters.Get("beta") * (parameters.Get("refl") - parameters.Get("l0"))) - 1;
    if (!scale || !(growth > 0) || !(calcium > 0) || !material_.law.has_trans_iso_mooney_rivlin()) {
      source_.Remark(Notice::Kind::kNotTaken, node, "contracts nothing at rest length, or a solid without stiff fibres",
                     "give ascl, refl above l0, and c3, c4, c5");
      return;
    }
    const double stress =
        parameters.GetOr("Tmax", 1) * calcium * calcium / (calcium * calcium + largest * largest / growth);
    char text[320];
    std::snprintf(
        text, sizeof(text),
        "its Cauchy stress grows with sarcomere length; the law's second Piola-Kirchhoff stress does not, and "
        "equals it at rest length: %.6g times ascl, by beta, refl, l0 and ca0",
        stress);
    source_.Remark(
        Notice::Kind::kChanged, node, text,
        "use uncoupled prescribed uniaxial active contraction in an uncoupled solid mixture: that is the law");
    material_.law.mutable_trans_iso_mooney_rivlin()->set_active_stress(Stress(stress));
    material_.activation = scale;
  }

  // Muscle or tendon material by itself, whose matrix has the shear energy g1 B1^2 + g2 B2^2.
  void ReadBlemker(const std::string& type) {
    Parameters parameters(node_, source_);
    const double g1 = parameters.GetOr("g1", 0), g2 = parameters.GetOr("g2", 0);
    parameters.GetOr("g3", 0);
    if (!(g1 > 0 && g2 > 0)) {
      return source_.Fail(node_, "has no matrix: the law " + type.substr(0, 6) + " needs g1 > 0 and g2 > 0",
                          "write an uncoupled solid mixture of Mooney-Rivlin and " + type + " with g1 and g2 of 0");
    }
    const auto set_matrix = [&](auto& law) {
      law.set_along_modulus(Stress(g1));
      law.set_across_modulus(Stress(g2));
      law.set_bulk_modulus(Stress(BulkModulus(parameters)));
    };
    if (type == "muscle material") {
      v1::BlemkerMuscle& law = *material_.law.mutable_blemker_muscle();
      set_matrix(law);
      SetMuscleFibre(node_, law);
    } else {
      v1::BlemkerTendon& law = *material_.law.mutable_blemker_tendon();
      set_matrix(law);
      SetTendonFibre(node_, law);
    }
  }

  // A mixture: a matrix, optionally a fibre and an active contraction.
  void ReadMixture() {
    source_.Take(node_);
    std::map<std::string, pugi::xml_node> solids;
    double bulk_of_solids = 0;
    bool good = true;
    for (const pugi::xml_node solid : node_.children("solid")) {
      source_.Take(solid);
      const std::string type = Role(source_.Required(solid, "type"));
      if (type.empty() || !solids.try_emplace(type, solid).second) {
        source_.Fail(solid, "a mixture with this solid has no counterpart here", kKnown);
        source_.TakeAll(solid);
        good = false;
        continue;
      }
      Parameters parameters(solid, source_);
      bulk_of_solids += parameters.GetOr("k", 0);
      if (const pugi::xml_node density = solid.child("density")) source_.TakeAll(density);
      if (const pugi::xml_node model = solid.child("pressure_model")) source_.TakeAll(model);
    }
    if (!good) return;
    Parameters mixture(node_, source_);
    const double own = mixture.GetOr("k", 0);
    if (own > 0 && bulk_of_solids > 0) {
      source_.Tell(Notice::Kind::kChanged, node_.child("k"), "this bulk modulus replaces those of the solids");
    }
    MixSolids(solids, own > 0 ? own : bulk_of_solids);
  }

  // The role of a solid in a mixture; empty if it has none.
  static std::string Role(const std::string& type) {
    static const std::map<std::string, std::string> roles = {
        {"Mooney-Rivlin", "matrix"},
        {"incomp neo-Hookean", "matrix"},
        {"muscle material", "muscle"},
        {"tendon material", "tendon"},
        {"uncoupled fiber-exp-linear", "fibre"},
        {"trans iso Mooney-Rivlin", "trans iso"},
        {"uncoupled prescribed uniaxial active contraction", "active"},
        {"prescribed uniaxial active contraction uncoupled", "active"}};
    const auto role = roles.find(type);
    return role == roles.end() ? "" : role->second;
  }

  void MixSolids(std::map<std::string, pugi::xml_node>& solids, double bulk) {
    const auto solid = [&](const char* role) {
      const auto found = solids.find(role);
      return found == solids.end() ? pugi::xml_node() : found->second;
    };
    const pugi::xml_node matrix_node = solid("trans iso") ? solid("trans iso") : solid("matrix");
    const int fibres = int(bool(solid("muscle"))) + bool(solid("tendon")) + bool(solid("fibre"));
    const bool is_trans_iso = solid("trans iso") || solid("fibre");
    if (!matrix_node || fibres > 1 || (solid("trans iso") && (fibres > 0 || solid("matrix"))) ||
        (solid("active") && !is_trans_iso)) {
      return source_.Fail(node_, "a mixture of these solids has no counterpart here", kKnown);
    }
    if (!(bulk > 0)) return source_.Fail(node_, "has no k", "give <k>, the bulk modulus");
    Parameters matrix_parameters(matrix_node, source_);
    const MooneyRivlinPart matrix = ReadMatrix(matrix_node.attribute("type").value(), matrix_parameters);
    if (solid("muscle")) {
      MixMuscle(matrix, bulk, solid("muscle"));
    } else if (solid("tendon")) {
      MixTendon(matrix, bulk, solid("tendon"));
    } else if (solid("fibre")) {
      Parameters fibre(solid("fibre"), source_);
      SetTransIso(matrix, bulk, fibre, fibre.Either("lam_max", "lambda"));
      ReadAxesOf(solid("fibre"));
    } else if (solid("trans iso")) {
      SetTransIso(matrix, bulk, matrix_parameters, "lam_max");
      ReadAxesOf(matrix_node);
    } else {
      SetMooneyRivlin(matrix, bulk);
    }
    if (solid("active")) MixActive(solid("active"));
  }

  void ReadAxesOf(pugi::xml_node solid) {
    if (const pugi::xml_node axes = solid.child("mat_axis")) {
      if (const auto read = ReadAxes(axes, source_)) material_.axes.push_back(*read);
    }
  }

  // Whether the shear moduli of a solid are all zero, so that it contributes its fibre only.
  bool IsFibreAlone(Parameters& parameters, const char* law) {
    for (const char* name : {"g1", "g2", "g3"}) {
      if (parameters.GetOr(name, 0) == 0) continue;
      source_.Fail(parameters.node().child(name), "the shear energy of Blemker's invariants is not supported",
                   "set it to 0 and let Mooney-Rivlin resist shear, as the law " + std::string(law) + " does");
      return false;
    }
    return true;
  }

  void MixMuscle(const MooneyRivlinPart& matrix, double bulk, pugi::xml_node node) {
    Parameters parameters(node, source_);
    if (!IsFibreAlone(parameters, "muscle")) return;
    v1::Muscle& law = *material_.law.mutable_muscle();
    law.set_c1(Stress(matrix.c1));
    law.set_c2(Stress(matrix.c2));
    law.set_bulk_modulus(Stress(bulk));
    SetMuscleFibre(node, law);
    ReadAxesOf(node);
  }

  // The fibre terms and the activation of a law of muscle.
  template <class Law>
  void SetMuscleFibre(pugi::xml_node node, Law& law) {
    Parameters parameters(node, source_);
    law.set_peak_stress(Stress(parameters.Get("smax")));
    const double optimal = parameters.Get("Lofl");
    law.set_optimal_stretch(optimal);
    law.set_passive_scale(parameters.GetOr("p1", 0));
    // Without a scale the exponent has no effect, and some files omit it.
    const double exponent = parameters.GetOr("p2", 0);
    if (law.passive_scale() != 0 || exponent != 0) law.set_passive_exponent(exponent);
    const double transition = parameters.Get(parameters.Either("lam_max", "lambda"));
    if (optimal > 0) law.set_passive_transition(transition / optimal);
    material_.activation = parameters.GetDriven("activation");
    ReadFibreOf(node);
  }

  void MixTendon(const MooneyRivlinPart& matrix, double bulk, pugi::xml_node node) {
    Parameters parameters(node, source_);
    if (!IsFibreAlone(parameters, "tendon")) return;
    v1::Tendon& law = *material_.law.mutable_tendon();
    law.set_c1(Stress(matrix.c1));
    law.set_c2(Stress(matrix.c2));
    law.set_bulk_modulus(Stress(bulk));
    SetTendonFibre(node, law);
    ReadAxesOf(node);
  }

  // The fibre terms of a law of tendon.
  template <class Law>
  void SetTendonFibre(pugi::xml_node node, Law& law) {
    Parameters parameters(node, source_);
    law.set_fibre_scale(Stress(parameters.Get("l1")));
    law.set_fibre_exponent(parameters.Get("l2"));
    law.set_transition_stretch(parameters.Get(parameters.Either("lam_max", "lambda")));
    ReadFibreOf(node);
  }

  // T0 along the first material axis, which must be the fibre direction; the law has T0 alpha.
  void MixActive(pugi::xml_node node) {
    Parameters parameters(node, source_);
    std::optional<Driven> stress = parameters.GetDriven("T0");
    if (!stress) return source_.Fail(node, "has no T0", "give <T0>");
    if (const pugi::xml_node axes = node.child("mat_axis")) {
      source_.Fail(axes, "contracts along axes of its own", "only contraction along the fibres is taken: give none");
    }
    // Axes of the fibre itself are within those of the mixture.
    const std::size_t of_mixture = node_.child("mat_axis") ? 1 : 0;
    if (material_.fibre.kind != FibreSource::Kind::kVector || material_.fibre.vector != Vec3::UnitX() ||
        material_.axes.size() > of_mixture) {
      source_.Fail(node, "contracts along the first material axis, which is not the fibre direction",
                   "set the fibres to 1,0,0 and rotate the mixture's mat_axis");
    }
    if (!material_.law.has_trans_iso_mooney_rivlin()) {
      return source_.Fail(node, "contracts a solid whose fibres have no stiffness", "give c3, c4 and c5 of the fibres");
    }
    if (stress->value < 0) return source_.Fail(stress->node, "is negative", "give a non-negative T0");
    material_.law.mutable_trans_iso_mooney_rivlin()->set_active_stress(Stress(stress->value));
    stress->value = 1;
    material_.activation = stress;
  }

  pugi::xml_node node_;
  XmlSource& source_;
  const UnitSystem& units_;
  ImportedMaterial& material_;
};

void ReadRigidMaterial(XmlSource& source, ImportedMaterial& material) {
  source.TakeAll(material.node);
  const pugi::xml_node own = material.node.child("override_com");
  if (own && !source.Flag(own)) return;
  if (const pugi::xml_node centre = material.node.child("center_of_mass")) material.centre = source.Vector(centre);
}

}  // namespace

void ReadMaterials(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  std::set<std::string> names;
  for (const pugi::xml_node node : section.children("material")) {
    source.Take(node);
    ImportedMaterial& material = model.materials.emplace_back();
    material.node = node;
    material.id = source.IntegerAttribute(node, "id").value_or(0);
    material.name = node.attribute("name").as_string(node.attribute("id").value());
    if (!names.insert(material.name).second) {
      source.Fail(node, "there is a material " + Quoted(material.name) + " already", "name them uniquely");
    }
    material.rigid = source.Required(node, "type") == "rigid body";
  }
  if (model.materials.empty()) source.Fail(section, "has no materials");
  for (std::size_t m = 0; m < model.materials.size(); ++m) {
    model.material_index.try_emplace(model.materials[m].name, m);
  }
  for (std::size_t m = 0; m < model.materials.size(); ++m) {
    model.material_index.try_emplace(std::to_string(model.materials[m].id), m);
  }
}

void ReadLaws(XmlSource& source, Model& model) {
  for (ImportedMaterial& material : model.materials) {
    if (material.rigid) {
      ReadRigidMaterial(source, material);
      continue;
    }
    if (!material.used) {
      source.TakeAll(material.node);
      continue;
    }
    const std::string type = material.node.attribute("type").value();
    if (!type.empty()) MaterialReader(material.node, source, model.units, material).Read(type);
  }
}

}  // namespace fascicle::client
