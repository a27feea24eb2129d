#include "core/voxel/check_problem.h"

#include <cmath>
#include <limits>
#include <map>

#include "core/voxel/free_motions.h"

namespace fascicle {
namespace {

std::string Text(const GridIndex& at) {
  return "(" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " + std::to_string(at[2]) + ")";
}

// Counts faults and keeps the first, for messages like "3 of 12 nodes".
struct Count {
  std::int64_t bad = 0;
  GridIndex first = {};
  void Add(const GridIndex& at) {
    if (bad++ == 0) first = at;
  }
};

// Whether the remaining checks are meaningful.
bool CheckGrid(const VoxelGrid& grid, Problems& problems) {
  double voxels = 1;
  for (int d = 0; d < 3; ++d) voxels *= grid.size[d] > 0 ? grid.size[d] : 0;
  if (voxels == 0) {
    problems.Add("grid.size", "the grid has no voxels");
    return false;
  }
  if (voxels > std::numeric_limits<std::int32_t>::max()) {
    problems.Add("grid.size", "the grid has " + std::to_string(voxels) + " voxels, more than 2^31 - 1",
                 "crop it to what is solid, or make it coarser");
    return false;
  }
  bool usable = true;
  if (!grid.spacing.allFinite() || grid.spacing.minCoeff() <= 0) {
    problems.Add("grid.spacing", "the size of a voxel must be positive along all three axes", "in metres");
    usable = false;
  }
  if (grid.material.size() != grid.voxels() || (!grid.stiffness.empty() && grid.stiffness.size() != grid.voxels())) {
    problems.Add("grid", "the numbers of materials and stiffness factors differ from the number of voxels");
    return false;
  }
  Count bad_stiffness;
  std::int64_t solid = 0;
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
    if (grid.material[v] == 0) return;
    ++solid;
    if (!grid.stiffness.empty() && !(grid.stiffness[v] > 0 && std::isfinite(grid.stiffness[v]))) bad_stiffness.Add(at);
  });
  if (solid == 0) {
    problems.Add("grid", "no voxel is solid: there is nothing to deform",
                 "look at the segmentation, or lower the fraction");
    usable = false;
  }
  if (bad_stiffness.bad > 0) {
    problems.Add("grid.stiffness",
                 std::to_string(bad_stiffness.bad) +
                     " solid voxels have a stiffness that is not positive, the first is " + Text(bad_stiffness.first),
                 "make them empty instead");
    usable = false;
  }
  return usable;
}

void CheckMaterials(const VoxelGrid& grid, const std::vector<VoxelMaterial>& materials, Problems& problems) {
  for (std::size_t m = 0; m < materials.size(); ++m) {
    const VoxelMaterial& material = materials[m];
    const std::string path = IndexPath("materials", m);
    if (!(material.young_modulus > 0 && material.young_modulus <= 1e12)) {
      problems.Add(JoinPath(path, "young_modulus"), "must be above 0 and at most 1e12 Pa");
    }
    if (!(material.poisson_ratio > -1 && material.poisson_ratio < 0.5)) {
      problems.Add(JoinPath(path, "poisson_ratio"), "must be above -1 and below 0.5",
                   "at 0.5 the bulk modulus is infinite; 0.4995 with mean dilatation is K/mu = 1000");
    }
  }
  Count unknown;
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
    if (grid.material[v] > materials.size()) unknown.Add(at);
  });
  if (unknown.bad > 0) {
    problems.Add("materials", std::to_string(unknown.bad) +
                                  " voxels have a material that is not listed, the first is " + Text(unknown.first) +
                                  " with material " + std::to_string(grid.MaterialAt(unknown.first)));
  }
}

// Adds a problem if some of the nodes don't exist, or if none are given. Returns whether all is well.
bool CheckNodes(const VoxelMesh& mesh, const std::vector<GridIndex>& nodes, const std::string& path,
                Problems& problems) {
  if (nodes.empty()) {
    problems.Add(path, "no nodes are given");
    return false;
  }
  Count outside;
  for (const GridIndex& at : nodes) {
    if (mesh.NodeAt(at) < 0) outside.Add(at);
  }
  if (outside.bad == 0) return true;
  problems.Add(path,
               std::to_string(outside.bad) + " of " + std::to_string(nodes.size()) +
                   " nodes are not corners of a solid voxel, the first is " + Text(outside.first),
               "choose nodes of the body");
  return false;
}

