#include "core/tet/model.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "core/base/check.h"
#include "core/tet/element.h"

namespace fascicle {

TetModel::TetModel(const Scene& scene) : scene_(&scene) {
  for (const Body& body : scene.bodies) AddBody(body);
  inverse_mass_.resize(nodes());
  for (std::size_t n = 0; n < nodes(); ++n) inverse_mass_[n].setConstant(1 / mass_[n]);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    AddLoads(*bodies_[b].source, bodies_[b].node_begin);
    AddSupports(*bodies_[b].source, static_cast<std::int32_t>(b), bodies_[b].node_begin);
  }
  ListCornersOfNodes();
  FindCurvesEnd();
}

void TetModel::AddBody(const Body& body) {
  TetBody entry;
  entry.source = &body;
  entry.node_begin = nodes();
  entry.tet_begin = tetrahedra();
  entry.node_end = entry.node_begin + body.mesh.nodes.size();
  entry.tet_end = entry.tet_begin + body.mesh.tetrahedra.size();
  // C:Edot with C = lambda I(x)I + 2 mu I, as in scene.proto Damping.
  const auto [mu, bulk] = std::visit(
      [](const auto& law) {
        return std::pair{law.ShearModulus(), law.BulkModulus()};
      },
      body.material);
  entry.damping_mu = body.damping.stiffness_proportional * mu + body.damping.viscosity;
  entry.damping_lambda = body.damping.stiffness_proportional * (bulk - 2 * mu / 3);
  entry.mass_damping = body.damping.mass_proportional;
  has_mass_damping_ |= entry.mass_damping != 0;
  has_strain_damping_ |= entry.HasStrainDamping();
  bodies_.push_back(entry);

  rest_positions_.insert(rest_positions_.end(), body.mesh.nodes.begin(), body.mesh.nodes.end());
  mass_.resize(entry.node_end, 0.0);
  mass_damping_.resize(entry.node_end, entry.mass_damping);
  for (const Tetrahedron& tet : body.mesh.tetrahedra) {
    Tetrahedron shifted;
    for (int c = 0; c < 4; ++c) shifted[c] = tet[c] + static_cast<std::int32_t>(entry.node_begin);
    const Mat3 Dm = EdgeMatrix(rest_positions_, shifted);
    const double volume = Dm.determinant() / 6;
    FASCICLE_CHECK(volume > 0, "meshes are checked before they are simulated");
    tetrahedra_.push_back(shifted);
    Dm_inverse_.push_back(Dm.inverse());
    rest_volume_.push_back(volume);
    for (const std::int32_t n : shifted) mass_[n] += body.density * volume / 4;
  }
  if (body.fibres.empty()) {
    fibres_.resize(tetrahedra(), Vec3::Zero());
  } else {
    fibres_.insert(fibres_.end(), body.fibres.begin(), body.fibres.end());
  }
}

void TetModel::AddLoads(const Body& body, std::size_t node_begin) {
  for (const Load& load : body.loads) {
    const Region& region = body.regions[load.region];
    std::map<std::int32_t, Vec3> forces;  // ordered, so that sums do not depend on where things lie in memory
    if (const auto* force = std::get_if<NodalForce>(&load.kind)) {
      for (const std::int32_t n : region.nodes) {
        forces.emplace(n, force->total / static_cast<double>(region.nodes.size()));
      }
    } else {
      // Consistent with linear shape functions: a third of each triangle to each of its nodes.
      const Vec3& traction = std::get<Traction>(load.kind).vector;
      const auto& X = body.mesh.nodes;
      for (const Triangle& t : region.triangles) {
        const double area = 0.5 * (X[t[1]] - X[t[0]]).cross(X[t[2]] - X[t[0]]).norm();
        for (const std::int32_t n : t) forces.try_emplace(n, Vec3::Zero()).first->second += area / 3 * traction;
      }
    }
    NodalLoad& entry = loads_.emplace_back();
    entry.scale = &load.scale;
    for (const auto& [n, force] : forces) {
      entry.nodes.push_back(n + static_cast<std::int32_t>(node_begin));
      entry.forces.push_back(force);
    }
  }
}

void TetModel::AddSupports(const Body& body, std::int32_t body_index, std::size_t node_begin) {
  for (const Constraint& constraint : body.constraints) {
    Support& support = supports_.emplace_back();
    support.source = &constraint;
    support.body = body_index;
    for (const std::int32_t local : body.regions[constraint.region].nodes) {
      const std::int32_t n = local + static_cast<std::int32_t>(node_begin);
      std::array<bool, 3> owned = {};
      for (int c = 0; c < 3; ++c) {
        owned[c] = constraint.axes[c] && inverse_mass_[n][c] != 0;
        if (owned[c]) inverse_mass_[n][c] = 0;
      }
      support.nodes.push_back(n);
      support.owned.push_back(owned);
    }
  }
}

void TetModel::ListCornersOfNodes() {
  node_corner_begin_.assign(nodes() + 1, 0);
  for (const Tetrahedron& tet : tetrahedra_) {
    for (const std::int32_t n : tet) ++node_corner_begin_[n + 1];
  }
  for (std::size_t n = 0; n < nodes(); ++n) node_corner_begin_[n + 1] += node_corner_begin_[n];
  node_corners_.resize(4 * tetrahedra());
  std::vector<std::int32_t> next(node_corner_begin_.begin(), node_corner_begin_.end() - 1);
  for (std::size_t e = 0; e < tetrahedra(); ++e) {
    for (int c = 0; c < 4; ++c) node_corners_[next[tetrahedra_[e][c]]++] = static_cast<CornerIndex>(4 * e + c);
  }
}

void TetModel::FindCurvesEnd() {
  const auto take = [this](const Curve& curve) {
    if (curve.times.size() > 1) curves_end_ = std::max(curves_end_, curve.end());
  };
  take(scene_->gravity.scale);
  for (const Body& body : scene_->bodies) {
    take(body.activation);
    for (const Load& load : body.loads) take(load.scale);
    for (const Constraint& constraint : body.constraints) {
      for (const auto& translation : constraint.motion.translation) {
        if (translation) take(*translation);
      }
      if (constraint.motion.rotation) take(constraint.motion.rotation->angle);
    }
  }
}

}  // namespace fascicle
