// The mesh file of a body.
#include <algorithm>
#include <string_view>

#include "client/import/body_draft.h"
#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"

namespace fascicle::client {
namespace {

// The element of a tetrahedron, for messages. Found by its number, which is slow.
pugi::xml_node ElementNode(const Model& model, const Tetrahedra& all, std::size_t t) {
  const Part& part = model.mesh.parts[static_cast<std::size_t>(all.part[t])];
  const std::string id = std::to_string(part.ids[static_cast<std::size_t>(all.element[t])]);
  for (const pugi::xml_node node : part.node.children()) {
    if (id == node.attribute("id").value()) return node;
  }
  return part.node;
}

pugi::xml_node FirstPart(const Model& model, const BodyDraft& draft) {
  return model.mesh.parts[static_cast<std::size_t>(draft.mesh.parts[0])].node;
}

// Reports inverted elements among others that are not. Returns whether there are any.
bool TellOfInverted(const Model& model, const Tetrahedra& all, const TetMesh& mesh, XmlSource& source,
                    const BodyDraft& draft) {
  constexpr int kExamples = 5;
  int found = 0;
  std::pair<std::int32_t, std::int32_t> last = {-1, -1};
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    if (SignedVolume(mesh, i) > 0) continue;
    const std::size_t t = draft.mesh.tetrahedra[i];
    const std::pair element(all.part[t], all.element[t]);
    if (element == last) continue;
    last = element;
    if (++found > kExamples || source.failures() > 4 * kExamples) continue;
    source.Fail(ElementNode(model, all, t), "the element is inverted or flat", "mesh the body again");
  }
  if (found > kExamples) {
    source.Fail(FirstPart(model, draft), std::to_string(found) + " elements in all are inverted or flat",
                "mesh the body again");
  }
  return found > 0;
}

// Reads and checks the file as a server would.
void Check(const Model& model, const Tetrahedra& all, const std::string& text, XmlSource& source,
           const BodyDraft& draft) {
  const pugi::xml_node part = FirstPart(model, draft);
  Problems problems;
  std::optional<TetMesh> read = ReadMesh({"body.msh", text, {}}, problems);
  for (const Problem& problem : problems.kept()) {
    source.Fail(part, "body " + draft.body.name() + ": " + problem.message, problem.hint);
  }
  if (!read) return;
  TetMesh& mesh = *read;
  const double metres = model.units.metre / model.units.to_scene_unit;
  for (Vec3& node : mesh.nodes) node *= metres;
  for (CurvedEdge& edge : mesh.curved_edges) edge.middle *= metres;
  OrientConsistently(mesh);
  if (TellOfInverted(model, all, mesh, source, draft)) return;
  CheckMesh(mesh, problems);
  for (const Problem& problem : problems.kept()) {
    const bool is_size = problem.message.find(" long; no muscle") != std::string::npos;
    source.Fail(part, "body " + draft.body.name() + ": " + problem.message,
                is_size ? "the units are taken as " + model.units.name + ": give others with --units" : problem.hint);
  }
}

}  // namespace

void DraftMesh(const Model& model, const Tetrahedra& all, XmlSource& source, BodyDraft& draft) {
  MeshToWrite& file = draft.file;
  for (const std::int32_t n : draft.mesh.nodes) {
    file.nodes.push_back(model.units.to_scene_unit * model.mesh.nodes[static_cast<std::size_t>(n)]);
  }
  std::vector<std::int32_t> tag_of(model.mesh.parts.size(), 0);
  for (const std::int32_t p : draft.mesh.parts) {
    TaggedPart part;
    part.name = "part_" + std::to_string(1 + file.parts.size());
    part.tag = tag_of[static_cast<std::size_t>(p)] = static_cast<std::int32_t>(1 + file.parts.size());
    file.parts.push_back(std::move(part));
  }
  bool mixed = false;
  for (std::size_t i = 0; i < draft.mesh.tetrahedra.size(); i += all.step()) {
    const std::size_t t = draft.mesh.tetrahedra[i];
    file.tags.push_back(tag_of[static_cast<std::size_t>(all.part[t])]);
    if (all.of_hexahedra) {
      Hexahedron hexahedron = HexahedronOf(model.mesh, all, t);
      for (std::int32_t& n : hexahedron) n = draft.mesh.local.at(n);
      file.hexahedra.push_back(hexahedron);
      continue;
    }
    Tetrahedron tetrahedron = all.corners[t];
    for (std::int32_t& n : tetrahedron) n = draft.mesh.local.at(n);
    file.tetrahedra.push_back(tetrahedron);
    if (!draft.mesh.quadratic) continue;
    auto middles = all.middles[t];
    mixed = mixed || middles[0] < 0;
    for (std::int32_t& n : middles) n = n < 0 ? 0 : draft.mesh.local.at(n);
    file.middles.push_back(middles);
  }
  if (mixed) {
    source.Fail(FirstPart(model, draft), "the body " + draft.body.name() + " mixes elements of ten nodes with others",
                "mesh it with one element type");
    return;
  }
  for (const auto& middles : file.middles) {
    for (const std::int32_t n : middles) {
      if (!draft.mesh.is_corner[static_cast<std::size_t>(n)]) continue;
      const std::int64_t id = model.mesh.ids[static_cast<std::size_t>(draft.mesh.nodes[static_cast<std::size_t>(n)])];
      source.Fail(FirstPart(model, draft),
                  "node " + std::to_string(id) + " is a corner of one element and a mid-edge node of another",
                  "mesh the body again, with one element order");
      return;
    }
  }
}

std::string MeshText(const Model& model, const Tetrahedra& all, XmlSource& source, const BodyDraft& draft) {
  std::string text = GmshText(draft.file);
  if (source.failures() == 0) Check(model, all, text, source, draft);
  return text;
}

}  // namespace fascicle::client
