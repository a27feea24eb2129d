#include "server/translate/refine_body.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/mesh_edges.h"
#include "core/geometry/refinement.h"

namespace fascicle::server {
namespace {

// One value for each part of every element; nothing if there is none.
template <class Value>
void RepeatForParts(std::vector<Value>& values) {
  std::vector<Value> repeated;
  repeated.reserve(kChildren * values.size());
  for (const Value& value : values) repeated.insert(repeated.end(), kChildren, value);
  values = std::move(repeated);
}

// Adds values of the new nodes, which are in the middle of those of `between`: the value of a mid-edge node that has
// one, else a mean. Mid-edge nodes of the refined mesh have none of their own.
template <class Between>
void RefineValues(const Between& between, const TetMesh& coarse, std::vector<Vec3>& values) {
  const std::size_t nodes = coarse.nodes.size();
  const std::vector<Vec3> given = values;
  const MeshEdges edges = given.size() > nodes ? NumberEdges(coarse) : MeshEdges();
  values.resize(nodes);
  for (const auto& ends : between) {
    if (given.size() > nodes) {
      values.push_back(given[nodes + static_cast<std::size_t>(edges.Between(ends[0], ends[1]))]);
      continue;
    }
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t n : ends) sum += values[static_cast<std::size_t>(n)];
    values.emplace_back(sum / static_cast<double>(ends.size()));
  }
}

// Takes the refined mesh; new nodes are in the middle of those of `between`.
template <class Between>
void TakeRefined(TetMesh mesh, const Between& between, TetShape& shape) {
  for (std::vector<Vec3>* values : {&shape.initial_displacement, &shape.initial_velocity}) {
    if (!values->empty()) RefineValues(between, shape.mesh, *values);
  }
  shape.mesh = std::move(mesh);
}

void RefineShape(TetShape& shape, const std::stop_token& stop) {
  RepeatForParts(shape.fibres);
  RepeatForParts(shape.prestretch);
  RepeatForParts(shape.materials.of);
  RepeatForParts(shape.activations.of);
  RepeatForParts(shape.activation_scale);
  if (shape.mesh.hexahedra.empty()) {
    RefinedTetrahedra fine = Refined(shape.mesh, stop);
    TakeRefined(std::move(fine.mesh), fine.ends, shape);
  } else {
    RefinedHexahedra fine = RefinedIntoHexahedra(shape.mesh, stop);
    TakeRefined(std::move(fine.mesh), fine.between, shape);
  }
}

void RefineShape(VoxelShape& shape, const std::stop_token& stop) {
  const VoxelGrid coarse = std::move(shape.mesh.grid);
  std::vector<std::int32_t> brick_of(coarse.voxels(), -1);
  std::int32_t bricks = 0;
  for (std::size_t v = 0; v < brick_of.size(); ++v) {
    if (coarse.material[v] != 0) brick_of[v] = bricks++;
  }
  shape.mesh = MakeBrickMesh(Refined(coarse, stop), stop);
  if (shape.materials.of.empty()) return;
  const std::vector<std::int32_t> parts = std::move(shape.materials.of);
  shape.materials.of.clear();
  ForVoxels(
      shape.mesh.grid,
      [&](std::size_t v, const GridIndex& at) {
        if (shape.mesh.grid.material[v] == 0) return;
        shape.materials.of.push_back(parts[brick_of[coarse.IndexOf({at[0] / 2, at[1] / 2, at[2] / 2})]]);
      },
      stop);
}

std::int64_t ElementsOf(const TetShape& shape) { return static_cast<std::int64_t>(ElementCount(shape.mesh)); }
std::int64_t ElementsOf(const VoxelShape& shape) { return static_cast<std::int64_t>(shape.mesh.bricks.size()); }

// Wedges and pyramids have no parts of their own kinds that match their neighbours'.
bool HasParts(const TetShape& shape) {
  return std::all_of(shape.mesh.hexahedra.begin(), shape.mesh.hexahedra.end(), [](const Hexahedron& hexahedron) {
    return std::set<std::int32_t>(hexahedron.begin(), hexahedron.end()).size() == hexahedron.size();
  });
}
bool HasParts(const VoxelShape&) { return true; }

// Whether the budget allows the parts, which it then pays.
bool PayForParts(const BodySource& source, std::int64_t elements, Problems& problems) {
  std::int64_t parts = elements;
  for (int k = 0; k < source.refinements; ++k) parts *= static_cast<std::int64_t>(kChildren);
  if (parts - elements > source.budget) {
    problems.Add("refinements",
                 std::to_string(parts) + " elements of " + source.path + " are too many; " +
                     std::to_string(source.budget + elements) + " are left for it",
                 "refine less often, or use a coarser mesh");
    return false;
  }
  source.budget -= parts - elements;
  return true;
}

template <class Shape>
void Refine(const BodySource& source, const RegionSelectors& selectors, Shape& shape, Body& body, Problems& problems) {
  if (!HasParts(shape)) {
    problems.Add("refinements", source.path + " has wedges or pyramids, which are not refined", "mesh the body finer");
    return;
  }
  if (!PayForParts(source, ElementsOf(shape), problems)) return;
  for (int k = 0; k < source.refinements; ++k) RefineShape(shape, source.tools.stop);
  body.regions = SelectRegions(selectors, shape.mesh, source.tools.stop);
  body.notes.push_back(source.path + ": refined to " + std::to_string(ElementsOf(shape)) + " elements");
}

}  // namespace

void RefineBody(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& problems) {
  if (source.refinements == 0) return;
  if (auto* tet = std::get_if<TetShape>(&body.shape)) Refine(source, selectors, *tet, body, problems);
  if (auto* voxel = std::get_if<VoxelShape>(&body.shape)) Refine(source, selectors, *voxel, body, problems);
}

}  // namespace fascicle::server
