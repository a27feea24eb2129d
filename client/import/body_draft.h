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

// A name of a scene that is as near to `wanted` as its rules allow, and not among `taken`, to which it is added.
std::string NewName(const std::string& wanted, std::set<std::string>& taken);

// A body of the scene while it is made: the message, the mesh file, and where both came from.
class BodyDraft {
 public:
  BodyDraft(const MeshBody& of, std::string at, v1::Body& made) : mesh(of), path(std::move(at)), body(made) {}

  // The region of these nodes or triangles (in node indices of the model) or of a part; made when it is asked for
  // first. `key` tells sets of the model apart, `wanted` becomes its name.
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

// Where fields of the scene came from, by their path.
using Origins = std::map<std::string, pugi::xml_node>;

// The steps of making a scene, one file for each. All go on past problems.

// Nodes and tetrahedra of a body, in the scene's unit.
void DraftMesh(const Model& model, const Tetrahedra& tetrahedra, XmlSource& source, BodyDraft& draft);
// The mesh file, once the draft has all of its regions; where nothing else is wrong, reads and checks it as a server
// would.
std::string MeshText(const Model& model, const Tetrahedra& tetrahedra, XmlSource& source, const BodyDraft& draft);
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

// The nodes that a set of the model names: a node set, "@surface:NAME" or "@elem_set:NAME"; null, with a problem at
// `node`, when there is none.
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
