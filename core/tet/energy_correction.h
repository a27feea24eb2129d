#ifndef FASCICLE_CORE_TET_ENERGY_CORRECTION_H_
#define FASCICLE_CORE_TET_ENERGY_CORRECTION_H_

#include <vector>

#include "core/tet/forces.h"

namespace fascicle {

// What the mean of the forces at both ends of a step lacks to do exactly the work that the elastic energy loses: a
// discrete gradient of the energy [Gonzalez 2000, Exact energy and momentum conserving algorithms for general models in
// nonlinear elasticity, Comput. Methods Appl. Mech. Engrg. 190; Harten, Lax & van Leer 1983]. At every point
//
//   P* = (P + P')/2 + c (F' - F),   c = (W' - W + p* (J' - J) - (P + P')/2 : (F' - F)) / |F' - F|^2,
//
// where P includes the pressure of patches, p* is W applied to (U' - U) / (theta' - theta) of each patch, and W is the
// energy of the law at the mean activation. Then f* . (x' - x) = -(energy' - energy) for every law. Linear momentum is
// conserved. c is of second order in the step and smooth. Fibres are isometric here, and Maxwell branches left out:
// what these do is no change of an energy. Not thread-safe.
class EnergyCorrection {
 public:
  // The model must outlive this.
  explicit EnergyCorrection(const TetModel& model) : model_(model) {}

  // The start of a step: its positions [m], and the activations at both ends.
  void Start(const NodalVector& x, std::span<const double> activation, std::span<const double> activation_next,
             ThreadTeam& team);

  // Sets `correction` to the nodal forces of c (F' - F) [N] for a step that ends at x [m].
  void At(const NodalVector& x, ThreadTeam& team, NodalVector& correction);

 private:
  struct Point {
    Mat3 P;         // of law and patches [Pa]
    double energy;  // of the law [J/m^3]
  };
  template <class Element, class Visit>
  void ForPoints(const NodalVector& x, std::span<const double> activation, const ForceWorkspace& patches,
                 ThreadTeam& team, const Visit& visit) const;

  const TetModel& model_;
  const NodalVector* start_ = nullptr;
  std::vector<double> next_, mean_;  // activations
  std::vector<Point> points_;        // at the start
  ForceWorkspace patches_start_, patches_end_;
  std::vector<double> secant_, acting_;  // p* of each patch before and after W [Pa]
  NodalVector element_forces_;           // of each node of each element
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_ENERGY_CORRECTION_H_
