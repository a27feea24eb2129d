#include "client/import/febio_import.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include "client/import/body_draft.h"
#include "client/import/losses.h"
#include "client/import/sections.h"
#include "core/geometry/text_scanner.h"
#include "proto/rules/field_rules.h"

namespace fascicle::client {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxBodies = 1000;
constexpr double kMaxFrames = 100'000;  // of a scene
constexpr double kMinTissue = 50;       // [kg/m^3]

// The elements that contain sections: the model itself and its first step.
std::vector<pugi::xml_node> Holders(XmlSource& source) {
  std::vector<pugi::xml_node> holders = {source.root()};
  for (const pugi::xml_node list : source.root().children("Step")) {
    source.Take(list);
    // Versions 3 and 4 have <Step><step>...; a <Step> may also occur by itself.
    std::vector<pugi::xml_node> steps;
    for (const pugi::xml_node step : list.children("step")) steps.push_back(step);
    if (steps.empty()) steps.push_back(list);
    for (const pugi::xml_node step : steps) {
      if (holders.size() == 1) {
        source.Take(step);
        holders.push_back(step);
      } else {
        source.Tell(Notice::Kind::kNotTaken, step, "a scene has one step: this one is not the first",
                    "continue the load curves of the first step, or remove it");
      }
    }
  }
  return holders;
}

class Importer {
 public:
  Importer(const FebioOptions& options, XmlSource& source)
      : options_(options), source_(source), holders_(Holders(source)) {}

  bool Read() {
    const pugi::xml_node root = source_.root();
    source_.Take(root);
    if (std::string_view(root.name()) != "febio_spec") {
      source_.Fail(root, "the file is not a FEBio model: it starts with " + Quoted(root.name()), "give a .feb file");
      return false;
    }
    model_.version = root.attribute("version").value();
    if (model_.version != "4.0" && model_.version != "3.0" && model_.version != "2.5") {
      source_.Fail(root, "the format's version is " + Quoted(model_.version),
                   "versions 4.0, 3.0 and 2.5 are read: save it again with FEBio Studio");
      return false;
    }
    RefuseOtherFiles();
    SetUnits();
    ForEach("Module", [&](pugi::xml_node n) { ReadModule(n, source_, model_); });
    bool has_control = false;
    ForEach("Control", [&](pugi::xml_node n) {
      if (!std::exchange(has_control, true)) ReadControl(n, source_, model_);
    });
    if (!has_control) source_.Fail(root, "has no Control section", "it says how long to simulate");
    if (model_.units.name.empty()) AssumeUnits();
    for (const char* name : {"Globals", "Output"}) ForEach(name, [&](pugi::xml_node n) { source_.TakeAll(n); });
    ReadMeshSections(root);
    ForEach("LoadData", [&](pugi::xml_node n) { ReadLoadData(n, source_, model_); });
    ReadLaws(source_, model_);
    ForEach("Boundary", [&](pugi::xml_node n) { ReadBoundary(n, source_, model_); });
    ForEach("Rigid", [&](pugi::xml_node n) { ReadRigid(n, source_, model_); });
    ForEach("Constraints", [&](pugi::xml_node n) {
      if (n.child("rigid_body")) ReadRigid(n, source_, model_);
    });
    ForEach("Loads", [&](pugi::xml_node n) { ReadLoads(n, source_, model_); });
    HoldRigidNodes(source_, model_);
    return true;
  }

  std::optional<ImportedScene> Make() {
    ImportedScene result;
    const Tetrahedra all = MakeTetrahedra(model_.mesh, model_.of_hexahedra);
    const std::vector<MeshBody> bodies = MakeBodies(all);
    TellOfBodies(bodies);
    if (bodies.size() > kMaxBodies) return std::nullopt;
    std::vector<BodyDraft> drafts = Draft(bodies, result.scene);
    CurveMaker curves(model_, source_);
    ScaleActivations(model_, curves);
    for (BodyDraft& draft : drafts) {
      DraftMesh(model_, all, source_, draft);
      SetMaterials(model_, source_, curves, origins_, draft);
      SetFibres(model_, all, source_, draft, result.files);
    }
    SetSupports(model_, source_, curves, origins_, drafts);
    SetLoads(model_, all, source_, curves, origins_, drafts);
    SetGravity(curves, result.scene);
    if (bodies.empty()) return std::nullopt;
    SetMethod(bodies, result.scene);
    std::vector<ImportedFile> meshes;
    for (const BodyDraft& draft : drafts) {
      meshes.push_back({draft.body.name() + ".msh", MeshText(model_, all, source_, draft)});
    }
    result.files.insert(result.files.begin(), std::make_move_iterator(meshes.begin()),
                        std::make_move_iterator(meshes.end()));
    CheckFields(result.scene);
    result.units = model_.units.name;
    result.version = model_.version;
    return result;
  }

 private:
  template <class Use>
  void ForEach(const char* name, const Use& use) {
    for (const pugi::xml_node holder : holders_) {
      for (const pugi::xml_node section : holder.children(name)) use(section);
    }
  }

