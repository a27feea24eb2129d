#ifndef FASCICLE_CORE_EULERIAN_WAVE_SPEED_H_
#define FASCICLE_CORE_EULERIAN_WAVE_SPEED_H_

#include "core/eulerian/cells.h"

namespace fascicle {

// The fastest small-amplitude wave of the material at rest, without its fibres [m/s].
double WaveSpeedAtRest(const EulerianBody& body);

// The speed of the fastest wave in any cell in its deformed state [m/s]. For isotropic laws: that at rest times the
// largest stretch. For laws with fibres: by the acoustic tensor along the fibre and along the axes.
double FastestWave(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                   const EulerianCells& cells, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_WAVE_SPEED_H_
