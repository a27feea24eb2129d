#ifndef FASCICLE_CLIENT_IMPORT_BODY_DRAFT_H_
#define FASCICLE_CLIENT_IMPORT_BODY_DRAFT_H_

#include <map>
#include <set>
#include <string>
#include <vector>

#include "client/import/bodies.h"
#include "client/import/curves.h"
#include "client/import/mesh_writer.h"
#include "client/import/model.h"

namespace fascicle::client {

// The valid name of a scene nearest to `wanted` that is not among `taken`; adds it to `taken`.
std::string NewName(const std::string& wanted, std::set<std::string>& taken);

// A body of the scene under construction: the message, the mesh file, and their origin in the model.
class BodyDraft {
 public:
  BodyDraft(const MeshBody& of, std::string at, v1::Body& made) : mesh(of), path(std::move(at)), body(made) {}

  // The region of these nodes or triangles (in node indices of the model) or of a part; created on first use. `key`
  // identifies a set of the model; `wanted` becomes the name.
  const std::string& NodeRegion(const std::string& key, const std::string& wanted,
                                const std::vector<std::int32_t>& nodes);
  const std::string& SurfaceRegion(const std::string& key, const std::string& wanted,
                                   const std::vector<Triangle>& triangles);
  const std::string& PartRegion(std::int32_t part, const std::string& wanted);

  const MeshBody& mesh;
  std::string path;  // "bodies[0]"
  v1::Body& body;
  MeshToWrite file;

 private:
  const std::string& NewRegion(const std::string& key, const std::string& wanted, TaggedPart& part);

  std::map<std::string, std::string> region_of_;
  std::set<std::string> names_;
};

// The origin of fields of the scene, by path.
using Origins = std::map<std::string, pugi::xml_node>;

// The steps of building a scene, one file each. All of them continue after problems.

// Nodes and tetrahedra of a body, in the scene's unit.
void DraftMesh(const Model& model, const Tetrahedra& tetrahedra, XmlSource& source, BodyDraft& draft);
// The mesh file, once the draft has all of its regions. If there are no other problems, reads and checks the file as a
// server would.
std::string MeshText(const Model& model, const Tetrahedra& tetrahedra, XmlSource& source, const BodyDraft& draft);
// Makes activations at most 1: what they exceed 1 by goes to the stress of the law.
void ScaleActivations(Model& model, CurveMaker& curves);
// Laws, density and activation.
void SetMaterials(const Model& model, XmlSource& source, CurveMaker& curves, Origins& origins, BodyDraft& draft);
// Fibres: constant, or a file of this name.
void SetFibres(const Model& model, const Tetrahedra& tetrahedra, XmlSource& source, BodyDraft& draft,
               std::vector<ImportedFile>& files);
// Constraints and loads of all bodies.
void SetSupports(const Model& model, XmlSource& source, CurveMaker& curves, Origins& origins,
                 std::vector<BodyDraft>& drafts);
void SetLoads(const Model& model, const Tetrahedra& tetrahedra, XmlSource& source, CurveMaker& curves, Origins& origins,
              std::vector<BodyDraft>& drafts);

// The nodes of a set of the model: a node set, "@surface:NAME" or "@elem_set:NAME". Null, with a problem at `node`, if
// it does not exist.
class NodeSets {
 public:
  NodeSets(const Mesh& mesh, XmlSource& source) : mesh_(mesh), source_(source) {}
  const std::vector<std::int32_t>* Find(const std::string& set, pugi::xml_node node);

 private:
  std::optional<std::vector<std::int32_t>> Collect(const std::string& kind, const std::string& name) const;
  const Mesh& mesh_;
  XmlSource& source_;
  std::map<std::string, std::vector<std::int32_t>> found_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_BODY_DRAFT_H_