// The components that valid supports prescribe.
FixedComponents CheckSupports(const VoxelMesh& mesh, const std::vector<VoxelSupport>& supports, Problems& problems) {
  FixedComponents fixed(mesh.nodes(), 0);
  std::map<std::pair<std::int32_t, int>, double> values;
  for (std::size_t s = 0; s < supports.size(); ++s) {
    const VoxelSupport& support = supports[s];
    const std::string path = IndexPath("supports", s);
    CheckNodes(mesh, support.nodes, JoinPath(path, "nodes"), problems);
    if (!support.components[0] && !support.components[1] && !support.components[2]) {
      problems.Add(JoinPath(path, "components"), "no component is prescribed",
                   "leave the support out, or give the prescribed components");
    }
    if (!support.displacement.allFinite()) {
      problems.Add(JoinPath(path, "displacement"), "must be finite");
      continue;
    }
    Count contradicting;
    for (const GridIndex& at : support.nodes) {
      const std::int32_t node = mesh.NodeAt(at);
      if (node < 0) continue;
      for (int d = 0; d < 3; ++d) {
        if (!support.components[d]) continue;
        fixed[node] |= static_cast<std::uint8_t>(1 << d);
        const auto [known, is_new] = values.insert({{node, d}, support.displacement[d]});
        if (!is_new && known->second != support.displacement[d]) contradicting.Add(at);
      }
    }
    if (contradicting.bad > 0) {
      problems.Add(JoinPath(path, "displacement"),
                   std::to_string(contradicting.bad) +
                       " components have a different value in an earlier support, the first at node " +
                       Text(contradicting.first));
    }
  }
  return fixed;
}

void CheckLoads(const VoxelGrid& grid, const VoxelMesh& mesh, const VoxelLoads& loads, Problems& problems) {
  for (std::size_t k = 0; k < loads.nodal_forces.size(); ++k) {
    const std::string path = IndexPath("loads.nodal_forces", k);
    CheckNodes(mesh, loads.nodal_forces[k].nodes, JoinPath(path, "nodes"), problems);
    if (!loads.nodal_forces[k].total.allFinite()) problems.Add(JoinPath(path, "total"), "must be finite");
  }
  for (std::size_t k = 0; k < loads.tractions.size(); ++k) {
    const VoxelTraction& load = loads.tractions[k];
    const std::string path = IndexPath("loads.tractions", k);
    if (!load.traction.allFinite()) problems.Add(JoinPath(path, "traction"), "must be finite");
    if (load.faces.empty()) problems.Add(JoinPath(path, "faces"), "no faces are given");
    Count missing;
    for (const VoxelFace& face : load.faces) {
      if (grid.MaterialAt(face.voxel) == 0 || face.side < 0 || face.side > 5) missing.Add(face.voxel);
    }
    if (missing.bad > 0) {
      problems.Add(JoinPath(path, "faces"), std::to_string(missing.bad) + " of " + std::to_string(load.faces.size()) +
                                                " faces do not belong to a solid voxel, the first is at " +
                                                Text(missing.first));
    }
  }
  if (!loads.body_force.allFinite()) problems.Add("loads.body_force", "must be finite");
}

void CheckFreeMotions(const std::vector<FreeMotion>& free, Problems& problems) {
  for (const FreeMotion& motion : free) {
    problems.Add("supports",
                 "no support holds the island of " + std::to_string(motion.voxels) + " voxels that starts at " +
                     Text(motion.first_voxel) + ": it " + motion.motions,
                 "add a support, or keep only the largest island");
  }
}

}  // namespace

void CheckVoxelProblem(const VoxelGrid& grid, const std::vector<VoxelMaterial>& materials,
                       const std::vector<VoxelSupport>& supports, const VoxelLoads& loads, Problems& problems,
                       bool may_fly) {
  const bool usable = CheckGrid(grid, problems);
  if (grid.voxels() != grid.material.size()) return;
  CheckMaterials(grid, materials, problems);
  if (!usable) return;
  const VoxelMesh mesh(grid);
  const FixedComponents fixed = CheckSupports(mesh, supports, problems);
  CheckLoads(grid, mesh, loads, problems);
  if (!may_fly) CheckFreeMotions(FindFreeMotions(grid, mesh, fixed), problems);
}

}  // namespace fascicle
