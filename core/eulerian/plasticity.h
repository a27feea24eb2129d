#ifndef FASCICLE_CORE_EULERIAN_PLASTICITY_H_
#define FASCICLE_CORE_EULERIAN_PLASTICITY_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/eulerian/body.h"
#include "core/eulerian/state.h"

namespace fascicle {

// The grid over the material at whose nodes the plastic deformation is kept: it is never interpolated from node to node
// as the solid moves, and so does not smear [Fan 2013, 3.5].
EulerianGrid PlasticGrid(const EulerianBody& body);

// Fp^-1 at a point of the material, trilinear between the nodes and scaled to det = 1.
Mat3 PlasticInverse(const EulerianGrid& samples, const std::vector<Mat3>& plastic, const Vec3& X);

// Lets the material flow for dt [s] where its von Mises stress exceeds the yield stress, along the elastic stretches
// and at constant volume: with Fe = U S V^T, Fp^-1 <- Fp^-1 V (S / det(S)^(1/3))^-gamma V^T [Fan 2013, 3.51; Bargteil
// et al. 2007], gamma = (1 - yield/stress) (1 - exp(-dt/relaxation)): all of the excess at once where that time is 0.
// Reads the map, sets state.plastic and state.plastic_places.
void FlowPlastically(const EulerianBody& body, const BodyControls& controls, double dt, ThreadTeam& team,
                     EulerianState& state);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_PLASTICITY_H_
