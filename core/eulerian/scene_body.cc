#include "core/eulerian/scene_body.h"

#include <Eigen/Geometry>

#include <memory>
#include <string>

#include "core/eulerian/fibre_samples.h"
#include "core/geometry/triangle_tree.h"
#include "core/scene/nodal_forces.h"
#include "core/scene/rigid_motion.h"

namespace fascicle {
namespace {

// Cells between a body at rest and the side of its grid.
constexpr double kLeastRoom = 3;

Bounds RoomOf(const EulerianMethod& method, const TriangleMesh& surface) {
  if (method.room) return *method.room;
  const Bounds body = BoundsOf(surface.nodes);
  const double margin = std::max(method.margin * body.extent().maxCoeff(), (kLeastRoom + 1) * method.cell_size);
  return {body.lowest - Vec3::Constant(margin), body.highest + Vec3::Constant(margin)};
}

// Numbers of cells as they are, whole or not: they may be too many for a grid.
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

// What a support holds: its region, and half a cell around it.
RegionPoints SupportPoints(const Body& body, const Constraint& constraint, double cell_size) {
  return {body.regions[constraint.region], body.nodes(), 0.5 * cell_size};
}

void SetSupports(const Body& source, double cell_size, EulerianBody& body) {
  if (source.constraints.empty()) return;
  std::vector<RegionPoints> points;
  for (const Constraint& constraint : source.constraints) {
    points.push_back(SupportPoints(source, constraint, cell_size));
  }
  body.supports = static_cast<int>(points.size());
  body.support_of = [points](const Vec3& X) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (points[k].Contain(X)) return static_cast<int>(k);
    }
    return -1;
  };
  body.support_velocity = [&source](int support, const Vec3& X, double time, double dt) {
    const Motion& motion = source.constraints[support].motion;
    return Vec3((MotionAt(motion, time + dt).PositionOf(X) - MotionAt(motion, time).PositionOf(X)) / dt);
  };
}

void SetLoads(const Body& source, EulerianBody& body) {
  if (source.loads.empty()) return;
  std::vector<std::vector<Vec3>> of_loads;
  for (const Load& load : source.loads) {
    std::vector<Vec3>& of_vertices = of_loads.emplace_back(source.nodes().size(), Vec3::Zero());
    const LoadedRegion region = LoadedRegionOf(source.regions[load.region], source.nodes());
    for (const auto& [vertex, force] : NodalForcesOf(load, region)) of_vertices[vertex] += force;
  }
  body.vertex_forces = [of_loads, &source](double time, std::vector<Vec3>& forces) {
    for (std::size_t k = 0; k < of_loads.size(); ++k) {
      const double scale = source.loads[k].scale.At(time);
      for (std::size_t v = 0; v < forces.size(); ++v) forces[v] += scale * of_loads[k][v];
    }
  };
}

void SetSqueezes(const Scene& scene, EulerianBody& body) {
  if (scene.squeezes.empty()) return;
  body.force = [&scene](const Vec3& x, double time) {
    Vec3 sum = Vec3::Zero();
    for (const PlaneForceField& field : scene.squeezes) {
      const double away = (x - field.point).dot(field.normal);
      const double part = field.width > 0 ? std::clamp(away / field.width, -1.0, 1.0) : away < 0 ? -1 : 1;
      sum -= field.scale.At(time) * field.force_density * part * field.normal;
    }
    return sum;
  };
}

void SetFibres(const Body& source, EulerianBody& body) {
  const SurfaceShape& shape = source.surface();
  if (shape.fibres.empty()) return;
  const auto samples =
      std::make_shared<const FibreSamples>(shape.filling, shape.fibres, body.shape.MaterialGrid(body.grid.spacing / 2));
  body.fibre = [samples, &source](const Vec3& X, double time) {
    return FibreState{samples->At(X), source.activation.At(time)};
  };
}

// Whether a support holds a node of the grid in the body at rest, or of a cell at its surface.
bool HoldsNode(const EulerianGrid& grid, const RegionPoints& points, const TriangleTree& tree) {
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
    if (HoldsNode(grid, SupportPoints(body, body.constraints[k], grid.spacing), tree)) continue;
    problems.Add(JoinPath(path, IndexPath("constraints", k) + ".region"),
                 "region `" + body.regions[region].name + "` holds no node of the body's grid",
                 "supports hold what is within half a cell of their regions: make it larger, or take smaller cells");
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
      "make the room larger, or leave both out");
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
  body.gravity_scale = scene.gravity.scale;
  body.volume = method.volume;
  body.stabilization = method.stabilization;
  body.plasticity = shape.plasticity;
  body.implicit_elasticity = method.implicit_elasticity;
  body.maccormack = method.maccormack;
  body.time_step = method.time_step;
  SetSupports(source, method.cell_size, body);
  SetLoads(source, body);
  SetSqueezes(scene, body);
  SetFibres(source, body);
  return body;
}

void CheckEulerianBodies(const Scene& scene, std::span<const std::string> sources, std::int64_t max_cells,
                         Problems& problems) {
  const EulerianMethod& method = scene.eulerian;
  double cells = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const TriangleMesh& surface = scene.bodies[i].surface().mesh;
    if (surface.nodes.empty()) continue;
    Problems own;
    CheckSolidSurface(surface, method.cell_size, own);
    problems.Append(sources[i], own);
    CheckRoom(method, surface, sources[i], problems);
    cells += CellsOf(RoomOf(method, surface), method.cell_size).prod();
  }
  if (cells > static_cast<double>(max_cells)) {
    char text[64];
    std::snprintf(text, sizeof(text), "%.4g cells are too many; at most %.4g", cells, static_cast<double>(max_cells));
    problems.Add("eulerian.cell_size", text, "take larger cells, or a smaller margin");
    return;
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.nodes().empty()) continue;
    CheckSupports(GridOf(method, body.surface().mesh), body, IndexPath("bodies", i), problems);
  }
}

}  // namespace fascicle
