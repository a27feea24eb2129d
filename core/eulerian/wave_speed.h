#ifndef FASCICLE_CORE_EULERIAN_WAVE_SPEED_H_
#define FASCICLE_CORE_EULERIAN_WAVE_SPEED_H_

#include "core/eulerian/cells.h"

namespace fascicle {

// The fastest small wave of the material at rest, without its fibres [m/s].
double WaveSpeedAtRest(const EulerianBody& body);

// The fastest wave in any cell, as it is deformed [m/s]. Isotropic laws: that at rest times the largest stretch. Laws
// of fibres: of the acoustic tensor along the fibre and along the axes.
double FastestWave(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                   const EulerianCells& cells, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_WAVE_SPEED_H_
