#ifndef FASCICLE_CORE_MATERIALS_UNIAXIAL_CURVE_H_
#define FASCICLE_CORE_MATERIALS_UNIAXIAL_CURVE_H_

#include <span>
#include <vector>

#include "core/materials/material.h"

namespace fascicle {

// One point of a uniaxial tension test along z, which is also the fibre direction. The sides are free: F = diag(l_x,
// l_y, stretch), with the lateral stretches for which the lateral stresses vanish. A law with a reference direction has
// it along x, whatever its components; l_x = l_y for all other laws.
struct UniaxialPoint {
  double stretch = 0;            // along z [1]
  double lateral_stretch = 0;    // l_x [1]
  double lateral_stretch_y = 0;  // l_y [1]
  double volume_ratio = 0;       // J = l_x l_y stretch [1]
  double cauchy_stress = 0;      // sigma_zz, force per deformed area [Pa]
  double nominal_stress = 0;     // P_zz, force per rest area [Pa]
  // Whether such a lateral stretch was found. If not, all members but `stretch` are NaN.
  bool converged = false;
};

// The state of the muscle during the test.
struct Contraction {
  double activation = 0;  // in [0, 1]
  double velocity = 0;    // rate of the isochoric fibre stretch [1/s], negative while it shortens
};

// Requires stretch > 0. Thread-safe, like everything in this room.
UniaxialPoint UniaxialTension(const Material& material, const Contraction& contraction, double stretch);
inline UniaxialPoint UniaxialTension(const Material& material, double activation, double stretch) {
  return UniaxialTension(material, Contraction{activation}, stretch);
}

// The same for each of `stretches`: what `fascicle materials curve` prints and draws.
std::vector<UniaxialPoint> UniaxialCurve(const Material& material, const Contraction& contraction,
                                         std::span<const double> stretches);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_UNIAXIAL_CURVE_H_
