#ifndef FASCICLE_CORE_SIM_SERIES_H_
#define FASCICLE_CORE_SIM_SERIES_H_

#include <span>
#include <vector>

#include "core/scene/controls.h"
#include "core/sim/frame.h"

// Series that all methods have in common: those of supports, loads and probes.
namespace fascicle {

// Of a body: the force of the supports of each region, x, y and z, then the pull of each muscle (SternPull).
void AddBodySeries(const Body& body, std::vector<SeriesInfo>& series);
// Their values under the body's controls.
//   forces  of the body's constraints on it, one each, in their order [N]
void AddBodyValues(const Body& body, const BodyControls& controls, std::span<const Vec3> forces,
                   std::vector<double>& values);

// The displacement of each probe, x, y and z.
void AddProbeSeries(const Scene& scene, std::vector<SeriesInfo>& series);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_SERIES_H_
