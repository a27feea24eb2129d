#include "core/eulerian/scene_body.h"

#include <Eigen/Geometry>

#include <string>

#include "core/eulerian/contact.h"
#include "core/geometry/triangle_tree.h"
#include "core/scene/nodal_forces.h"

namespace fascicle {
namespace {

// Least number of cells between a body at rest and the boundary of its grid.
constexpr double kLeastRoom = 3;

Bounds RoomOf(const EulerianMethod& method, const TriangleMesh& surface) {
  if (method.room) return *method.room;
  const Bounds body = BoundsOf(surface.nodes);
  const double margin = std::max(method.margin * body.extent().maxCoeff(), (kLeastRoom + 1) * method.cell_size);
  return {body.lowest - Vec3::Constant(margin), body.highest + Vec3::Constant(margin)};
}

// Number of cells along each axis as real numbers, since there may be too many for a grid.
Vec3 CellsOf(const Bounds& room, double cell_size) {
  const Vec3 first = (room.lowest / cell_size).array().floor(), last = (room.highest / cell_size).array().ceil();
  return last - first;
}

Material BesidePressure(const Material& material) {
  return std::visit(
      [](const auto& law) -> Material {
        const double most = 2 * law.ShearModulus();
        if (law.VolumeModulus() <= most) return law;
        return law.WithVolumeModulus(most);
      },
      material);
}

// The material points that a support prescribes: its region, and half a cell around it.
RegionPoints SupportPoints(const Body& body, const Constraint& constraint, double cell_size) {
  return {body.regions[constraint.region], body.nodes(), 0.5 * cell_size};
}

// The force of a load on every vertex of the surface at scale 1 [N].
std::vector<Vec3> ForcesOf(const Body& source, const Load& load) {
  std::vector<Vec3> of_vertices(source.nodes().size(), Vec3::Zero());
  const LoadedRegion region = LoadedRegionOf(source.regions[load.region], source.nodes());
  for (const auto& [vertex, force] : NodalForcesOf(load, region)) of_vertices[vertex] += force;
  return of_vertices;
}

// Whether a support prescribes any grid node of the body at rest, or of a cell at its surface.
bool PrescribesNode(const EulerianGrid& grid, const RegionPoints& points, const TriangleTree& tree) {
  for (std::size_t n = 0; n < grid.node_count(); ++n) {
    const Vec3 x = grid.NodePosition(grid.NodeAt(n));
    if (points.Contain(x) && tree.SignedDistance(x) < grid.spacing) return true;
  }
  return false;
}

// Regions are volumes of the body here: a support needs no vertex of the surface.
void CheckSupports(const EulerianGrid& grid, const Body& body, const std::string& path, Problems& problems) {
  if (body.constraints.empty()) return;
  const TriangleTree tree(body.surface().mesh);
  for (std::size_t k = 0; k < body.constraints.size(); ++k) {
    const std::int32_t region = body.constraints[k].region;
    if (region < 0 || region >= static_cast<std::int32_t>(body.regions.size())) continue;
    if (PrescribesNode(grid, SupportPoints(body, body.constraints[k], grid.spacing), tree)) continue;
    problems.Add(JoinPath(path, IndexPath("constraints", k) + ".region"),
                 "region `" + body.regions[region].name + "` contains no node of the body's grid",
                 "supports act within half a cell of their regions: use a larger region, or smaller cells");
  }
}

void CheckRoom(const EulerianMethod& method, const TriangleMesh& surface, const std::string& path, Problems& problems) {
  if (!method.room) return;
  const Bounds body = BoundsOf(surface.nodes);
  const Vec3 side = Vec3::Constant(kLeastRoom * method.cell_size);
  if (((body.lowest - side - method.room->lowest).array() >= 0).all() &&
      ((method.room->highest - side - body.highest).array() >= 0).all()) {
    return;
  }
  problems.Add(
      path, "the body at rest is not within eulerian.lowest and eulerian.highest, or less than three cells from them",
      "use a larger grid, or omit both");
}

}  // namespace

EulerianGrid GridOf(const EulerianMethod& method, const TriangleMesh& surface) {
  const Bounds room = RoomOf(method, surface);
  EulerianGrid grid;
  grid.spacing = method.cell_size;
  grid.origin = method.cell_size * (room.lowest / method.cell_size).array().floor().matrix();
  const Vec3 cells = CellsOf(room, method.cell_size);
  for (int axis = 0; axis < 3; ++axis) grid.cells[axis] = static_cast<std::int32_t>(cells[axis]);
  return grid;
}

EulerianBody MakeEulerianBody(const Scene& scene, const Body& source, ThreadTeam& team) {
  const EulerianMethod& method = scene.eulerian;
  const SurfaceShape& shape = source.surface();
  const bool preserved = method.volume == VolumeTreatment::kPreserved;
  EulerianBody body{GridOf(method, shape.mesh), SolidShape(shape.mesh, method.cell_size / 2, team),
                    preserved ? BesidePressure(source.material) : source.material};
  body.density = source.density;
  body.mass_damping = source.damping.mass_proportional;
  body.gravity = scene.gravity.acceleration;
  body.volume = method.volume;
  body.stabilization = method.stabilization;
  body.plasticity = shape.plasticity;
  body.implicit_elasticity = method.implicit_elasticity;
  body.maccormack = method.maccormack;
  body.travels = method.rigid_grids;
  body.time_step = method.time_step;
  for (const Constraint& constraint : source.constraints) {
    body.supports.push_back(SupportPoints(source, constraint, method.cell_size));
  }
  for (const Load& load : source.loads) body.loads.push_back(ForcesOf(source, load));
  body.force_fields = scene.squeezes;
  if (!shape.fibres.empty()) {
    body.fibres.emplace(shape.filling, shape.fibres, body.shape.MaterialGrid(body.grid.spacing / 2), team);
  }
  return body;
}

void CheckEulerianBodies(const Scene& scene, std::span<const std::string> sources, std::int64_t max_cells,
                         Problems& problems) {
  const EulerianMethod& method = scene.eulerian;
  double cells = 0;
  bool sound = true;  // all surfaces
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const TriangleMesh& surface = scene.bodies[i].surface().mesh;
    if (surface.nodes.empty()) continue;
    Problems own;
    CheckSolidSurface(surface, method.cell_size, own);
    sound &= own.empty();
    problems.Append(sources[i], own);
    CheckRoom(method, surface, sources[i], problems);
    cells += CellsOf(RoomOf(method, surface), method.cell_size).prod();
  }
  if (cells > static_cast<double>(max_cells)) {
    char text[64];
    std::snprintf(text, sizeof(text), "%.4g cells are too many; at most %.4g", cells, static_cast<double>(max_cells));
    problems.Add("eulerian.cell_size", text, "use larger cells, or a smaller margin");
    return;
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.nodes().empty()) continue;
    CheckSupports(GridOf(method, body.surface().mesh), body, IndexPath("bodies", i), problems);
  }
  if (sound) CheckOverlaps(scene, problems);
}

}  // namespace fascicle
