#ifndef FASCICLE_CORE_SIM_SERIES_H_
#define FASCICLE_CORE_SIM_SERIES_H_

#include <span>
#include <vector>

#include "core/scene/controls.h"
#include "core/sim/frame.h"

// Series common to all methods: those of supports, loads and probes.
namespace fascicle {

// For a body: the reaction at each region, x, y and z, then the force of each muscle (SternPull).
void AddBodySeries(const Body& body, std::vector<SeriesInfo>& series);
// Their values with the body's controls.
//   forces  on the body by each of its constraints, in order [N]
void AddBodyValues(const Body& body, const BodyControls& controls, std::span<const Vec3> forces,
                   std::vector<double>& values);

// The displacement of each probe, x, y and z.
void AddProbeSeries(const Scene& scene, std::vector<SeriesInfo>& series);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_SERIES_H_
