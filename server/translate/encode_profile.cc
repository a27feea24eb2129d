#include <algorithm>
#include <string>
#include <vector>

#include "server/jobs/job_manager.h"
#include "server/translate/translate.h"

namespace fascicle::server {
namespace {

using Stages = google::protobuf::RepeatedPtrField<v1::Profile::Stage>;

// The stage with this name, or a new one inserted after its parent and all of the parent's descendants.
v1::Profile::Stage& FindOrInsert(const std::string& name, bool concurrent, Stages& stages) {
  const auto same = [&](const v1::Profile::Stage& stage) {
    return stage.name() == name && stage.concurrent() == concurrent;
  };
  if (const auto found = std::find_if(stages.begin(), stages.end(), same); found != stages.end()) return *found;
  const std::string whole = name.substr(0, name.rfind('/') + 1);  // name of the parent, with the slash; may be empty
  const auto part = [&](const v1::Profile::Stage& stage) {
    return stage.concurrent() == concurrent && (stage.name() + "/").starts_with(whole);
  };
  int place = stages.size();
  while (place > 0 && !part(stages[place - 1])) --place;
  if (place == 0) place = stages.size();
  stages.Add();
  std::rotate(stages.begin() + place, stages.end() - 1, stages.end());
  stages[place].set_name(name);
  stages[place].set_concurrent(concurrent);
  return stages[place];
}

void Add(const std::vector<ProfileStage>& stages, bool concurrent, v1::Profile& sum) {
  for (const ProfileStage& stage : stages) {
    v1::Profile::Stage& target = FindOrInsert(stage.name, concurrent, *sum.mutable_stages());
    target.set_calls(target.calls() + stage.calls);
    target.set_seconds(target.seconds() + stage.seconds);
  }
}

}  // namespace

v1::Profile EncodeProfileOfCheck(const Profile& profile) {
  v1::Profile sum;
  sum.set_wall_seconds(profile.wall_seconds());
  sum.set_cpu_seconds(profile.cpu_seconds());
  Add(profile.Stages(), false, sum);
  return sum;
}

v1::Profile EncodeProfile(const RunProfile& profile) {
  v1::Profile sum;
  if (!sum.ParseFromString(profile.earlier)) sum.Clear();
  sum.set_runs(sum.runs() + 1);
  sum.set_wall_seconds(sum.wall_seconds() + profile.working.wall_seconds());
  sum.set_cpu_seconds(sum.cpu_seconds() + profile.working.cpu_seconds() + profile.storing.cpu_seconds());
  Add(profile.working.Stages(), false, sum);
  Add(profile.storing.Stages(), true, sum);
  return sum;
}

}  // namespace fascicle::server
