#include "server/translate/translate.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/base/stop.h"
#include "core/eulerian/scene_body.h"
#include "core/sim/job_size.h"
#include "core/voxel/scene_body.h"
#include "proto/rules/field_rules.h"
#include "proto/rules/find_messages.h"
#include "server/translate/bodies.h"
#include "server/translate/contacts.h"
#include "server/translate/files.h"
#include "server/translate/meshes.h"
#include "server/translate/methods.h"
#include "server/translate/names.h"
#include "server/translate/outputs.h"
#include "server/translate/rigid_bodies.h"
#include "server/translate/scene_checks.h"
#include "server/translate/skeleton.h"
#include "server/translate/start.h"
#include "server/translate/supports_and_loads.h"
#include "server/translate/unused_fields.h"

namespace fascicle::server {
namespace {

constexpr std::size_t kMaxSceneName = 200;  // characters

// Number of characters in a UTF-8 text: bytes that are not continuation bytes.
std::size_t Characters(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

void CheckHead(const v1::Scene& scene, Problems& problems) {
  if (const std::size_t length = Characters(scene.name()); length > kMaxSceneName) {
    problems.Add("name", "has " + std::to_string(length) + " characters", "at most 200; the description may be longer");
  }
  if (scene.bodies().empty() && !scene.has_skeleton()) {
    problems.Add("bodies", "is empty", "a scene has at least one body, or a skeleton");
  }
}

void AddCurvedEdgesNote(const TetMethod& method, const std::string& path, Body& body) {
  const auto* tet = std::get_if<TetShape>(&body.shape);
  if (tet == nullptr || tet->mesh.curved_edges.empty() ||
      (method.element != ElementOrder::kLinear && method.element != ElementOrder::kHexahedral))
    return;
  body.notes.push_back(JoinPath(path, "mesh") +
                       ": elements without mid-edge nodes ignore that edges of the mesh are curved");
}

std::string Gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g GB", bytes / 1e9);
  return text;
}

// What the run would need, before anything is allocated for it.
void CheckJobSize(const Scene& scene, const TranslateLimits& limits, Problems& problems) {
  const JobSize size = JobSizeOf(scene);
  const auto max_memory = static_cast<double>(limits.max_memory),
             max_stored = static_cast<double>(limits.max_stored_bytes);
  if (size.memory > max_memory) {
    problems.Add(
        "bodies",
        "need about " + Gigabytes(size.memory) + " of memory, " + Gigabytes(max_memory) + " are allowed to a job",
        "use coarser meshes or grids, or an iterative linear solver in place of a direct one");
  }
  if (size.stored > max_stored) {
    problems.Add(
        "output",
        "needs about " + Gigabytes(size.stored) + " of the server's disk, " + Gigabytes(max_stored) + " are left",
        "use a longer frame_interval, fewer fields or a coarser mesh, or delete jobs");
  }
}

}  // namespace

std::vector<std::string> AssetsOf(const v1::Scene& scene) {
  std::vector<std::string> digests;
  ForEachMessage<v1::FileRef>(scene, "", [&digests](const v1::FileRef& file, const std::string&) {
    const std::string digest = DigestOfAsset(file.asset());
    if (digest.empty() || std::find(digests.begin(), digests.end(), digest) != digests.end()) return;
    digests.push_back(digest);
  });
  return digests;
}

std::shared_ptr<const Scene> TranslateScene(const v1::Scene& scene, const AssetReader& assets, Problems& problems,
                                            const TranslateLimits& limits, const TranslateTools& tools) {
  Problems found;
  CheckRules(scene, found);
  v1::Scene filled = scene;
  FillDefaults(filled);
  CheckHead(filled, found);

  auto result = std::make_shared<Scene>();
  result->name = filled.name();
  result->duration = filled.duration();
  const int refinements = RefinementsOf(filled);
  result->method = filled.has_voxel() ? Method::kVoxel : filled.has_eulerian() ? Method::kEulerian : Method::kTet;
  result->tet = TranslateTetMethod(filled);
  result->voxel = TranslateVoxelMethod(filled);
  result->eulerian = TranslateEulerianMethod(filled, found);
  result->gravity = TranslateGravity(filled, found);
  result->floors = TranslateFloors(filled, found);
  result->squeezes = TranslatePlaneForceFields(filled, found);
  TranslatedSkeleton skeleton = TranslateSkeleton(filled, result->gravity, assets, tools, found);

  const bool hexahedral = result->method == Method::kTet && IsHexahedral(result->tet.element);
  const Cells cells = hexahedral ? Cells::kHexahedra : Cells::kTetrahedra;
  const bool quadratic = result->method == Method::kTet && result->tet.element == ElementOrder::kQuadratic;
  Names names("body");
  std::vector<bool> complete;
  std::vector<std::string> sources;  // of the surfaces of bodies
  std::int64_t budget = limits.max_elements;
  for (int i = 0; i < filled.bodies_size(); ++i) {
    ThrowIfStopped(tools.stop);
    const std::string path = IndexPath("bodies", static_cast<std::size_t>(i));
    names.Add(filled.bodies(i).name(), JoinPath(path, "name"), found);
    const BodySource source = {filled.bodies(i), path, assets, budget, tools, skeleton, refinements, cells, quadratic};
    TranslatedBody body = TranslateBody(source, result->method, found);
    complete.push_back(body.complete);
    sources.push_back(SourcePath(filled.bodies(i).mesh(), path));
    AddCurvedEdgesNote(result->tet, path, body.body);
    result->bodies.push_back(std::move(body.body));
  }
  std::vector<std::string> notes;
  result->rigid_bodies = TranslateRigidBodies(filled, {assets, tools.stop}, names, notes, found);
  result->contacts = TranslateContacts(filled, names, found);
  if (!result->contacts.empty()) {
    notes.push_back("contacts: bodies do not touch themselves; their folds would pass through each other");
  }
  if (!result->bodies.empty()) {
    result->bodies.front().notes.insert(result->bodies.front().notes.end(), notes.begin(), notes.end());
  }
  result->skeleton = std::move(skeleton.driven);
  TranslateStart(filled, assets, *result, found);
  FindEndsOfLineSprings(filled, names, result->bodies, found);
  result->output = TranslateOutput(filled, result->method, result->tet.element, result->bodies, names,
                                   limits.max_frame_bytes, found);
  AddUnusedFieldNotes(scene, result->bodies);
  if (result->skeleton) AddUnusedSkeletonNotes(scene, result->skeleton->notes);

  if (result->method == Method::kEulerian && result->eulerian.cell_size > 0) {
    const StageTimer timer(tools.profile, "surfaces");
    CheckEulerianBodies(*result, sources, limits.max_elements, found);
  }
  if (found.empty()) {
    const StageTimer timer(tools.profile, "checks");
    CheckScene(*result, found, tools.stop);
    ThrowIfStopped(tools.stop);
    if (found.empty()) CheckVoxelSupports(*result, found, tools.stop);
    if (found.empty()) CheckJobSize(*result, limits, found);
  }
  if (found.empty()) return result;
  CheckEachBody(std::move(*result), complete, found);
  problems.Append("", found);
  return nullptr;
}

}  // namespace fascicle::server
