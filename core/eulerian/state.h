#ifndef FASCICLE_CORE_EULERIAN_STATE_H_
#define FASCICLE_CORE_EULERIAN_STATE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/archive.h"
#include "core/base/pose.h"
#include "core/eulerian/grid.h"

namespace fascicle {

// What changes of a body from step to step.
struct EulerianState {
  // At the nodes of the grid, in the solid and in a band around it; elsewhere they mean nothing.
  std::vector<Vec3> X;              // reference map: which point of the material is there [m]
  std::vector<Vec3> v;              // velocity [m/s]
  std::vector<std::uint8_t> known;  // of each node: whether X and v mean something
  std::vector<Vec3> surface;        // positions of the vertices of the material surface [m]
  // What the momentum of a body without supports and its moment about the origin should be [kg m/s, kg m^2/s], with
  // the mass of all nodes that it was found for [kg]: 0 before the first step, or after velocities were changed by
  // hand, when it is taken from these.
  double momentum_mass = 0;
  Vec3 momentum = Vec3::Zero(), moment = Vec3::Zero();
  // Of each cell, what kept its volume in the last step, compression positive [Pa]; NaN where nothing did.
  std::vector<double> pressure;
  // At the nodes of PlasticGrid, of bodies that flow plastically: Fp^-1, and where these points of the material are
  // [m].
  std::vector<Mat3> plastic;
  std::vector<Vec3> plastic_places;
  std::vector<Vec3> reactions;  // of each support, its force on the body in the mean of the last step [N]
  Pose pose;                    // of the grid in the world: identity, as grids rest

  // Names in the archive begin with `prefix`.
  void Save(const std::string& prefix, ArchiveWriter& archive) const;
  // Sets failed() of the archive when sizes differ from the present ones.
  void Load(const std::string& prefix, ArchiveReader& archive);
};

// What changes from step to step of all bodies, and all that a checkpoint saves.
struct EulerianWorldState {
  double time = 0;  // [s]
  std::int64_t step = 0;
  double time_step = 0;         // of the last step [s]
  std::int64_t iterations = 0;  // of MINRES so far
  std::vector<EulerianState> bodies;

  void Save(ArchiveWriter& archive) const;
  void Load(ArchiveReader& archive);
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_STATE_H_
