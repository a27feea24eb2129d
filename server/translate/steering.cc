#include "server/translate/steering.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "proto/frames/replayed_input.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

constexpr int kMostInputs = 10'000;   // of a job
constexpr int kMostSteered = 64;      // of an input
constexpr double kMostFactor = 1000;  // and least: -kMostFactor
constexpr double kLongestRamp = 1e6;  // [s]

// Adds entries with the names BODY/REGION, or BODY/REGION/K where the region has several.
class RegionTargets {
 public:
  RegionTargets(std::string body, std::vector<SteeringTarget>& targets) : body_(std::move(body)), targets_(targets) {}

  void Add(const std::string& region, int number, const SteeringTarget& target) {
    entries_.push_back({region, number, target});
    ++count_[region];
  }

  void Finish() {
    for (Entry& entry : entries_) {
      entry.target.name = body_ + "/" + entry.region;
      if (count_[entry.region] > 1) entry.target.name += "/" + std::to_string(entry.number);
      targets_.push_back(std::move(entry.target));
    }
  }

 private:
  struct Entry {
    std::string region;
    int number;
    SteeringTarget target;
  };

  const std::string body_;
  std::vector<SteeringTarget>& targets_;
  std::vector<Entry> entries_;
  std::map<std::string, int> count_;
};

SteeringTarget FactorOn(ControlKind kind, std::int32_t index) {
  return {"", {kind, index, 0}, -kMostFactor, kMostFactor};
}

SteeringTarget TargetOf(const v1::Load& load, std::int32_t index) {
  SteeringTarget target = FactorOn(ControlKind::kLoad, index);
  // Explicit steps are as long as the springs of the scene allow.
  if (load.has_springs() || load.has_line_spring()) target.least = 0, target.most = 1;
  return target;
}

bool Moves(const v1::Constraint& constraint) {
  return constraint.motion().translation_size() > 0 || constraint.motion().has_rotation();
}

// Reads one list of controls.
class ControlReader {
 public:
  ControlReader(const std::vector<SteeringTarget>& targets, std::string path, std::string what, SteeringInput& input,
                Problems& problems)
      : targets_(targets), path_(std::move(path)), what_(std::move(what)), input_(input), problems_(problems) {}

  void Read(const google::protobuf::RepeatedPtrField<v1::SteeredControl>& controls) {
    for (int i = 0; i < controls.size(); ++i) {
      ReadOne(controls[i], JoinPath(path_, IndexPath(what_ + "s", static_cast<std::size_t>(i))));
    }
  }

 private:
  void ReadOne(const v1::SteeredControl& control, const std::string& path) {
    const auto target = std::find_if(targets_.begin(), targets_.end(),
                                     [&](const SteeringTarget& t) { return t.name == control.name(); });
    if (target == targets_.end()) {
      problems_.Add(JoinPath(path, "name"), "the scene has no " + what_ + " \"" + control.name().substr(0, 200) + "\"",
                    Known());
    } else if (!read_.insert(control.name()).second) {
      problems_.Add(JoinPath(path, "name"), control.name() + " is named twice", "name each " + what_ + " once");
    }
    const double least = target == targets_.end() ? -kMostFactor : target->least;
    const double most = target == targets_.end() ? kMostFactor : target->most;
    if (!(control.value() >= least && control.value() <= most)) {
      problems_.Add(JoinPath(path, "value"),
                    "must be in [" + Text(least) + ", " + Text(most) + "], is " + Text(control.value()),
                    what_ == "activation" ? "" : "it is a factor on what the scene gives");
    }
    if (target == targets_.end()) return;
    input_.controls.push_back(target->control);
    input_.controls.back().value = control.value();
  }

  std::string Known() const {
    if (targets_.empty()) return "it has none that can be steered";
    constexpr std::size_t kMostNamed = 10;
    std::string names = "it has ";
    for (std::size_t k = 0; k < targets_.size() && k < kMostNamed; ++k)
      names += (k == 0 ? "" : ", ") + targets_[k].name;
    return targets_.size() > kMostNamed ? names + ", ..." : names;
  }

  const std::vector<SteeringTarget>& targets_;
  const std::string path_, what_;
  SteeringInput& input_;
  Problems& problems_;
  std::set<std::string> read_;
};

void CheckTimes(const v1::Scene& scene, const v1::SteeringInput& input, const std::string& path, Problems& problems) {
  if (input.has_at_step() && input.has_at_time()) {
    problems.Add(JoinPath(path, "at_time"), "is given beside at_step", "give one of them");
  }
  if (input.has_at_step() && input.at_step() < 1) {
    problems.Add(JoinPath(path, "at_step"), "must be at least 1", "steps are counted from 1");
  }
  if (input.has_at_time() && !(input.at_time() >= 0 && input.at_time() <= scene.duration())) {
    problems.Add(JoinPath(path, "at_time"), "must be in [0, " + Text(scene.duration()) + "] s",
                 "the scene ends at that time");
  }
}

}  // namespace

