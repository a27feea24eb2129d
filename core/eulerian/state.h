#ifndef FASCICLE_CORE_EULERIAN_STATE_H_
#define FASCICLE_CORE_EULERIAN_STATE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/archive.h"
#include "core/base/pose.h"
#include "core/eulerian/grid.h"

namespace fascicle {

// The state of one body. Positions are points of its grid, and vectors have components along the axes of the grid,
// except for what supports do.
struct EulerianState {
  // At the nodes of the grid, valid in the solid and in a band around it.
  std::vector<Vec3> X;              // reference map: the material point at the node [m]
  std::vector<Vec3> v;              // velocity [m/s]
  std::vector<std::uint8_t> known;  // for each node: whether X and v are valid
  std::vector<Vec3> surface;        // positions of the vertices of the material surface [m]
  // Momentum of a body without supports and its moment about the grid's origin of coordinates [kg m/s, kg m^2/s], with
  // the total mass of the nodes for which it was found [kg]. The mass is 0 before the first step, or after velocities
  // were changed from outside; the momentum is then computed from them.
  double momentum_mass = 0;
  Vec3 momentum = Vec3::Zero(), moment = Vec3::Zero();
  // For each cell: the pressure that preserved its volume in the last step, compression positive [Pa]; NaN where there
  // was none.
  std::vector<double> pressure;
  // At the nodes of PlasticGrid, for bodies with plasticity: Fp^-1, and the positions of these material points [m].
  std::vector<Mat3> plastic;
  std::vector<Vec3> plastic_places;
  std::vector<Vec3> reactions;  // the force of each support on the body in the world, the mean of the last step [N]
  std::vector<Vec3> moments;    // its moment about the origin of the world [N m]
  Pose pose;                    // of the grid in the world; the identity if it does not travel

  // Names in the archive begin with `prefix`.
  void Save(const std::string& prefix, ArchiveWriter& archive) const;
  // Sets failed() of the archive if sizes differ from the current ones.
  void Load(const std::string& prefix, ArchiveReader& archive);
};

// The state of all bodies, which is what a checkpoint saves.
struct EulerianWorldState {
  double time = 0;  // [s]
  std::int64_t step = 0;
  double time_step = 0;         // of the last step [s]
  std::int64_t iterations = 0;  // of MINRES so far
  std::vector<EulerianState> bodies;
  std::vector<Vec3> floor_forces;  // of each floor on all bodies, the mean of the last step [N]

  void Save(ArchiveWriter& archive) const;
  void Load(ArchiveReader& archive);
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_STATE_H_
