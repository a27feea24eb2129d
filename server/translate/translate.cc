#include "server/translate/translate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/eulerian/scene_body.h"
#include "core/voxel/scene_body.h"
#include "proto/rules/field_rules.h"
#include "server/translate/fibres.h"
#include "server/translate/materials.h"
#include "server/translate/meshes.h"
#include "server/translate/names.h"
#include "server/translate/outputs.h"
#include "server/translate/parts.h"
#include "server/translate/regions.h"
#include "server/translate/scene_checks.h"
#include "server/translate/supports_and_loads.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

constexpr std::size_t kMaxSceneName = 200;  // characters

// Characters of a UTF-8 text: bytes that don't continue one.
std::size_t Characters(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

void CheckHead(const v1::Scene& scene, Problems& problems) {
  if (const std::size_t length = Characters(scene.name()); length > kMaxSceneName) {
    problems.Add("name", "has " + std::to_string(length) + " characters", "at most 200; the description may be longer");
  }
  if (scene.bodies().empty()) problems.Add("bodies", "is empty", "a scene has at least one body");
}

// A body, and whether what ties its parts together (mesh, regions, supports, loads) is there for CheckScene to look at.
struct TranslatedBody {
  Body body;
  bool complete = false;
};

// What differs from element to element means nothing to a body of the eulerian method, which has none: each is named,
// and what is left holds for the whole body.
v1::Body WithoutParts(v1::Body wire, const std::string& path, Problems& problems) {
  for (const char* name :
       {"region_materials", "element_parameters", "region_activations", "activation_scale", "initial_displacement"}) {
    const auto* field = v1::Body::descriptor()->FindFieldByName(name);
    const auto& reflection = *wire.GetReflection();
    if (field->is_repeated() ? reflection.FieldSize(wire, field) == 0 : !reflection.HasField(wire, field)) continue;
    reflection.ClearField(&wire, field);
    problems.Add(JoinPath(path, name), "a body of the eulerian method has no elements to differ from each other",
                 "leave it out, or use the tet method");
  }
  return wire;
}

// A surface has no tetrahedra to have fibres each: one direction holds in all of the body.
FibreField FibresOfSurface(const v1::Body& wire, const std::string& path, Problems& problems) {
  const std::string fibres = JoinPath(path, "fibres");
  if (wire.fibres().has_pennation()) {
    problems.Add(JoinPath(fibres, "pennation"), "a surface without tetrahedra takes constant fibres without pennation",
                 "turn the constant direction");
  }
  if (wire.fibres().has_constant()) {
    return {ToDirection(wire.fibres().constant().direction(), JoinPath(fibres, "constant.direction"), problems)
                .normalized()};
  }
  problems.Add(fibres, "a surface without tetrahedra takes constant fibres only",
               "fill it by `fascicle mesh` and give the mesh as a file");
  return {Vec3::UnitX()};
}

TranslatedBody TranslateBody(const v1::Body& wire, Method method, const std::string& path, double duration,
                             const AssetReader& assets, std::int64_t& budget, Problems& problems, Profile* profile) {
  TranslatedBody result;
  Body& body = result.body;
  body.name = wire.name();
  if (std::isfinite(wire.density()) && wire.density() > 0) body.density = wire.density();
  body.material = TranslateMaterial(wire.has_material() ? &wire.material() : nullptr, path, problems);
  body.damping = TranslateDamping(wire);

  Problems structure;
  auto mesh = [&] {
    const StageTimer timer(profile, "meshes");
    return TranslateMesh(wire, method, path, assets, budget, body.notes, structure);
  }();
  TranslatedRegions regions = TranslateRegions(wire, path, mesh ? &*mesh : nullptr, structure);
  // Fibres are found with the regions of the tetrahedra, all else acts on those of the surface.
  TranslatedRegions on_surface;
  if (mesh && method == Method::kEulerian && !mesh->mesh.nodes.empty()) {
    TranslatedMesh surface;
    surface.surface = mesh->surface;
    Problems said;
    on_surface = TranslateRegions(wire, path, &surface, said);
  }
  body.constraints = TranslateConstraints(wire, path, regions.names, structure);
  body.loads = TranslateLoads(wire, path, duration, regions.names, structure);
  result.complete = structure.empty() && mesh.has_value() &&
                    std::all_of(wire.regions().begin(), wire.regions().end(), ObeysRules) &&
                    std::all_of(wire.constraints().begin(), wire.constraints().end(), ObeysRules) &&
                    std::all_of(wire.loads().begin(), wire.loads().end(), ObeysRules);
  problems.Append("", structure);

  const TranslatedMesh* elements = mesh ? &*mesh : nullptr;
  {
    const StageTimer timer(profile, "fibres");
    if (method == Method::kVoxel && wire.has_fibres()) {
      problems.Add(JoinPath(path, "fibres"), "voxels have no fibres", "leave them out, or use the tet method");
    }
    const bool bare = mesh && !mesh->surface.nodes.empty() && mesh->mesh.nodes.empty();
    body.fibres = bare && wire.has_fibres()
                      ? FibresOfSurface(wire, path, problems)
                      : TranslateFibres(wire, path, mesh ? &*mesh : nullptr, regions, assets, body.notes, problems);
  }
  const v1::Body parts = method == Method::kEulerian ? WithoutParts(wire, path, problems) : wire;
  TranslateMaterialParts(parts, path, elements, regions, assets, body, problems);
  TranslateActivations(parts, path, duration, elements, regions, assets, body, problems);
  TranslateInitialDisplacement(parts, path, elements, assets, body, problems);
  body.regions = std::move(on_surface.regions.empty() ? regions.regions : on_surface.regions);
  if (wire.has_plasticity() && ObeysRules(wire.plasticity())) {
    body.plasticity = Plasticity{wire.plasticity().yield_stress(), wire.plasticity().relaxation_time()};
  }
  if (mesh) {
    body.surface = std::move(mesh->surface);
    body.mesh = std::move(mesh->mesh);
    body.bricks = std::move(mesh->bricks);
  }
  return result;
}

}  // namespace

