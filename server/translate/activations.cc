#include <utility>

#include "server/translate/curves.h"
#include "server/translate/number_files.h"
#include "server/translate/parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

const char kCurveHint[] = "give times [s] and values in [0, 1]";

}  // namespace

Curve TranslateActivation(const BodySource& source, Problems& problems) {
  if (!source.wire.activation_muscle().empty()) {
    const std::string path = JoinPath(source.path, "activation_muscle");
    if (source.wire.has_activation() || source.wire.has_excitation()) {
      problems.Add(path, "is given beside an activation or an excitation", "give only one of them");
    }
    return source.skeleton.ActivationOf(source.wire.activation_muscle(), path, problems);
  }
  if (!source.wire.has_activation()) return Curve::Constant(0);
  return TranslateCurve(source.wire.activation(), kActivationCurve, JoinPath(source.path, "activation"), problems);
}

std::optional<Excitation> TranslateExcitation(const BodySource& source, Problems& problems) {
  if (!source.wire.has_excitation()) return std::nullopt;
  const std::string path = JoinPath(source.path, "excitation");
  if (source.wire.has_activation()) {
    problems.Add(path, "is given beside an activation",
                 "the activation follows from the excitation: give only one of them");
  }
  const v1::Excitation& wire = source.wire.excitation();
  Excitation excitation;
  if (wire.has_curve()) {
    excitation.curve = TranslateCurve(wire.curve(), kActivationCurve, JoinPath(path, "curve"), problems);
  } else {
    problems.Add(JoinPath(path, "curve"), "is missing", kCurveHint);
  }
  excitation.dynamics = {wire.activation_time(), wire.deactivation_time(), wire.initial_activation()};
  return excitation;
}

Parts<Curve> TranslateActivationParts(const BodySource& source, std::optional<std::size_t> elements,
                                      const NamedRegions& regions, Problems& problems) {
  const v1::Body& wire = source.wire;
  Problems own;
  Parts<Curve> parts;
  parts.of.resize(elements.value_or(0));
  for (int i = 0; i < wire.region_activations_size(); ++i) {
    const v1::RegionActivation& part = wire.region_activations(i);
    const std::string path = JoinPath(source.path, IndexPath("region_activations", static_cast<std::size_t>(i)));
    if (!part.muscle().empty()) {
      if (part.has_curve()) own.Add(JoinPath(path, "muscle"), "is given beside a curve", "give only one of them");
      parts.more.push_back(source.skeleton.ActivationOf(part.muscle(), JoinPath(path, "muscle"), own));
    } else if (part.has_curve()) {
      parts.more.push_back(TranslateCurve(part.curve(), kActivationCurve, JoinPath(path, "curve"), own));
    } else {
      own.Add(JoinPath(path, "curve"), "is missing", std::string(kCurveHint) + ", or a muscle of the skeleton");
    }
    MarkRegion(part.region(), JoinPath(path, "region"), regions, i + 1, parts.of, own);
  }
  problems.Append("", own);
  if (!own.empty() || !elements || parts.more.empty()) return {};
  return parts;
}

std::vector<double> TranslateActivationScale(const BodySource& source, std::optional<std::size_t> elements,
                                             Problems& problems) {
  if (!source.wire.has_activation_scale()) return {};
  const NumberFile scale = {"elements", elements, 1, 0, 1};
  return ReadNumberFile(source.wire.activation_scale(), scale, JoinPath(source.path, "activation_scale"), source.assets,
                        problems);
}

}  // namespace fascicle::server
