#ifndef FASCICLE_CORE_EULERIAN_STIFFNESS_H_
#define FASCICLE_CORE_EULERIAN_STIFFNESS_H_

#include <Eigen/Core>

#include <array>
#include <vector>

#include "core/eulerian/hourglass.h"
#include "core/eulerian/node_roles.h"

namespace fascicle {

// dt^2 K, where K is the tangent stiffness of a solid's elastic forces: to first order these change by -dt K v in a
// step. For each cell T = V/J [A : (L F)] F^T for the velocity gradient L, with A = dP/dF made positive semidefinite,
// and its hourglass modes. Symmetric. Matrix-free, because a cut cell depends on many nodes through the root nodes of
// its corners.
class ElasticStiffness {
 public:
  // number: index of each node among the free ones; -1: not free. `roles` and `number` must outlive this.
  ElasticStiffness(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                   const EulerianCells& cells, const NodeRoles& roles, const std::vector<int>& number, double dt,
                   ThreadTeam& team);

  // Adds dt^2 K v to a product; both have three numbers for each free node.
  void AddProduct(const Eigen::Ref<const Eigen::VectorXd>& v, Eigen::Ref<Eigen::VectorXd> product) const;
  // dt^2 K times the prescribed velocities, for the free nodes.
  Eigen::VectorXd OfPrescribed(const std::vector<Vec3>& velocity) const;
  // Adds the impulses on prescribed nodes in the step, -dt^2 K v for all velocities [N s].
  void AddPrescribedImpulses(const std::vector<Vec3>& velocity, std::vector<Vec3>& impulses) const;
  // The diagonal of dt^2 K.
  Eigen::VectorXd Diagonal() const;

 private:
  // Gradient along x, y, z [1/m] and the hourglass modes [1].
  static constexpr int kRows = 3 + kHourglassModes;
  struct Part {
    std::size_t node;
    std::array<double, kRows> weight;
  };
  struct Cell {
    std::vector<Part> parts;  // by ascending nodes, without duplicates
    Mat9 gradient;            // maps L to T, column-major [J s^2/kg m^2]
    Mat3 hourglass;           // maps the velocity of an hourglass mode to its force
  };
  struct Place {
    std::size_t cell, part;
  };
  using CellForces = std::array<Vec3, kRows>;

  template <class Law>
  Cell MakeCell(const Law& law, const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                const EulerianCells& cells, std::size_t cell, double dt) const;
  template <class VelocityOf>
  std::vector<CellForces> ForcesOf(const VelocityOf& velocity_of) const;
  // The sum of the forces of cells on a node.
  Vec3 SumAt(const std::vector<Place>& places, const std::vector<CellForces>& forces) const;
  template <class VelocityOf>
  void Add(const VelocityOf& velocity_of, Eigen::Ref<Eigen::VectorXd> product) const;

  const NodeRoles* roles_;
  const std::vector<int>* number_;
  ThreadTeam* team_;
  std::vector<Cell> cells_;
  std::vector<std::vector<Place>> places_;  // for each free node: its places in cells
  // The same for prescribed nodes.
  struct Prescribed {
    std::size_t node;
    std::vector<Place> places;
  };
  std::vector<Prescribed> prescribed_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_STIFFNESS_H_
