#include "core/voxel/scene_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/stop.h"
#include "core/base/vector_text.h"
#include "core/scene/nodal_forces.h"
#include "core/voxel/free_motions.h"
#include "core/voxel/prescribed.h"

namespace fascicle {
namespace {

// E and nu from a law's small-strain moduli.
VoxelMaterial MaterialOf(const Material& material) {
  const double mu = std::visit([](const auto& law) { return law.ShearModulus(); }, material);
  const double bulk = std::visit([](const auto& law) { return law.BulkModulus(); }, material);
  return {9 * bulk * mu / (3 * bulk + mu), (3 * bulk - 2 * mu) / (2 * (3 * bulk + mu))};
}

constexpr std::size_t kMostMaterials = 254;  // of a grid, which stores them in bytes

// The body's grid with materials in place of labels. If each voxel has its own parameters, voxels with the same
// Poisson's ratio share a material and differ in the grid's stiffness factor.
struct GridAndMaterials {
  VoxelGrid grid;
  std::vector<VoxelMaterial> materials;
};

GridAndMaterials GridOf(const Body& body) {
  const VoxelShape& shape = body.voxel();
  GridAndMaterials made = {shape.mesh.grid, {MaterialOf(body.material)}};
  for (const Material& material : shape.materials.more) made.materials.push_back(MaterialOf(material));
  const std::vector<VoxelMaterial> of_parts = made.materials;
  const bool by_ratio = of_parts.size() > kMostMaterials;
  std::vector<std::size_t> number(of_parts.size());
  if (by_ratio) made.materials.clear();
  for (std::size_t p = 0; p < of_parts.size(); ++p) {
    number[p] = p;
    if (!by_ratio) continue;
    const auto same = std::find_if(made.materials.begin(), made.materials.end(), [&](const VoxelMaterial& m) {
      return std::abs(m.poisson_ratio - of_parts[p].poisson_ratio) < 1e-9;
    });
    number[p] = static_cast<std::size_t>(same - made.materials.begin());
    if (same == made.materials.end()) made.materials.push_back(of_parts[p]);
  }
  if (by_ratio && made.grid.stiffness.empty()) made.grid.stiffness.assign(made.grid.voxels(), 1.0F);
  std::size_t element = 0;
  for (std::size_t v = 0; v < made.grid.voxels(); ++v) {
    if (made.grid.material[v] == 0) continue;
    const auto part = static_cast<std::size_t>(shape.materials.of.empty() ? 0 : shape.materials.of[element]);
    ++element;
    made.grid.material[v] = static_cast<std::uint8_t>(1 + number[part]);
    if (!by_ratio) continue;
    made.grid.stiffness[v] *=
        static_cast<float>(of_parts[part].young_modulus / made.materials[number[part]].young_modulus);
  }
  return made;
}

VoxelRotation RotationOf(const Body& body) {
  return std::holds_alternative<CorotatedLinear>(body.material) ? VoxelRotation::kLarge : VoxelRotation::kSmall;
}

// The grid components that correspond to prescribed world axes. CheckScene allows single axes only if the grid is
// aligned with the world axes.
std::array<bool, 3> ComponentsOf(const std::array<bool, 3>& axes, const Mat3& direction) {
  std::array<bool, 3> components = {};
  for (int along = 0; along < 3; ++along) {
    int axis = 0;
    direction.col(along).cwiseAbs().maxCoeff(&axis);
    components[static_cast<std::size_t>(along)] = axes[static_cast<std::size_t>(axis)];
  }
  return components;
}

}  // namespace

VoxelSceneBody::VoxelSceneBody(const Scene& scene, const Body& body) : scene_(&scene), source_(&body) {
  GridAndMaterials made = GridOf(body);
  grid_ = std::move(made.grid);
  model_ = std::make_unique<VoxelModel>(grid_, std::move(made.materials),
                                        scene.voxel.mean_dilatation ? Dilatation::kMean : Dilatation::kFull,
                                        RotationOf(body));
  AddSupports(model_->mesh().NodePlaces());
  AddLoads();
  if (scene.gravity.acceleration == Vec3::Zero()) return;
  gravity_share_.assign(body.nodes().size(), 0.0);
  const double share = body.density * grid_.spacing.prod() / 8;
  for (const Brick& brick : body.voxel().mesh.bricks) {
    for (const std::int32_t node : brick) gravity_share_[static_cast<std::size_t>(node)] += share;
  }
}

void VoxelSceneBody::AddSupports(const std::vector<GridIndex>& places) {
  for (const Constraint& constraint : source_->constraints) {
    VoxelSupport support;
    for (const std::int32_t node : source_->regions[constraint.region].nodes) {
      support.nodes.push_back(places[static_cast<std::size_t>(node)]);
    }
    support.components = ComponentsOf(constraint.axes, direction());
    supports_.push_back(std::move(support));
  }
}

std::vector<Reaction> VoxelSceneBody::SumOverSupports(const VoxelField<double>& reaction,
                                                      const VoxelField<double>& displacement) const {
  std::vector<std::array<bool, 3>> counted(source_->nodes().size());
  std::vector<Reaction> sums;
  for (std::size_t s = 0; s < supports_.size(); ++s) {
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
    for (const std::int32_t node : source_->regions[source_->constraints[s].region].nodes) {
      std::array<bool, 3>& done = counted[static_cast<std::size_t>(node)];
      Vec3 force = Vec3::Zero();
      for (std::size_t d = 0; d < 3; ++d) {
        if (!supports_[s].components[d] || done[d]) continue;
        done[d] = true;
        force[static_cast<Eigen::Index>(d)] = reaction(node, static_cast<int>(d));
      }
      sum += force;
      const Vec3 x = source_->nodes()[static_cast<std::size_t>(node)] + ToWorld(displacement.At(node));
      moment += x.cross(ToWorld(force));
    }
    sums.push_back({ToWorld(sum), moment});
  }
  return sums;
}

void VoxelSceneBody::AddLoads() {
  for (const Load& load : source_->loads) {
    const auto forces = NodalForcesOf(load, LoadedRegionOf(source_->regions[load.region], *source_));
    NodalLoad nodal;
    for (const auto& [node, force] : forces) {
      nodal.nodes.push_back(node);
      nodal.forces.push_back(direction().transpose() * force);
    }
    loads_.push_back(std::move(nodal));
  }
}

void VoxelSceneBody::SetForces(const BodyControls& controls, VoxelField<double>& force) const {
  std::fill_n(force.data(), force.size(), 0.0);
  if (!gravity_share_.empty()) {
    const Vec3 gravity = controls.gravity_scale * (direction().transpose() * scene_->gravity.acceleration);
    for (std::int32_t n = 0; n < force.nodes(); ++n)
      force.Add(n, gravity_share_[static_cast<std::size_t>(n)] * gravity);
  }
  for (std::size_t l = 0; l < loads_.size(); ++l) {
    const NodalLoad& load = loads_[l];
    const double scale = controls.load_scales[l];
    for (std::size_t k = 0; k < load.nodes.size(); ++k) force.Add(load.nodes[k], scale * load.forces[k]);
  }
}

void VoxelSceneBody::Prescribe(const BodyControls& controls, VoxelField<double>& displacement) const {
  for (std::size_t s = 0; s < supports_.size(); ++s) {
    const RigidMotion& motion = controls.motions[s];
    for (const std::int32_t node : source_->regions[source_->constraints[s].region].nodes) {
      const Vec3& X = source_->nodes()[static_cast<std::size_t>(node)];
      const Vec3 along_grid = direction().transpose() * (motion.PositionOf(X) - X);
      for (int d = 0; d < 3; ++d) {
        if (supports_[s].components[static_cast<std::size_t>(d)]) displacement(node, d) = along_grid[d];
      }
    }
  }
}

void CheckVoxelSupports(const Scene& scene, Problems& problems, const std::stop_token& stop) {
  if (scene.method != Method::kVoxel) return;
  if (scene.voxel.stepping == VoxelStepping::kDynamic && !scene.voxel.start_loaded) return;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const VoxelSceneBody body(scene, scene.bodies[i]);
    ThrowIfStopped(stop);
    const PrescribedComponents held(body.model().mesh(), body.supports());
    for (const FreeMotion& motion : FindFreeMotions(body.model().grid(), body.model().mesh(), held.of_nodes(), stop)) {
      const Vec3 place = body.model().grid().CornerAt(motion.first_voxel);
      problems.Add(JoinPath(IndexPath("bodies", i), "constraints"),
                   "no support holds a part of " + std::to_string(motion.voxels) + " voxels near " + VectorText(place) +
                       " m: it " + motion.motions + " of the image",
                   "add a support, keep only the largest part of the image, or use dynamic stepping");
    }
  }
}

}  // namespace fascicle
