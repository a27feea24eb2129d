#include "client/cli/mesh_picture.h"

#include "client/render/picture.h"

namespace fascicle::client {
namespace {

template <class T>
std::string Bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

void DrawMesh(const TetMesh& mesh, const std::vector<Region>& regions, double unit, const std::string& title,
              const std::filesystem::path& path) {
  std::vector<Vec3> positions = mesh.nodes;
  for (Vec3& position : positions) position *= unit;
  v1::Geometry geometry;
  v1::BodyGeometry& body = *geometry.add_bodies();
  body.set_name(title);
  body.set_positions(Bytes(positions));
  body.set_tetrahedra(Bytes(mesh.tetrahedra));
  v1::Frame frame;
  v1::BodyFrame& state = *frame.add_bodies();
  state.set_positions(body.positions());
  PictureOptions options;
  options.title = title + ", " + std::to_string(mesh.tetrahedra.size()) + " tetrahedra";
  options.colour.clear();
  options.wireframe = true;
  options.rest_outline = false;
  options.time = false;
  if (!regions.empty()) {
    std::vector<double> number(mesh.nodes.size());
    for (std::size_t i = 0; i < regions.size(); ++i) {
      for (const std::int32_t n : regions[i].nodes) number[n] = static_cast<double>(i + 1);
    }
    v1::FieldValues& field = *state.add_fields();
    field.set_name("physical_tag");
    field.set_location(v1::FieldValues::LOCATION_NODE);
    field.set_components(1);
    field.set_unit("1");
    field.set_values(Bytes(number));
    options.colour = "physical_tag";
    options.categories = {"elsewhere"};
    for (const Region& region : regions) options.categories.push_back(region.name);
  }
  DrawPicture(geometry, frame, options, path);
}

}  // namespace fascicle::client
