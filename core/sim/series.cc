#include "core/sim/series.h"

#include <map>
#include <string>

namespace fascicle {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

// Several constraints may act on one region (along different axes); their reactions are one series. In the order of
// first use.
struct RegionReaction {
  std::int32_t region;
  std::vector<std::size_t> constraints;
};

std::vector<RegionReaction> RegionReactions(const Body& body) {
  std::vector<RegionReaction> reactions;
  std::map<std::int32_t, std::size_t> places;
  for (std::size_t k = 0; k < body.constraints.size(); ++k) {
    const std::int32_t region = body.constraints[k].region;
    const auto [place, is_new] = places.try_emplace(region, reactions.size());
    if (is_new) reactions.push_back({region, {}});
    reactions[place->second].constraints.push_back(k);
  }
  return reactions;
}

}  // namespace

void AddBodySeries(const Body& body, std::vector<SeriesInfo>& series) {
  for (const RegionReaction& reaction : RegionReactions(body)) {
    const std::string& region = body.regions[reaction.region].name;
    for (const char* axis : kAxes) {
      series.push_back({body.name + "/reaction/" + region + "/" + axis, "N",
                        "force of the support of `" + region + "` on the body along " + axis});
    }
  }
  for (std::size_t k = 0; k < body.loads.size(); ++k) {
    if (!body.loads[k].stern) continue;
    const std::string& region = body.regions[body.loads[k].region].name;
    series.push_back(
        {body.name + "/load/" + std::to_string(k) + "/" + region, "N", "force of the muscle on `" + region + "`"});
  }
}

void AddBodyValues(const Body& body, const BodyControls& controls, std::span<const Vec3> forces,
                   std::vector<double>& values) {
  for (const RegionReaction& reaction : RegionReactions(body)) {
    Vec3 sum = Vec3::Zero();
    for (const std::size_t k : reaction.constraints) sum += forces[k];
    values.insert(values.end(), sum.begin(), sum.end());
  }
  for (std::size_t k = 0; k < body.loads.size(); ++k) {
    if (body.loads[k].stern) values.push_back(controls.load_scales[k]);
  }
}

void AddProbeSeries(const Scene& scene, std::vector<SeriesInfo>& series) {
  for (const Probe& probe : scene.output.probes) {
    for (const char* axis : kAxes) {
      series.push_back({"probe/" + probe.name + "/" + axis, "m", std::string("displacement along ") + axis});
    }
  }
}

}  // namespace fascicle
