#include "server/translate/fibres.h"

#include <utility>

#include "server/translate/materials.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

FibreField TranslateHarmonic(const v1::HarmonicFibres& harmonic, const std::string& path, const TranslatedMesh* mesh,
                             const TranslatedRegions& regions, Problems& problems) {
  const auto origin = regions.names.Find(harmonic.origin(), JoinPath(path, "origin"), problems);
  const auto insertion = regions.names.Find(harmonic.insertion(), JoinPath(path, "insertion"), problems);
  if (!origin || !insertion) return {};
  if (*origin == *insertion) {
    problems.Add(JoinPath(path, "insertion"), "is the region of the origin, too", "give two different regions");
    return {};
  }
  const auto& from = regions.regions[*origin].nodes;
  const auto& to = regions.regions[*insertion].nodes;
  // Empty regions and broken meshes have been reported.
  if (mesh == nullptr || !mesh->sound || from.empty() || to.empty()) return {};
  Problems own;
  FibreField fibres = HarmonicFibres(mesh->mesh, from, to, own);
  problems.Append(path, own);
  return own.empty() ? fibres : FibreField();
}

FibreField TranslateSource(const v1::Fibres& fibres, const std::string& path, const TranslatedMesh* mesh,
                           const TranslatedRegions& regions, const AssetReader& assets, Problems& problems) {
  if (fibres.has_constant()) {
    Problems own;
    const Vec3 direction = ToDirection(fibres.constant().direction(), JoinPath(path, "constant.direction"), own);
    problems.Append("", own);
    return own.empty() && mesh != nullptr && ObeysRules(fibres) ? ConstantFibres(mesh->mesh, direction) : FibreField();
  }
  if (fibres.has_harmonic()) {
    return TranslateHarmonic(fibres.harmonic(), JoinPath(path, "harmonic"), mesh, regions, problems);
  }
  if (!fibres.has_file()) return {};
  const std::string file_path = JoinPath(path, "file");
  const auto bytes = ReadFile(fibres.file(), file_path, assets, problems);
  if (!bytes || mesh == nullptr) return {};
  Problems own;
  FibreField field = ReadFibres(mesh->mesh, *bytes, own);
  problems.Append(file_path, own);
  return own.empty() ? field : FibreField();
}

// A law of the body, or of a part of it, that needs fibres; nullptr when none does.
const LawInfo* LawWithFibres(const v1::Body& body) {
  const LawInfo* law = LawOf(body.material());
  if (law != nullptr && law->needs_fibres) return law;
  for (const v1::RegionMaterial& part : body.region_materials()) {
    law = LawOf(part.material());
    if (law != nullptr && law->needs_fibres) return law;
  }
  return nullptr;
}

}  // namespace

FibreField TranslateFibres(const v1::Body& body, const std::string& body_path, const TranslatedMesh* mesh,
                           const TranslatedRegions& regions, const AssetReader& assets, Problems& problems) {
  const std::string path = JoinPath(body_path, "fibres");
  FibreField fibres;
  if (body.has_fibres()) {
    fibres = TranslateSource(body.fibres(), path, mesh, regions, assets, problems);
  } else if (const LawInfo* law = LawWithFibres(body)) {
    problems.Add(path, std::string("is missing: the law `") + law->name + "` needs fibre directions",
                 "give one of: constant, file, harmonic");
  } else {
    return {};
  }
  if (fibres.empty() && mesh != nullptr) return ConstantFibres(mesh->mesh, Vec3::UnitZ());
  return fibres;
}

}  // namespace fascicle::server
