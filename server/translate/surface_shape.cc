#include <utility>

#include "core/geometry/unused_nodes.h"
#include "server/translate/fibres.h"
#include "server/translate/meshes.h"
#include "server/translate/shapes.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

// The boundary of tetrahedra, with its nodes.
TriangleMesh BoundaryOf(const TetMesh& mesh, const std::stop_token& stop) {
  TriangleMesh surface = {mesh.nodes, BoundaryTriangles(mesh, stop)};
  DropUnusedNodes(surface.nodes, surface.triangles);
  return surface;
}

// A surface from a file has no tetrahedra for individual fibres: one direction holds for the whole body.
FibreField FibresWithoutFilling(const BodySource& source, Problems& problems) {
  const v1::Fibres& wire = source.wire.fibres();
  const std::string path = JoinPath(source.path, "fibres");
  if (wire.has_pennation()) {
    problems.Add(JoinPath(path, "pennation"), "a surface without tetrahedra allows constant fibres without pennation",
                 "rotate the constant direction");
  }
  if (wire.has_constant()) {
    return {ToDirection(wire.constant().direction(), JoinPath(path, "constant.direction"), problems).normalized()};
  }
  problems.Add(path, "a surface without tetrahedra allows constant fibres only",
               "fill it by `fascicle mesh` and use the mesh as a file");
  return {Vec3::UnitX()};
}

// A surface from a file.
bool TranslateFile(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& structure,
                   Problems& others) {
  SurfaceShape& shape = body.surface();
  auto surface = TranslateSurfaceFile(source, body.notes, structure);
  if (surface) {
    shape.mesh = std::move(*surface);
    body.regions = SelectRegions(selectors, shape.mesh, source.tools.stop);
    CheckRegions(source.wire, source.path, selectors, body.regions, shape.mesh, structure);
  }
  if (source.wire.has_fibres()) {
    shape.fibres = FibresWithoutFilling(source, others);
  } else {
    CheckFibresAreGiven(source, others);
  }
  return surface.has_value();
}

// The boundary of tetrahedra. These determine whether a region is empty; supports and loads act on the surface.
bool TranslateBoundary(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& structure,
                       Problems& others) {
  SurfaceShape& shape = body.surface();
  auto tetrahedra = TranslateTetrahedra(source, Method::kEulerian, body.notes, structure);
  std::vector<Region> of_filling = EmptyRegions(selectors);
  if (tetrahedra) {
    of_filling = SelectRegions(selectors, tetrahedra->mesh, source.tools.stop);
    CheckRegions(source.wire, source.path, selectors, of_filling, tetrahedra->mesh, structure);
  }
  shape.fibres =
      TranslateFibres(source, tetrahedra ? &*tetrahedra : nullptr, {selectors.names, of_filling}, body.notes, others);
  if (!tetrahedra) return false;
  if (!tetrahedra->mesh.curved_edges.empty()) {
    body.notes.push_back(JoinPath(source.path, "mesh") + ": the surface ignores that edges of the mesh are curved");
  }
  shape.mesh = BoundaryOf(tetrahedra->mesh, source.tools.stop);
  shape.filling = std::move(tetrahedra->mesh);
  body.regions = SelectRegions(selectors, shape.mesh, source.tools.stop);
  return true;
}

}  // namespace

bool TranslateSurfaceShape(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& structure,
                           Problems& others) {
  RefuseFields(source,
               {"region_materials", "element_parameters", "region_activations", "activation_scale",
                "initial_displacement", "initial_velocity"},
               "a body of the eulerian method has no elements", "omit it, or use the tet method", others);
  body.regions = EmptyRegions(selectors);
  body.shape = SurfaceShape();
  const v1::Body& wire = source.wire;
  if (wire.fibres().has_prestretch_file() || (wire.fibres().has_prestretch() && wire.fibres().prestretch() != 1)) {
    others.Add(JoinPath(source.path, "fibres.prestretch"), "fibres of the eulerian method have no prestretch",
               "omit it, or use the tet method");
  }
  if (wire.has_plasticity() && ObeysRules(wire.plasticity())) {
    body.surface().plasticity = Plasticity{wire.plasticity().yield_stress(), wire.plasticity().relaxation_time()};
  }
  return wire.mesh().has_surface() ? TranslateFile(source, selectors, body, structure, others)
                                   : TranslateBoundary(source, selectors, body, structure, others);
}

}  // namespace fascicle::server
