#include "core/sim/series.h"

#include <map>
#include <string>

#include "core/base/component_names.h"

namespace fascicle {
namespace {

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
    for (const char* axis : kAxisNames) {
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

void AddBodyValues(const Body& body, const BodyControls& controls, std::span<const Reaction> reactions,
                   std::vector<double>& values) {
  for (const RegionReaction& reaction : RegionReactions(body)) {
    Vec3 sum = Vec3::Zero();
    for (const std::size_t k : reaction.constraints) sum += reactions[k].force;
    values.insert(values.end(), sum.begin(), sum.end());
  }
  for (std::size_t k = 0; k < body.loads.size(); ++k) {
    if (body.loads[k].stern) values.push_back(controls.load_scales[k]);
  }
}

void AddProbeSeries(const Scene& scene, std::vector<SeriesInfo>& series) {
  for (const Probe& probe : scene.output.probes) {
    const std::string place = probe.inside ? "nearest_node/" : "";
    const std::string of = probe.inside ? "displacement of the nearest node along " : "displacement along ";
    for (const char* axis : kAxisNames) series.push_back({"probe/" + probe.name + "/" + place + axis, "m", of + axis});
  }
}

void AddMomentSeries(const Scene& scene, std::vector<SeriesInfo>& series) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    for (const RegionReaction& reaction : RegionReactions(body)) {
      const std::string& region = body.regions[reaction.region].name;
      const std::string name = body.name + "/moment/" + region + "/";
      for (const char* axis : kAxisNames) {
        series.push_back({name + axis, "N m",
                          "moment of the support of `" + region + "` on the body about its point, along " + axis});
      }
      if (!MomentReferenceOf(scene, b, reaction.region).axis) continue;
      series.push_back({name + "axis", "N m", "moment of the support of `" + region + "` on the body about its axis"});
    }
  }
}

void AddMomentValues(const Scene& scene, std::span<const Reaction> reactions, std::vector<double>& values) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    for (const RegionReaction& reaction : RegionReactions(body)) {
      Reaction sum;
      for (const std::size_t k : reaction.constraints) {
        sum.force += reactions[k].force;
        sum.moment += reactions[k].moment;
      }
      const MomentReference reference = MomentReferenceOf(scene, b, reaction.region);
      const Vec3 moment = sum.moment - reference.point.cross(sum.force);
      values.insert(values.end(), moment.begin(), moment.end());
      if (reference.axis) values.push_back(moment.dot(*reference.axis));
    }
    reactions = reactions.subspan(body.constraints.size());
  }
}

void AddInnerProbeSeries(const Scene& scene, std::vector<SeriesInfo>& series) {
  for (const Probe& probe : scene.output.probes) {
    const std::string name = "probe/" + probe.name + "/";
    for (const char* axis : kAxisNames) {
      if (probe.inside) series.push_back({name + axis, "m", std::string("displacement along ") + axis});
    }
    for (const OutputField field : scene.output.fields) {
      const OutputFieldInfo& info = InfoOf(field);
      if (info.from == FieldSource::kNodalForce) continue;
      for (const std::string& component : ComponentNames(info.name, info.components)) {
        series.push_back({name + info.name + (component.empty() ? "" : "/" + component), info.unit,
                          std::string(info.name) + " at the probe" + (component.empty() ? "" : ", " + component)});
      }
    }
  }
}

void AddInnerProbeValues(const Scene& scene, const ProbeMeasures& measures, std::vector<double>& values) {
  for (const Probe& probe : scene.output.probes) {
    if (probe.inside) {
      const Vec3 u = measures.displacement(probe);
      values.insert(values.end(), u.begin(), u.end());
    }
    for (const OutputField field : scene.output.fields) {
      if (InfoOf(field).from == FieldSource::kNodalForce) continue;
      const std::vector<double> at_probe = measures.field_values(probe, field);
      values.insert(values.end(), at_probe.begin(), at_probe.end());
    }
  }
}

}  // namespace fascicle
