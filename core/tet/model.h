#ifndef FASCICLE_CORE_TET_MODEL_H_
#define FASCICLE_CORE_TET_MODEL_H_

#include <cstdint>
#include <vector>

#include "core/linalg/nodal_vector.h"
#include "core/scene/scene.h"

namespace fascicle {

// One corner of one tetrahedron has the number 4 * tetrahedron + corner.
using CornerIndex = std::int32_t;

// A body's share of the model's arrays.
struct TetBody {
  const Body* source = nullptr;
  std::size_t node_begin = 0, node_end = 0;
  std::size_t tet_begin = 0, tet_end = 0;
  // Viscous stress S_v = 2 damping_mu Edot + damping_lambda tr(Edot) I [Pa s].
  double damping_mu = 0, damping_lambda = 0;
  double mass_damping = 0;  // [1/s]

  bool HasStrainDamping() const { return damping_mu != 0 || damping_lambda != 0; }
};

// A load as forces on nodes at scale 1.
struct NodalLoad {
  const Curve* scale = nullptr;
  std::vector<std::int32_t> nodes;  // ascending
  std::vector<Vec3> forces;         // [N]
};

// A region whose motion is prescribed.
struct Support {
  const Constraint* source = nullptr;
  std::int32_t body = 0;
  std::vector<std::int32_t> nodes;  // ascending
  // Which components of each node are this support's; where two supports share one, it belongs to the first.
  std::vector<std::array<bool, 3>> owned;
};

// A scene made ready for stepping: nodes and tetrahedra of all bodies in common arrays, and what does not change.
// Indices count through all bodies. Immutable; may be shared between threads.
class TetModel {
 public:
  // The scene must have passed CheckScene and must outlive the model.
  explicit TetModel(const Scene& scene);

  const Scene& scene() const { return *scene_; }
  const std::vector<TetBody>& bodies() const { return bodies_; }
  std::size_t nodes() const { return rest_positions_.size(); }
  std::size_t tetrahedra() const { return tetrahedra_.size(); }

  const NodalVector& rest_positions() const { return rest_positions_; }  // X [m]
  const std::vector<Tetrahedron>& corners() const { return tetrahedra_; }
  const std::vector<Mat3>& Dm_inverse() const { return Dm_inverse_; }      // Dm^-1 [1/m]
  const std::vector<double>& rest_volume() const { return rest_volume_; }  // V [m^3]
  const std::vector<Vec3>& fibres() const { return fibres_; }              // a0; zero without fibres
  const std::vector<double>& mass() const { return mass_; }                // lumped: rho V/4 to each corner [kg]
  // 1/m [1/kg], and zero for components whose motion is prescribed.
  const NodalVector& inverse_mass() const { return inverse_mass_; }
  // Rayleigh damping of each node: mass_damping of its body [1/s].
  const std::vector<double>& mass_damping() const { return mass_damping_; }

  // Bm3 = -V Dm^-T, so that [f1 f2 f3] = P Bm3 [Teran 2003, 4.1].
  Mat3 Bm3(std::size_t tet) const { return -rest_volume_[tet] * Dm_inverse_[tet].transpose(); }

  // The corners at node n: node_corners()[node_corner_begin()[n] .. node_corner_begin()[n + 1]), ascending.
  const std::vector<std::int32_t>& node_corner_begin() const { return node_corner_begin_; }
  const std::vector<CornerIndex>& node_corners() const { return node_corners_; }

  const std::vector<NodalLoad>& loads() const { return loads_; }
  const std::vector<Support>& supports() const { return supports_; }
  bool has_gravity() const { return scene_->gravity.acceleration != Vec3::Zero(); }
  bool has_damping() const { return has_mass_damping_ || has_strain_damping_; }
  bool has_mass_damping() const { return has_mass_damping_; }
  bool has_strain_damping() const { return has_strain_damping_; }
  // The time after which no curve changes any more [s].
  double curves_end() const { return curves_end_; }

 private:
  void AddBody(const Body& body);
  void AddLoads(const Body& body, std::size_t node_begin);
  void AddSupports(const Body& body, std::int32_t body_index, std::size_t node_begin);
  void ListCornersOfNodes();
  void FindCurvesEnd();

  const Scene* scene_;
  std::vector<TetBody> bodies_;
  NodalVector rest_positions_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<Mat3> Dm_inverse_;
  std::vector<double> rest_volume_;
  std::vector<Vec3> fibres_;
  std::vector<double> mass_;
  NodalVector inverse_mass_;
  std::vector<double> mass_damping_;
  std::vector<std::int32_t> node_corner_begin_;
  std::vector<CornerIndex> node_corners_;
  std::vector<NodalLoad> loads_;
  std::vector<Support> supports_;
  bool has_mass_damping_ = false;
  bool has_strain_damping_ = false;
  double curves_end_ = 0;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_MODEL_H_
