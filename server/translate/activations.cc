#include <cmath>
#include <utility>

#include "core/muscle/activation.h"
#include "server/translate/curves.h"
#include "server/translate/number_files.h"
#include "server/translate/parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

const char kCurveHint[] = "give times [s] and values in [0, 1]";

Curve TranslateExcitation(const v1::Excitation& excitation, double duration, const std::string& path,
                          Problems& problems) {
  Problems own;
  Curve curve = Curve::Constant(0);
  if (excitation.has_curve()) {
    curve = TranslateCurve(excitation.curve(), kActivationCurve, JoinPath(path, "curve"), own);
  } else {
    own.Add(JoinPath(path, "curve"), "is missing", kCurveHint);
  }
  problems.Append("", own);
  // Durations out of range are reported with the rules.
  if (!own.empty() || !ObeysRules(excitation) || !(duration > 0 && duration <= 1000)) return Curve::Constant(0);
  const ActivationDynamics dynamics = {excitation.activation_time(), excitation.deactivation_time(),
                                       excitation.initial_activation()};
  Problems dynamic;
  Curve activation = ActivationOf(curve, dynamics, duration, dynamic);
  problems.Append(path, dynamic);
  return activation;
}

void TranslateRegionActivations(const v1::Body& body, const std::string& body_path, const TranslatedMesh* mesh,
                                const TranslatedRegions& regions, Body& result, Problems& problems) {
  Problems own;
  std::vector<Curve> curves;
  std::vector<std::int32_t> parts(mesh != nullptr ? mesh->elements() : 0);
  for (int i = 0; i < body.region_activations_size(); ++i) {
    const v1::RegionActivation& part = body.region_activations(i);
    const std::string path = JoinPath(body_path, IndexPath("region_activations", static_cast<std::size_t>(i)));
    if (part.has_curve()) {
      curves.push_back(TranslateCurve(part.curve(), kActivationCurve, JoinPath(path, "curve"), own));
    } else {
      own.Add(JoinPath(path, "curve"), "is missing", kCurveHint);
    }
    MarkRegion(part.region(), JoinPath(path, "region"), regions, i + 1, parts, own);
  }
  problems.Append("", own);
  if (!own.empty() || mesh == nullptr || curves.empty()) return;
  result.more_activations = std::move(curves);
  result.activation_of = std::move(parts);
}

}  // namespace

void TranslateActivations(const v1::Body& body, const std::string& body_path, double duration,
                          const TranslatedMesh* mesh, const TranslatedRegions& regions, const AssetReader& assets,
                          Body& result, Problems& problems) {
  if (body.has_activation()) {
    result.activation =
        TranslateCurve(body.activation(), kActivationCurve, JoinPath(body_path, "activation"), problems);
  }
  if (body.has_excitation()) {
    const std::string path = JoinPath(body_path, "excitation");
    if (body.has_activation()) {
      problems.Add(path, "is given beside an activation",
                   "the activation follows from the excitation: give one of them");
    }
    result.activation = TranslateExcitation(body.excitation(), duration, path, problems);
  }
  TranslateRegionActivations(body, body_path, mesh, regions, result, problems);
  if (body.has_activation_scale()) {
    NumberFile scale = {"elements", std::nullopt, 1, 0, 1};
    if (mesh != nullptr) scale.lines = mesh->elements();
    result.activation_scale =
        ReadNumberFile(body.activation_scale(), scale, JoinPath(body_path, "activation_scale"), assets, problems);
  }
}

}  // namespace fascicle::server