  void RefuseOtherFiles() {
    for (const pugi::xml_node holder : holders_) {
      for (const pugi::xml_node section : holder.children()) {
        if (std::string_view(section.name()) != "Include" && !section.attribute("from")) continue;
        source_.Fail(section, "is in another file, which is not supported", "put its content here");
      }
    }
  }

  void SetUnits() {
    if (options_.units.empty()) return;
    if (const auto system = UnitSystemNamed(options_.units)) {
      model_.units = *system;
    } else {
      source_.Fail(source_.root(), "the units " + Quoted(options_.units) + " are not known",
                   "--units is one of " + KnownUnitSystems());
    }
  }

  // Files without units have any: answers in the model's own numbers are the same in all consistent systems. Where the
  // density counts, the system is one in which it is that of tissue.
  void AssumeUnits() {
    model_.units = *UnitSystemNamed("mm-N-s");
    pugi::xml_node origin;
    double density = 0;
    for (const pugi::xml_node material : source_.root().child("Material").children("material")) {
      const pugi::xml_node child = material.child("density");
      if (!child || std::string_view(material.attribute("type").value()) == "rigid body") continue;
      if (child.text().as_double() <= density) continue;
      density = child.text().as_double();
      origin = child;
    }
    bool counts = model_.control.dynamic;
    ForEach("Loads", [&](pugi::xml_node n) { counts = counts || n.child("body_load"); });
    if (!counts || density * model_.units.density <= kMaxSceneDensity) return;
    const double in_model = density;
    for (const char* name : {"CGS", "SI", "mm-kg-s"}) {
      const UnitSystem system = *UnitSystemNamed(name);
      if (density * system.density < kMinTissue || density * system.density > kMaxSceneDensity) continue;
      char text[200];
      std::snprintf(text, sizeof(text),
                    "no units are named, and %g would be %.3g kg/m^3 in mm-N-s: taken as %s, where it is %.4g kg/m^3",
                    in_model, in_model * model_.units.density, name, in_model * system.density);
      source_.Remark(Notice::Kind::kNote, origin, std::string(text) + "; --units gives others");
      model_.units = system;
      return;
    }
  }

  void ReadMeshSections(pugi::xml_node root) {
    const char* mesh = MeshSection();
    if (!root.child(mesh)) source_.Fail(root, "has no " + std::string(mesh) + " section", "is the file complete?");
    if (!root.child("Material")) source_.Fail(root, "has no Material section", "is the file complete?");
    for (const pugi::xml_node n : root.children(mesh)) ReadMesh(n, source_, model_);
    for (const pugi::xml_node n : root.children("Material")) ReadMaterials(n, source_, model_);
    if (!root.child("MeshDomains") && !model_.mesh.parts.empty()) {
      ReadMeshDomains(pugi::xml_node(), options_.split_hexahedra, source_, model_);
    }
    for (const pugi::xml_node n : root.children("MeshDomains")) {
      ReadMeshDomains(n, options_.split_hexahedra, source_, model_);
    }
    for (const pugi::xml_node n : root.children("MeshData")) ReadMeshData(n, source_, model_);
  }

  // Version 2.5 has the mesh in another section.
  const char* MeshSection() const { return model_.version == "2.5" ? "Geometry" : "Mesh"; }

  void TellOfBodies(const std::vector<MeshBody>& bodies) {
    const pugi::xml_node mesh = source_.root().child(MeshSection());
    if (bodies.empty() && source_.failures() == 0) {
      source_.Fail(mesh, "no part of the mesh is supported", "a scene needs at least one deformable part");
    }
    if (bodies.size() > kMaxBodies) {
      source_.Fail(mesh, "falls into " + std::to_string(bodies.size()) + " parts without a common face",
                   "merge the nodes of neighbouring elements");
    } else if (bodies.size() > 1) {
      source_.Remark(Notice::Kind::kNote, mesh,
                     "its parts without a common face are " + std::to_string(bodies.size()) +
                         " bodies, which pass through each other");
    }
  }

  std::vector<BodyDraft> Draft(const std::vector<MeshBody>& bodies, v1::Scene& scene) const {
    std::vector<BodyDraft> drafts;
    std::set<std::string> names;
    scene.mutable_bodies()->Reserve(static_cast<int>(bodies.size()));  // drafts point to them
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      v1::Body& body = *scene.add_bodies();
      body.set_name(NewName(model_.mesh.parts[static_cast<std::size_t>(bodies[b].parts[0])].name, names));
      body.set_unit(model_.units.scene_unit);
      body.mutable_mesh()->mutable_file()->set_path(body.name() + ".msh");
      drafts.emplace_back(bodies[b], IndexPath("bodies", b), body);
    }
    return drafts;
  }

