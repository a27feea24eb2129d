#include <string>

#include "core/geometry/mesh_edges.h"
#include "server/translate/number_files.h"
#include "server/translate/parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

std::vector<Vec3> VectorsOf(const std::vector<double>& values, double unit) {
  std::vector<Vec3> vectors;
  for (std::size_t i = 0; i < values.size(); i += 3) {
    vectors.emplace_back(unit * Vec3(values[i], values[i + 1], values[i + 2]));
  }
  return vectors;
}

// Values of the nodes of a file of second order, in the order of the mesh's nodes and edges.
std::vector<Vec3> Reordered(const std::vector<Vec3>& values, const TranslatedTetrahedra& mesh, const MeshEdges& edges) {
  const std::size_t nodes = mesh.mesh.nodes.size();
  std::vector<Vec3> ordered(nodes + edges.ends.size(), Vec3::Zero());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto& [i, j] = mesh.node_places[k];
    ordered[i == j ? static_cast<std::size_t>(i) : nodes + static_cast<std::size_t>(edges.Between(i, j))] = values[k];
  }
  return ordered;
}

// The vectors of a file for each node of the mesh, followed by those of the mid-edge nodes if they have lines, too.
std::vector<Vec3> NodeVectors(const BodySource& source, const v1::FileRef& ref, const char* field, double unit,
                              const TranslatedTetrahedra* mesh, std::vector<std::string>& notes, Problems& problems) {
  const std::string path = JoinPath(source.path, field);
  NumberFile file = {"nodes", std::nullopt, 3};
  MeshEdges edges;
  if (mesh != nullptr) {
    file.lines = mesh->mesh.nodes.size();
    if (source.quadratic) edges = NumberEdges(mesh->mesh, source.tools.stop);
    if (!mesh->node_places.empty()) {
      file.item = "corners";
      file.or_lines = mesh->node_places.size();
      file.or_item = "nodes of the file";
    } else if (source.quadratic) {
      file.or_lines = *file.lines + edges.ends.size();
      file.or_item = "nodes with mid-edge nodes";
    }
  }
  const std::vector<Vec3> values = VectorsOf(ReadNumberFile(ref, file, path, source.assets, problems), unit);
  if (mesh == nullptr || values.empty()) return {};
  if (values.size() == *file.lines) {
    if (source.quadratic) notes.push_back(path + ": has values of corners only; mid-edge nodes have those in between");
    return values;
  }
  if (!source.quadratic) {
    notes.push_back(path + ": values of mid-edge nodes have no effect on linear elements");
    std::vector<Vec3> corners(*file.lines);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (const auto& [i, j] = mesh->node_places[k]; i == j) corners[static_cast<std::size_t>(i)] = values[k];
    }
    return corners;
  }
  return mesh->node_places.empty() ? values : Reordered(values, *mesh, edges);
}

}  // namespace

void TranslateInitialState(const BodySource& source, const TranslatedTetrahedra* mesh, TetShape& shape,
                           std::vector<std::string>& notes, Problems& problems) {
  if (source.wire.has_initial_displacement()) {
    shape.initial_displacement = NodeVectors(source, source.wire.initial_displacement(), "initial_displacement",
                                             MetresIn(source.wire.unit()), mesh, notes, problems);
  }
  if (source.wire.has_initial_velocity()) {
    shape.initial_velocity =
        NodeVectors(source, source.wire.initial_velocity(), "initial_velocity", 1, mesh, notes, problems);
  }
}

}  // namespace fascicle::server
