#include "server/translate/bspline_fibres.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "core/geometry/bspline_reader.h"
#include "core/muscle/bspline_fibres.h"
#include "core/muscle/muscle_solid.h"
#include "server/translate/fibre_ends.h"
#include "server/translate/files.h"
#include "server/translate/kept_results.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

// The fit's matrix fills in: time grows with the third power of the size, up to some seconds.
constexpr std::int64_t kMostControls = 4000;
// More threads would slow down running jobs.
constexpr unsigned kMostThreads = 4;

std::optional<BsplineSolid> ReadSolid(const v1::FileRef& file, double unit, const std::string& path,
                                      const AssetReader& assets, Problems& problems) {
  const auto bytes = ReadFile(file, path, assets, problems);
  if (!bytes) return std::nullopt;
  Problems own;
  const auto solid = ReadBsplineSolid(*bytes, own);
  problems.Append(path, own);
  if (!solid) return std::nullopt;
  std::vector<Vec3> controls = solid->controls();
  for (Vec3& q : controls) q *= unit;
  return BsplineSolid(solid->bases(), std::move(controls));
}

// Checks that degrees match numbers of control points; the rules have been checked before.
void CheckSizes(const v1::FittedSolid& fitted, const std::string& path, Problems& problems) {
  std::int64_t controls = 1;
  for (int d = 0; d < 3; ++d) {
    Problems own;
    BsplineBasis::CheckSize(fitted.degrees(d), fitted.controls(d), own);
    problems.Append(IndexPath(JoinPath(path, "controls"), static_cast<std::size_t>(d)), own);
    controls *= fitted.controls(d);
  }
  if (controls > kMostControls) {
    problems.Add(JoinPath(path, "controls"), std::to_string(controls) + " control points are too many",
                 "at most " + std::to_string(kMostControls) + "; 5 5 16 is enough for most muscles");
  }
}

std::optional<BsplineSolid> FitSolid(const v1::FittedSolid& fitted, const std::string& path,
                                     const TranslatedTetrahedra* mesh, const NamedRegions& regions,
                                     const std::stop_token& stop, Problems& problems) {
  Problems own;
  const auto ends = FindFibreEnds(fitted, path, regions, own);
  const bool ruled = ObeysRules(fitted);
  if (ruled) CheckSizes(fitted, path, own);
  problems.Append("", own);
  if (!own.empty() || !ruled || !ends || mesh == nullptr || !mesh->sound) return std::nullopt;
  MuscleSolidOptions options;
  std::copy_n(fitted.degrees().begin(), 3, options.degrees.begin());
  std::copy_n(fitted.controls().begin(), 3, options.controls.begin());
  options.smoothing = fitted.smoothing();
  auto fit = FitMuscleSolid(mesh->mesh, ends->origin, ends->insertion, options, own, stop);
  problems.Append(path, own);
  if (!fit) return std::nullopt;
  return std::move(fit->solid);
}

std::vector<std::string> NotesOf(const BsplineFibreField& field) {
  std::vector<std::string> notes;
  const std::string of = " of " + std::to_string(field.fibres.size()) + " tetrahedra ";
  if (field.outside > 0) {
    char farthest[32];
    std::snprintf(farthest, sizeof(farthest), "%.2g mm", 1e3 * field.farthest);
    notes.push_back(std::to_string(field.outside) + of + "have their centroid outside of the solid, by " + farthest +
                    " at most; they have the fibre of the nearest point");
  }
  if (field.folded > 0) {
    notes.push_back("at the centroids of " + std::to_string(field.folded) + of +
                    "the solid is inverted, and its fibres cross");
  }
  return notes;
}

// The long computation whose result is kept. Nothing if something is wrong.
std::optional<ComputedFibres> Compute(const BodySource& source, const std::string& path,
                                      const TranslatedTetrahedra* mesh, const NamedRegions& regions,
                                      Problems& problems) {
  const StageTimer timer(source.tools.profile, "bspline");
  const v1::BsplineFibres& bspline = source.wire.fibres().bspline();
  std::optional<BsplineSolid> solid;
  if (bspline.has_file()) {
    solid = ReadSolid(bspline.file(), MetresIn(source.wire.unit()), JoinPath(path, "file"), source.assets, problems);
  } else if (bspline.has_fitted()) {
    solid = FitSolid(bspline.fitted(), JoinPath(path, "fitted"), mesh, regions, source.tools.stop, problems);
  }
  if (!solid || mesh == nullptr || !mesh->sound) return std::nullopt;
  ThreadTeam team(static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, kMostThreads)),
                  source.tools.stop);
  Problems own;
  BsplineFibreField field = BsplineFibres(mesh->mesh, BsplineLocator(std::move(*solid)), team, own);
  problems.Append(path, own);
  if (!own.empty()) return std::nullopt;
  std::vector<std::string> notes = NotesOf(field);
  return ComputedFibres{std::move(field.fibres), std::move(notes)};
}

// Everything that the fibres depend on, for a sound mesh.
ArchiveWriter InputsOf(const BodySource& source, const TetMesh& mesh, const NamedRegions& regions) {
  constexpr std::uint32_t kVersion = 1;  // version of the results of Compute
  const v1::BsplineFibres& bspline = source.wire.fibres().bspline();
  ArchiveWriter writer("B-spline fibres", kVersion);
  PutMessage("bspline", bspline, writer);
  writer.PutDouble("metres", MetresIn(source.wire.unit()));
  PutMesh(mesh, writer);
  Problems said;  // by Compute
  if (const auto ends = bspline.has_fitted() ? FindFibreEnds(bspline.fitted(), "", regions, said) : std::nullopt) {
    writer.PutInts("origin", ends->origin);
    writer.PutInts("insertion", ends->insertion);
  }
  return writer;
}

}  // namespace

FibreField TranslateBsplineFibres(const BodySource& source, const std::string& path, const TranslatedTetrahedra* mesh,
                                  const NamedRegions& regions, std::vector<std::string>& notes, Problems& problems) {
  const auto compute = [&] { return Compute(source, path, mesh, regions, problems); };
  if (mesh == nullptr || !mesh->sound) {
    compute();  // reports problems of the solid, too
    return {};
  }
  auto computed = Kept<ComputedFibres>(
      source.tools, [&] { return InputsOf(source, mesh->mesh, regions); }, compute);
  if (!computed) return {};
  for (const std::string& note : computed->notes) notes.push_back(path + ": " + note);
  return OfElements(mesh->mesh, std::move(computed->fibres));
}

}  // namespace fascicle::server
