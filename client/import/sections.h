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
void ReadMesh(pugi::xml_node section, bool split_hexahedra, XmlSource& source, Model& model);
void ReadMaterials(pugi::xml_node section, XmlSource& source, Model& model);
void ReadMeshDomains(pugi::xml_node section, XmlSource& source, Model& model);
void ReadMeshData(pugi::xml_node section, XmlSource& source, Model& model);
void ReadLoadData(pugi::xml_node section, XmlSource& source, Model& model);
void ReadBoundary(pugi::xml_node section, XmlSource& source, Model& model);
void ReadLoads(pugi::xml_node section, XmlSource& source, Model& model);

// Parts of them.

// The axes of an element with <a> and <d>; also those of element data.
std::optional<Mat3> ReadFrame(pugi::xml_node node, XmlSource& source);
std::optional<Axes> ReadAxes(pugi::xml_node node, XmlSource& source);
std::optional<FibreSource> ReadFibre(pugi::xml_node node, XmlSource& source);

// The ids of the elements of a part or element set; null if it does not exist.
const std::vector<std::int64_t>* FindElements(const Mesh& mesh, const std::string& name);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_SECTIONS_H_