std::vector<std::string> AssetsOf(const v1::Scene& scene) {
  std::vector<std::string> digests;
  const auto add = [&digests](const v1::FileRef& file) {
    const std::string digest = DigestOfAsset(file.asset());
    if (!digest.empty() && std::find(digests.begin(), digests.end(), digest) == digests.end())
      digests.push_back(digest);
  };
  for (const v1::Body& body : scene.bodies()) {
    add(body.mesh().file());
    add(body.mesh().elements());
    add(body.mesh().surface());
    add(body.mesh().image().file());
    for (const v1::FileRef& file : body.mesh().image().more_files()) add(file);
    add(body.fibres().file());
    add(body.element_parameters());
    add(body.activation_scale());
    add(body.initial_displacement());
    add(body.fibres().bspline().file());
  }
  return digests;
}

std::shared_ptr<const Scene> TranslateScene(const v1::Scene& scene, const AssetReader& assets, Problems& problems,
                                            const TranslateLimits& limits, Profile* profile) {
  Problems found;
  CheckRules(scene, found);
  v1::Scene filled = scene;
  FillDefaults(filled);
  CheckHead(filled, found);

  auto result = std::make_shared<Scene>();
  result->name = filled.name();
  result->duration = filled.duration();
  result->method = filled.has_voxel() ? Method::kVoxel : filled.has_eulerian() ? Method::kEulerian : Method::kTet;
  result->tet = TranslateTetMethod(filled);
  result->voxel = TranslateVoxelMethod(filled);
  result->eulerian = TranslateEulerianMethod(filled, found);
  result->gravity = TranslateGravity(filled, found);
  result->floors = TranslateFloors(filled, found);
  result->squeezes = TranslateSqueezes(filled, found);

  Names names("body");
  std::vector<bool> complete;
  std::vector<std::string> sources;  // of the surfaces of bodies
  std::int64_t budget = limits.max_elements;
  for (int i = 0; i < filled.bodies_size(); ++i) {
    const std::string path = IndexPath("bodies", static_cast<std::size_t>(i));
    names.Add(filled.bodies(i).name(), JoinPath(path, "name"), found);
    TranslatedBody body =
        TranslateBody(filled.bodies(i), result->method, path, filled.duration(), assets, budget, found, profile);
    complete.push_back(body.complete);
    sources.push_back(SourcePath(filled.bodies(i).mesh(), path));
    if (!body.body.mesh.curved_edges.empty() && result->tet.element == ElementOrder::kLinear) {
      body.body.notes.push_back(JoinPath(path, "mesh") +
                                ": linear elements leave out that edges of the mesh are curved");
    }
    result->bodies.push_back(std::move(body.body));
  }
  result->output = TranslateOutput(filled, result->bodies, names, limits.max_frame_bytes, found);

  if (result->method == Method::kEulerian && result->eulerian.cell_size > 0) {
    const StageTimer timer(profile, "surfaces");
    CheckEulerianBodies(*result, sources, limits.max_elements, found);
  }
  if (found.empty()) {
    const StageTimer timer(profile, "checks");
    CheckScene(*result, found);
    if (found.empty()) CheckVoxelSupports(*result, found);
  }
  if (found.empty()) return result;
  CheckEachBody(std::move(*result), complete, found);
  problems.Append("", found);
  return nullptr;
}

}  // namespace fascicle::server