  void SetGravity(CurveMaker& curves, v1::Scene& scene) {
    if (model_.body_forces.empty()) return;
    constexpr double kMaxFactor = 1000;
    const BodyForce& first = model_.body_forces.front();
    Vec3 acceleration = Vec3::Zero();
    for (const BodyForce& force : model_.body_forces) {
      if (force.controller != first.controller) {
        source_.Fail(force.node, "follows another load curve than the other body forces", "gravity has one");
        continue;
      }
      acceleration += model_.units.metre * force.acceleration;
    }
    for (const double component : acceleration) scene.mutable_gravity()->add_acceleration(component);
    origins_["gravity"] = first.node;
    if (!first.controller) return;
    const auto scale = curves.Make(1, first.controller, -kMaxFactor, kMaxFactor, first.node);
    if (scale) *scene.mutable_gravity()->mutable_scale() = *scale;
  }

  void SetMethod(const std::vector<MeshBody>& bodies, v1::Scene& scene) {
    const Control& control = model_.control;
    scene.set_name(options_.name.substr(0, 200));
    const double duration = control.steps * control.step_size;
    scene.set_duration(duration);
    origins_["duration"] = origins_["output"] = control.node;
    double interval = control.step_size * control.stride;
    if (interval > duration) interval = duration;
    scene.mutable_output()->set_frame_interval(interval);
    if (control.steps > kMaxFrames * control.stride) {
      source_.Fail(control.node, "has more than 100,000 time steps", "give a larger step_size, or a plot_stride");
    }
    for (const v1::Field field : {v1::FIELD_VOLUME_RATIO, v1::FIELD_VON_MISES_STRESS}) {
      scene.mutable_output()->add_fields(field);
    }
    const auto has_fibres = [](const v1::Body& body) { return body.has_fibres(); };
    if (std::all_of(scene.bodies().begin(), scene.bodies().end(), has_fibres)) {
      scene.mutable_output()->add_fields(v1::FIELD_FIBRE_STRETCH);
    }
    scene.mutable_tet()->set_stepping(control.dynamic ? v1::STEPPING_NEWMARK : v1::STEPPING_QUASI_STATIC);
    SetElement(bodies, scene);
  }

  // Elements as in the model: tetrahedra of four or ten nodes, or hexahedra. Those that are split become the default
  // element of the stepping.
  void SetElement(const std::vector<MeshBody>& bodies, v1::Scene& scene) {
    if (model_.of_hexahedra) {
      scene.mutable_tet()->set_element(v1::ELEMENT_HEXAHEDRAL);
      return;
    }
    bool any_quadratic = false, any_split = false, any_linear = false;
    for (const MeshBody& body : bodies) {
      any_quadratic = any_quadratic || body.quadratic;
      for (const std::int32_t p : body.parts) {
        const Shape shape = model_.mesh.parts[static_cast<std::size_t>(p)].shape;
        any_linear = any_linear || shape == Shape::kTet4;
        any_split = any_split || (shape != Shape::kTet4 && shape != Shape::kTet10);
      }
    }
    if (any_quadratic) {
      scene.mutable_tet()->set_element(v1::ELEMENT_QUADRATIC);
    } else if (!any_split) {
      scene.mutable_tet()->set_element(v1::ELEMENT_LINEAR);
    }
    if (any_linear && (any_quadratic || any_split)) {
      const pugi::xml_node mesh = source_.root().child(MeshSection());
      source_.Remark(Notice::Kind::kChanged, mesh,
                     "elements of four nodes become elements of ten nodes, like others of the model",
                     "mesh the model with one element type");
    }
  }

  // Reports violations of the proto's rules at the lines from which the numbers came.
  void CheckFields(const v1::Scene& scene) {
    if (source_.failures() > 0) return;
    Problems problems;
    CheckRules(scene, problems);
    for (const Problem& problem : problems.kept()) {
      // The origin of the longest prefix of the field's path.
      pugi::xml_node origin = source_.root();
      std::size_t longest = 0;
      for (const auto& [path, node] : origins_) {
        if (!problem.path.starts_with(path) || path.size() < longest) continue;
        longest = path.size();
        origin = node;
      }
      source_.Fail(origin, problem.path + " " + problem.message, problem.hint);
    }
  }

  const FebioOptions& options_;
  XmlSource& source_;
  std::vector<pugi::xml_node> holders_;
  Model model_;
  Origins origins_;
};

}  // namespace

std::optional<ImportedScene> ImportFebio(std::string_view bytes, const FebioOptions& options, Problems& problems) {
  Problems own;
  std::optional<ImportedScene> result;
  if (bytes.size() > kMaxBytes) {
    own.Add(options.name, "is larger than 1 GiB", "use a coarser mesh");
  } else {
    XmlSource source(options.name, bytes, own);
    if (own.empty()) {
      Importer importer(options, source);
      if (importer.Read()) result = importer.Make();
      source.TellOfTheRest();
      if (result) result->notices = std::move(source.notices);
      if (result && own.empty() && !options.accept_loss) RefuseLosses(result->notices, own);
    }
  }
  problems.Append("", own);
  return own.empty() ? std::move(result) : std::nullopt;
}

}  // namespace fascicle::client
