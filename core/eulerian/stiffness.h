#ifndef FASCICLE_CORE_EULERIAN_STIFFNESS_H_
#define FASCICLE_CORE_EULERIAN_STIFFNESS_H_

#include <Eigen/Core>

#include <array>
#include <vector>

#include "core/eulerian/forces.h"

namespace fascicle {

// dt^2 K, K the stiffness of a solid's elastic forces to velocities of its nodes, as it is deformed: what the forces at
// the end of a step differ from those at its start by, linearized, is -dt K v. Of each cell T = V/J [A : (L F)] F^T for
// the velocity gradient L, with A = dP/dF made positive semidefinite, and its patterns. Symmetric. Without a matrix: a
// cut cell depends on many nodes, by those that its corners follow.
class ElasticStiffness {
 public:
  // number: of each node, its place among the unknown ones; -1: it is not.
  ElasticStiffness(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                   const NodalForces& nodes, const std::vector<int>& number, double dt, ThreadTeam& team);

  // Adds dt^2 K v to a product, both three numbers for each unknown node.
  void AddProduct(const Eigen::VectorXd& v, Eigen::VectorXd& product) const;
  // dt^2 K of the velocities of all held nodes, for the unknown ones.
  Eigen::VectorXd OfHeld(const std::vector<Vec3>& velocity) const;
  // Adds what held nodes are pushed with in the step for all velocities, -dt^2 K v [N s].
  void AddHeldImpulses(const std::vector<Vec3>& velocity, std::vector<Vec3>& impulses) const;
  // The diagonal of dt^2 K.
  Eigen::VectorXd Diagonal() const;

 private:
  // Gradient along x, y, z [1/m] and the four patterns [1].
  static constexpr int kRows = 7;
  struct Part {
    std::size_t node;
    std::array<double, kRows> weight;
  };
  struct Cell {
    std::vector<Part> parts;  // by rising nodes, each once
    Mat9 gradient;            // of T to L, by columns [J s^2/kg m^2]
    Mat3 pattern;             // of the force of a pattern to its velocity
  };
  struct Place {
    std::size_t cell, part;
  };
  using CellForces = std::array<Vec3, kRows>;

  Cell MakeCell(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                const NodalForces& nodes, std::size_t cell, double dt) const;
  template <class VelocityOf>
  std::vector<CellForces> ForcesOf(const VelocityOf& velocity_of) const;
  // What comes together at the places of a node.
  Vec3 SumAt(const std::vector<Place>& places, const std::vector<CellForces>& forces) const;
  template <class VelocityOf>
  void Add(const VelocityOf& velocity_of, Eigen::VectorXd& product) const;

  const NodalForces* nodes_;
  const std::vector<int>* number_;
  ThreadTeam* team_;
  std::vector<Cell> cells_;
  std::vector<std::vector<Place>> places_;  // of each unknown node, where it has a part
  // The same of held nodes.
  struct Held {
    std::size_t node;
    std::vector<Place> places;
  };
  std::vector<Held> held_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_STIFFNESS_H_
