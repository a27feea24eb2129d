#ifndef FASCICLE_CORE_EULERIAN_PLASTICITY_H_
#define FASCICLE_CORE_EULERIAN_PLASTICITY_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/eulerian/body.h"
#include "core/eulerian/state.h"

namespace fascicle {

// The grid in material space that stores the plastic deformation. It is never advected and therefore has no numerical
// diffusion, however the solid moves [Fan 2013, 3.5].
EulerianGrid PlasticGrid(const EulerianBody& body);

// Fp^-1 at a material point, trilinear between nodes and scaled to det = 1.
Mat3 PlasticInverse(const EulerianGrid& samples, const std::vector<Mat3>& plastic, const Vec3& X);

// Plastic flow during dt [s] where the von Mises stress exceeds the yield stress, along the elastic stretches and
// isochoric: with Fe = U S V^T, Fp^-1 <- Fp^-1 V (S / det(S)^(1/3))^-gamma V^T [Fan 2013, eqs. 3.51 to 3.54; Bargteil
// et al. 2007], gamma = (1 - yield/stress) (1 - exp(-dt/relaxation)). With a relaxation time of 0 the whole overstress
// relaxes. Reads the map; sets state.plastic and state.plastic_places.
void FlowPlastically(const EulerianBody& body, const BodyControls& controls, double dt, ThreadTeam& team,
                     EulerianState& state);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_PLASTICITY_H_
