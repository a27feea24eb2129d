#ifndef FASCICLE_CORE_SIM_SERIES_H_
#define FASCICLE_CORE_SIM_SERIES_H_

#include <functional>
#include <span>
#include <vector>

#include "core/scene/controls.h"
#include "core/scene/support_moment.h"
#include "core/sim/frame.h"

// Series common to all methods: those of supports, loads and probes, in two parts.
namespace fascicle {

inline constexpr const char* kAxisNames[] = {"x", "y", "z"};

// First part. For a body: the reaction at each region, x, y and z, then the force of each muscle (SternPull).
void AddBodySeries(const Body& body, std::vector<SeriesInfo>& series);
// Their values with the body's controls.
//   reactions  of each of its constraints, in order
void AddBodyValues(const Body& body, const BodyControls& controls, std::span<const Reaction> reactions,
                   std::vector<double>& values);

// The displacement of the node nearest to each probe, x, y and z: that of the probe if it is at the node.
void AddProbeSeries(const Scene& scene, std::vector<SeriesInfo>& series);

// Second part. The moment at each region; the displacement of probes inside of elements; the scene's fields at probes.
void AddMomentSeries(const Scene& scene, std::vector<SeriesInfo>& series);
//   reactions  of all constraints of all bodies, in order
void AddMomentValues(const Scene& scene, std::span<const Reaction> reactions, std::vector<double>& values);

void AddInnerProbeSeries(const Scene& scene, std::vector<SeriesInfo>& series);
// How a method measures a probe.
struct ProbeMeasures {
  std::function<Vec3(const Probe&)> displacement;                              // [m]
  std::function<std::vector<double>(const Probe&, OutputField)> field_values;  // all components
};
void AddInnerProbeValues(const Scene& scene, const ProbeMeasures& measures, std::vector<double>& values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_SERIES_H_
