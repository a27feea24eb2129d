#ifndef FASCICLE_CLIENT_IMPORT_SECTIONS_H_
#define FASCICLE_CLIENT_IMPORT_SECTIONS_H_

#include <pugixml.hpp>

#include "client/import/model.h"
#include "client/import/xml_source.h"

namespace fascicle::client {

// The sections of a model, one file each. They may occur in any order in the file; these functions are called in the
// order of declaration. Each marks what it reads and continues after problems.

void ReadModule(pugi::xml_node section, XmlSource& source, Model& model);
void ReadControl(pugi::xml_node section, XmlSource& source, Model& model);
void ReadMesh(pugi::xml_node section, XmlSource& source, Model& model);
// Names and types of the materials.
void ReadMaterials(pugi::xml_node section, XmlSource& source, Model& model);
// Assigns materials to parts. `section` may be empty: parts may name their material.
void ReadMeshDomains(pugi::xml_node section, bool split_hexahedra, XmlSource& source, Model& model);
void ReadMeshData(pugi::xml_node section, XmlSource& source, Model& model);
void ReadLoadData(pugi::xml_node section, XmlSource& source, Model& model);
// The laws of materials that deformable parts use, and rigid bodies.
void ReadLaws(XmlSource& source, Model& model);
void ReadBoundary(pugi::xml_node section, XmlSource& source, Model& model);
// <Rigid>, or the rigid bodies of <Constraints>.
void ReadRigid(pugi::xml_node section, XmlSource& source, Model& model);
void ReadLoads(pugi::xml_node section, XmlSource& source, Model& model);
// Adds the supports of rigid bodies whose motion is given, and reports the others.
void HoldRigidNodes(XmlSource& source, Model& model);

// Parts of them.

// The axes of an element with <a> and <d>; also those of element data.
std::optional<Mat3> ReadFrame(pugi::xml_node node, XmlSource& source);
std::optional<Axes> ReadAxes(pugi::xml_node node, XmlSource& source);
std::optional<FibreSource> ReadFibre(pugi::xml_node node, XmlSource& source);

// One degree of freedom of a rigid body, counted from 0: along x, y, z, about x, y, z.
void HoldRigid(RigidBody& body, int motion, std::optional<Driven> driven, pugi::xml_node node, XmlSource& source);
// The rigid body of a material; null, with a problem at `node`, if there is none.
RigidBody* FindRigid(const std::string& material, pugi::xml_node node, XmlSource& source, Model& model);
// <rigid_body mat="..."> with <fixed> and <prescribed> of version 2.5.
void ReadRigidBody(pugi::xml_node node, XmlSource& source, Model& model);

// A material by its name or number.
std::optional<std::size_t> FindMaterial(const Model& model, const std::string& name);
// Whether a part consists of elements that can be deformable; reports others.
bool IsUsable(const Part& part, bool takes_hexahedra, XmlSource& source);

// The ids of the elements of a part or element set; null if it does not exist.
const std::vector<std::int64_t>* FindElements(const Mesh& mesh, const std::string& name);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_SECTIONS_H_
