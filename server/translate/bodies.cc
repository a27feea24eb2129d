#include "server/translate/bodies.h"

#include <algorithm>
#include <cmath>

#include "server/translate/materials.h"
#include "server/translate/parts.h"
#include "server/translate/refine_body.h"
#include "server/translate/regions.h"
#include "server/translate/shapes.h"
#include "server/translate/supports_and_loads.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

bool TranslateShape(const BodySource& source, Method method, const RegionSelectors& selectors, Body& body,
                    Problems& structure, Problems& others) {
  switch (method) {
    case Method::kTet:
      return TranslateTetShape(source, selectors, body, structure, others);
    case Method::kVoxel:
      return TranslateVoxelShape(source, selectors, body, structure, others);
    case Method::kEulerian:
      return TranslateSurfaceShape(source, selectors, body, structure, others);
  }
  return false;
}

template <class Messages>
bool AllObeyRules(const Messages& messages) {
  return std::all_of(messages.begin(), messages.end(), ObeysRules);
}

}  // namespace

void RefuseFields(const BodySource& source, std::initializer_list<const char*> fields, const std::string& message,
                  const std::string& hint, Problems& problems) {
  const auto& reflection = *source.wire.GetReflection();
  for (const char* name : fields) {
    const auto* field = v1::Body::descriptor()->FindFieldByName(name);
    const bool given =
        field->is_repeated() ? reflection.FieldSize(source.wire, field) > 0 : reflection.HasField(source.wire, field);
    if (given) problems.Add(JoinPath(source.path, name), message, hint);
  }
}

TranslatedBody TranslateBody(const BodySource& source, Method method, Problems& problems) {
  const v1::Body& wire = source.wire;
  const std::string& path = source.path;
  TranslatedBody result;
  Body& body = result.body;
  body.name = wire.name();
  if (std::isfinite(wire.density()) && wire.density() > 0) body.density = wire.density();
  body.material = TranslateMaterial(wire.has_material() ? &wire.material() : nullptr, path, problems);
  body.viscoelasticity = TranslateViscoelasticity(wire.material(), JoinPath(path, "material"), problems);
  body.damping = TranslateDamping(wire);
  Problems structure, others;
  const RegionSelectors selectors = TranslateRegions(wire, path, structure);
  const bool has_mesh = TranslateShape(source, method, selectors, body, structure, others);
  body.constraints = TranslateConstraints(wire, path, selectors.names, source.skeleton, structure);
  body.loads = TranslateLoads(wire, path, selectors.names, structure);
  body.activation = TranslateActivation(source, others);
  body.excitation = TranslateExcitation(source, others);
  result.complete = structure.empty() && has_mesh && AllObeyRules(wire.regions()) && AllObeyRules(wire.constraints()) &&
                    AllObeyRules(wire.loads());
  if (result.complete) RefineBody(source, selectors, body, others);
  problems.Append("", structure);
  problems.Append("", others);
  return result;
}

}  // namespace fascicle::server
