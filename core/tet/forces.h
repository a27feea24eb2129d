#ifndef FASCICLE_CORE_TET_FORCES_H_
#define FASCICLE_CORE_TET_FORCES_H_

#include <concepts>
#include <span>
#include <vector>

#include "core/tet/kernels.h"
#include "core/tet/model.h"

// Loops over the elements, chunk by chunk. The law is fixed within a chunk, and nothing is allocated after the first
// call. Results have the same bits for any number of threads and every instruction set, because the order in which a
// chunk adds up its elements, and a node its chunks, is fixed.
//   x, v   positions [m] and velocities [m/s] of all nodes
namespace fascicle {

struct BranchDrive;

// Arguments of the laws besides the deformation.
struct FibreDrive {
  // Isometric fibres, converted from any array of activations. NOLINTBEGIN(google-explicit-constructor)
  template <class Activations>
  requires std::convertible_to<const Activations&, std::span<const double>> FibreDrive(const Activations& of_curves)
      : activation(of_curves) {}
  // NOLINTEND(google-explicit-constructor)
  FibreDrive(std::span<const double> of_curves, const NodalVector* positions_before, double one_over_step)
      : activation(of_curves), previous(positions_before), inverse_step(one_over_step) {}
  FibreDrive() = default;

  std::span<const double> activation;     // Controls::activations [1]
  const NodalVector* previous = nullptr;  // positions one step ago [m], for laws that depend on rate; null: isometric
  double inverse_step = 0;                // inverse of that step's length [1/s]
  const BranchDrive* branches = nullptr;  // stresses of Maxwell branches; null: none
};

// Scratch memory of the functions below; reused by later calls.
struct ForceWorkspace {
  const Kernels* kernels = &KernelsFor(PreferredInstructionSet());
  std::vector<double> slot_sums;     // for shared nodes or patches, see Sharing
  std::vector<ChunkReport> reports;  // one for each chunk
  std::vector<Mat3> slot_blocks;     // for AssembleStiffness
  // For each patch: theta before and after smoothing [1], the pressure U'(theta), and W U'(theta), which acts on
  // elements [Pa].
  std::vector<double> raw_ratio, ratio, own_pressure, pressure;
};

struct ForceReport {
  bool valid = true;            // false if J <= 0 in an element or a patch, or if a stress is not finite
  double dissipated_power = 0;  // by viscous stress [W]
  double smallest_ratio = 1;    // least J of all elements, at most 1
};

// Elastic (and active) force of all elements on the nodes [N] [Teran 2003, 4.1].
ForceReport ElasticForce(const TetModel& model, const FibreDrive& drive, const NodalVector& x, ThreadTeam& team,
                         ForceWorkspace& workspace, NodalVector& force);

// The same with the viscous force added, in one loop.
ForceReport ElasticAndViscousForce(const TetModel& model, const FibreDrive& drive, const NodalVector& x,
                                   const NodalVector& v, ThreadTeam& team, ForceWorkspace& workspace,
                                   NodalVector& force);

// The viscous force D v only: linear in v, symmetric, negative semidefinite.
void ViscousForce(const TetModel& model, const NodalVector& x, const NodalVector& v, ThreadTeam& team,
                  ForceWorkspace& workspace, NodalVector& force);

// The diagonal of -D [kg/s], non-negative.
void ViscousDiagonal(const TetModel& model, const NodalVector& x, ThreadTeam& team, ForceWorkspace& workspace,
                     NodalVector& diagonal);

// Elastic energy of one body [J], including each patch's part within this body.
double ElasticEnergy(const TetModel& model, std::size_t body, const FibreDrive& drive, const NodalVector& x,
                     ThreadTeam& team);

// Computes volume ratio theta and pressure U'(theta) of every patch in the workspace; false if a ratio is not positive.
bool UpdatePatches(const TetModel& model, const NodalVector& x, ThreadTeam& team, ForceWorkspace& workspace);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FORCES_H_
