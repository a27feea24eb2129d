#ifndef FASCICLE_SERVER_TRANSLATE_STEERING_H_
#define FASCICLE_SERVER_TRANSLATE_STEERING_H_

#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/sim/steering.h"
#include "fascicle/v1/job.pb.h"
#include "fascicle/v1/steering.pb.h"
#include "server/store/store.h"

namespace fascicle::server {

// What can be steered in a scene, with the names that clients use.
struct SteeringTarget {
  std::string name;
  SteeredControl control;  // without its value
  double least = 0, most = 1;
};
struct SteeringTargets {
  std::vector<SteeringTarget> activations, loads, motions;
};

// The scene must be one that TranslateScene accepts.
SteeringTargets SteeringTargetsOf(const v1::Scene& scene);

// The changes of an input. Fills in its defaults. Reports names that the scene does not have, values out of range,
// controls that are named twice; paths begin with `path`.
SteeringInput TranslateSteering(const v1::Scene& scene, const std::string& path, v1::SteeringInput& input,
                                Problems& problems);

// The inputs that a job brings along, at `path`: reports what is wrong with them or with their order, and fills in
// their defaults.
void CheckInputs(v1::Job& job, const std::string& path, Problems& problems);

// An input as it is stored: without what the server sets.
std::string EncodeSteering(const v1::SteeringInput& input);

// A stored input as a job brings it along: it takes effect with the step that is stored, if that is known. Throws
// std::runtime_error if it can't be read.
v1::SteeringInput InputForSpec(const SteeringRecord& record);

// JobCodec::inputs_of_spec and decode_inputs.
std::vector<SteeringRecord> InputsOfSpec(const std::string& spec);
std::vector<SteeringInput> DecodeInputs(const std::string& spec, const std::vector<SteeringRecord>& inputs);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_STEERING_H_
