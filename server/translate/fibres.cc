#include "server/translate/fibres.h"

#include <utility>

#include "core/muscle/pennation.h"
#include "server/translate/bspline_fibres.h"
#include "server/translate/fibre_ends.h"
#include "server/translate/files.h"
#include "server/translate/kept_results.h"
#include "server/translate/materials.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

FibreField TranslateHarmonic(const BodySource& source, const std::string& path, const TranslatedTetrahedra* mesh,
                             const NamedRegions& regions, Problems& problems) {
  constexpr std::uint32_t kVersion = 1;  // version of the results of HarmonicFibres
  const auto ends = FindFibreEnds(source.wire.fibres().harmonic(), path, regions, problems);
  // Invalid meshes have been reported.
  if (!ends || mesh == nullptr || !mesh->sound) return {};
  const auto inputs = [&] {
    ArchiveWriter writer("harmonic fibres", kVersion);
    PutMesh(mesh->mesh, writer);
    writer.PutInts("origin", ends->origin);
    writer.PutInts("insertion", ends->insertion);
    return writer;
  };
  const auto compute = [&]() -> std::optional<ComputedFibres> {
    const StageTimer timer(source.tools.profile, "harmonic");
    Problems own;
    FibreField fibres = HarmonicFibres(mesh->mesh, ends->origin, ends->insertion, own, source.tools.stop);
    problems.Append(path, own);
    if (!own.empty()) return std::nullopt;
    return ComputedFibres{std::move(fibres), {}};
  };
  auto computed = Kept<ComputedFibres>(source.tools, inputs, compute);
  return computed ? OfElements(mesh->mesh, std::move(computed->fibres)) : FibreField();
}

FibreField TranslateField(const BodySource& source, const std::string& path, const TranslatedTetrahedra* mesh,
                          const NamedRegions& regions, std::vector<std::string>& notes, Problems& problems) {
  const v1::Fibres& fibres = source.wire.fibres();
  if (fibres.has_constant()) {
    Problems own;
    const Vec3 direction = ToDirection(fibres.constant().direction(), JoinPath(path, "constant.direction"), own);
    problems.Append("", own);
    return own.empty() && mesh != nullptr && ObeysRules(fibres) ? ConstantFibres(mesh->mesh, direction) : FibreField();
  }
  if (fibres.has_harmonic()) {
    return TranslateHarmonic(source, JoinPath(path, "harmonic"), mesh, regions, problems);
  }
  if (fibres.has_bspline()) {
    return TranslateBsplineFibres(source, JoinPath(path, "bspline"), mesh, regions, notes, problems);
  }
  if (!fibres.has_file()) return {};
  const std::string file_path = JoinPath(path, "file");
  const auto bytes = ReadFile(fibres.file(), file_path, source.assets, problems);
  if (!bytes || mesh == nullptr) return {};
  Problems own;
  FibreField field = ReadFibres(mesh->mesh, *bytes, own);
  problems.Append(file_path, own);
  return own.empty() ? field : FibreField();
}

// A law of the body, or of a part of it, that needs fibres; null if none does.
const LawInfo* LawWithFibres(const v1::Body& body) {
  const LawInfo* law = LawOf(body.material());
  if (law != nullptr && law->needs_fibres) return law;
  for (const v1::RegionMaterial& part : body.region_materials()) {
    law = LawOf(part.material());
    if (law != nullptr && law->needs_fibres) return law;
  }
  return nullptr;
}

void TranslatePennation(const v1::Pennation& wire, double unit, const std::string& path,
                        const TranslatedTetrahedra* mesh, FibreField& fibres, Problems& problems) {
  Problems own;
  Pennation pennation{.angle = wire.angle(), .normal = ToDirection(wire.normal(), "normal", own), .mirror_point = {}};
  if (wire.mirror_point_size() == 3) pennation.mirror_point = unit * ToVec3(wire.mirror_point());
  if (own.empty() && ObeysRules(wire) && mesh != nullptr && !fibres.empty()) {
    Pennate(mesh->mesh, pennation, fibres, own);
  }
  problems.Append(path, own);
}

}  // namespace

void CheckFibresAreGiven(const BodySource& source, Problems& problems) {
  const LawInfo* law = LawWithFibres(source.wire);
  if (law == nullptr || source.wire.has_fibres()) return;
  problems.Add(JoinPath(source.path, "fibres"),
               std::string("is missing: the law `") + law->name + "` needs fibre directions",
               "give one of: constant, file, harmonic, bspline");
}

FibreField TranslateFibres(const BodySource& source, const TranslatedTetrahedra* mesh, const NamedRegions& regions,
                           std::vector<std::string>& notes, Problems& problems) {
  const StageTimer timer(source.tools.profile, "fibres");
  CheckFibresAreGiven(source, problems);
  const v1::Body& wire = source.wire;
  FibreField fibres;
  if (wire.has_fibres()) {
    const std::string path = JoinPath(source.path, "fibres");
    fibres = TranslateField(source, path, mesh, regions, notes, problems);
    if (wire.fibres().has_pennation()) {
      TranslatePennation(wire.fibres().pennation(), MetresIn(wire.unit()), JoinPath(path, "pennation"), mesh, fibres,
                         problems);
    }
  } else if (LawWithFibres(wire) == nullptr) {
    return {};
  }
  if (fibres.empty() && mesh != nullptr) return ConstantFibres(mesh->mesh, Vec3::UnitZ());
  return fibres;
}

}  // namespace fascicle::server
