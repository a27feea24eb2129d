#ifndef FASCICLE_CORE_MATERIALS_MATERIAL_H_
#define FASCICLE_CORE_MATERIALS_MATERIAL_H_

#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "core/materials/constitutive_model.h"
#include "core/materials/corotated_linear.h"
#include "core/materials/linear_elastic.h"
#include "core/materials/mooney_rivlin.h"
#include "core/materials/muscle.h"
#include "core/materials/neo_hookean.h"
#include "core/materials/st_venant_kirchhoff.h"
#include "core/materials/tendon.h"
#include "core/materials/trans_iso_mooney_rivlin.h"

namespace fascicle {

// The closed list of laws. A new law is a header, an entry here and a message in scene.proto of the same name; range
// checks, the test battery, `fascicle materials` and the tables in the documentation follow from it.
using Material = std::variant<LinearElastic, StVenantKirchhoff, CorotatedLinear, NeoHookean, MooneyRivlin, Muscle,
                              Tendon, TransIsoMooneyRivlin>;

// What the list says of a law, without its type.
struct LawInfo {
  const char* name;
  const char* title;
  const char* source;
  bool needs_fibres;
  std::span<const ParameterInfo> parameters;
  Material (*make)(std::span<const double> values);  // values in the order of `parameters`, within their ranges
};

bool InRange(const ParameterInfo& parameter, double value);
// As in scene.proto: "(0, 1e+12]".
std::string RangeText(const ParameterInfo& parameter);

// All laws in the order of the list.
std::span<const LawInfo> Laws();
// nullptr when there is no such law.
const LawInfo* FindLaw(std::string_view name);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_MATERIAL_H_
