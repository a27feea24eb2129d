#ifndef FASCICLE_CORE_MATERIALS_MATERIAL_H_
#define FASCICLE_CORE_MATERIALS_MATERIAL_H_

#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "core/materials/blemker_muscle.h"
#include "core/materials/blemker_tendon.h"
#include "core/materials/constitutive_model.h"
#include "core/materials/corotated_linear.h"
#include "core/materials/fung_fibre.h"
#include "core/materials/holzapfel_gasser_ogden.h"
#include "core/materials/linear_elastic.h"
#include "core/materials/mooney_rivlin.h"
#include "core/materials/muscle.h"
#include "core/materials/neo_hookean.h"
#include "core/materials/ogden.h"
#include "core/materials/st_venant_kirchhoff.h"
#include "core/materials/tabulated_muscle.h"
#include "core/materials/tendon.h"
#include "core/materials/trans_iso_mooney_rivlin.h"
#include "core/materials/yeoh.h"

namespace fascicle {

// The closed list of laws. A new law is a header, an entry here, an instantiation in material.cc and a message of the
// same name in scene.proto. Range checks, the test battery and `fascicle materials` follow from this list.
using Material = std::variant<LinearElastic, StVenantKirchhoff, CorotatedLinear, NeoHookean, MooneyRivlin, Muscle,
                              Tendon, TransIsoMooneyRivlin, Yeoh, Ogden, FungFibre, HolzapfelGasserOgden,
                              TabulatedMuscle, BlemkerMuscle, BlemkerTendon>;

// The static members of a law, independent of its type.
struct LawInfo {
  const char* name;
  const char* title;
  const char* source;
  bool needs_fibres;
  std::span<const ParameterInfo> parameters;
  Material (*make)(std::span<const double> values);  // values in the order of `parameters`, within their ranges
};

bool InRange(const ParameterInfo& parameter, double value);
// The range in the notation of scene.proto: "(0, 1e+12]".
std::string RangeText(const ParameterInfo& parameter);

// All laws in the order of the list.
std::span<const LawInfo> Laws();
// Null when there is no such law.
const LawInfo* FindLaw(std::string_view name);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_MATERIAL_H_