SteeringTargets SteeringTargetsOf(const v1::Scene& scene) {
  SteeringTargets targets;
  std::int32_t activation = 0, load = 0, motion = 0;
  for (const v1::Body& body : scene.bodies()) {
    if (!scene.has_voxel()) {
      targets.activations.push_back({body.name(), {ControlKind::kActivation, activation, 0}, 0, 1});
    }
    ++activation;
    RegionTargets parts(body.name(), targets.activations), loads(body.name(), targets.loads),
        motions(body.name(), targets.motions);
    for (int i = 0; i < body.region_activations_size(); ++i) {
      parts.Add(body.region_activations(i).region(), i, {"", {ControlKind::kActivation, activation++, 0}, 0, 1});
    }
    for (int i = 0; i < body.loads_size(); ++i) loads.Add(body.loads(i).region(), i, TargetOf(body.loads(i), load++));
    for (int i = 0; i < body.constraints_size(); ++i, ++motion) {
      if (!Moves(body.constraints(i))) continue;
      motions.Add(body.constraints(i).region(), i, FactorOn(ControlKind::kMotion, motion));
    }
    for (RegionTargets* of_body : {&parts, &loads, &motions}) of_body->Finish();
  }
  // Torques of a skeleton are those of its gravity from the start.
  if (scene.has_gravity() && !scene.has_skeleton()) {
    targets.loads.push_back(FactorOn(ControlKind::kGravity, 0));
    targets.loads.back().name = "gravity";
  }
  for (int k = 0; k < scene.squeezes_size(); ++k) {
    targets.loads.push_back(FactorOn(ControlKind::kForceField, k));
    targets.loads.back().name = "squeezes/" + std::to_string(k);
  }
  return targets;
}

SteeringInput TranslateSteering(const v1::Scene& scene, const std::string& path, v1::SteeringInput& input,
                                Problems& problems) {
  SteeringInput result;
  result.sequence = input.sequence();
  v1::SteeringChanges& changes = *input.mutable_changes();
  const std::string changes_path = JoinPath(path, "changes");
  const int count = changes.activations_size() + changes.loads_size() + changes.motions_size();
  if (count == 0) problems.Add(changes_path, "is empty", "name an activation, a load or a motion");
  if (count > kMostSteered) {
    problems.Add(changes_path, "has more than " + std::to_string(kMostSteered) + " controls", "send several inputs");
    return result;
  }
  const SteeringTargets targets = SteeringTargetsOf(scene);
  ControlReader(targets.activations, changes_path, "activation", result, problems).Read(changes.activations());
  ControlReader(targets.loads, changes_path, "load", result, problems).Read(changes.loads());
  ControlReader(targets.motions, changes_path, "motion", result, problems).Read(changes.motions());
  if (!changes.has_ramp()) changes.set_ramp(scene.output().frame_interval());
  if (!(changes.ramp() >= 0 && changes.ramp() <= kLongestRamp)) {
    problems.Add(JoinPath(changes_path, "ramp"), "must be in [0, " + Text(kLongestRamp) + "] s", "0 is at once");
  }
  result.ramp = changes.ramp();
  CheckTimes(scene, input, path, problems);
  return result;
}

void CheckInputs(v1::Job& job, const std::string& path, Problems& problems) {
  if (job.inputs_size() > kMostInputs) {
    problems.Add(path, "has more than " + std::to_string(kMostInputs) + " inputs");
    return;
  }
  for (int i = 0; i < job.inputs_size(); ++i) {
    const std::string input_path = path + IndexPath("", static_cast<std::size_t>(i));
    if (job.inputs(i).sequence() != i + 1) {
      problems.Add(JoinPath(input_path, "sequence"), "must be " + std::to_string(i + 1), "inputs are counted from 1");
    }
    TranslateSteering(job.scene(), input_path, *job.mutable_inputs(i), problems);
  }
}

std::string EncodeSteering(const v1::SteeringInput& input) {
  v1::SteeringInput stored = input;
  stored.clear_step();
  stored.clear_applied();
  stored.clear_accept_time();
  return stored.SerializeAsString();
}

v1::SteeringInput InputForSpec(const SteeringRecord& record) {
  v1::SteeringInput input;
  if (!input.ParseFromString(record.input)) {
    throw std::runtime_error("the stored input " + std::to_string(record.sequence) + " can't be read");
  }
  if (record.step) input.set_step(*record.step);
  return ReplayedInput(std::move(input));
}

std::vector<SteeringRecord> InputsOfSpec(const std::string& spec) {
  v1::Job job;
  if (!job.ParseFromString(spec)) throw std::runtime_error("the stored job can't be read");
  std::vector<SteeringRecord> records;
  for (const v1::SteeringInput& input : job.inputs()) {
    SteeringRecord& record = records.emplace_back();
    record.sequence = input.sequence();
    if (input.has_at_time()) {
      record.time = input.at_time();
    } else {
      record.step = input.has_at_step() ? input.at_step() : 1;
    }
    record.input = EncodeSteering(input);
  }
  return records;
}

std::vector<SteeringInput> DecodeInputs(const std::string& spec, const std::vector<SteeringRecord>& inputs) {
  v1::Job job;
  if (!job.ParseFromString(spec)) throw std::runtime_error("the stored job can't be read");
  std::vector<SteeringInput> decoded;
  for (const SteeringRecord& record : inputs) {
    v1::SteeringInput input;
    Problems problems;
    if (input.ParseFromString(record.input)) {
      decoded.push_back(TranslateSteering(job.scene(), "", input, problems));
    } else {
      problems.Add("", "can't be read");
    }
    if (!problems.empty()) {
      throw std::runtime_error("the stored input " + std::to_string(record.sequence) + " can't be used:\n" +
                               problems.ToString());
    }
  }
  return decoded;
}

}  // namespace fascicle::server
