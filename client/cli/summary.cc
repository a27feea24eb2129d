#include "client/cli/summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include <google/protobuf/util/time_util.h>

#include "client/cli/progress_bar.h"

namespace fascicle::client {
namespace {

struct Extremes {
  double final = NAN, lowest = NAN, highest = NAN;
};

Extremes ExtremesOf(const std::vector<double>& values) {
  Extremes extremes;
  for (const double value : values) {
    extremes.final = value;
    extremes.lowest = std::fmin(extremes.lowest, value);  // ignores NaN
    extremes.highest = std::fmax(extremes.highest, value);
  }
  return extremes;
}

// The object of a failure. Older servers sent a body's name only.
struct FailedObject {
  std::string kind;  // for users; empty if it is not a particular one
  std::string name;
};

FailedObject ObjectOf(const v1::Failure& failure) {
  switch (failure.object_kind()) {
    case v1::Failure::OBJECT_KIND_BODY:
      return {"body", failure.object()};
    case v1::Failure::OBJECT_KIND_RIGID_BODY:
      return {"rigid body", failure.object()};
    case v1::Failure::OBJECT_KIND_LINE:
      return {"line", failure.object()};
    case v1::Failure::OBJECT_KIND_JOINT:
      return {"joint", failure.object()};
    case v1::Failure::OBJECT_KIND_UNSPECIFIED:
      if (!failure.body().empty()) return {"body", failure.body()};
      return {};
    default:  // of a newer server
      return {"object", failure.object()};
  }
}

Json FailureJson(const v1::Failure& failure) {
  Json json = {
      {"reason", failure.reason()}, {"message", failure.message()}, {"step", failure.step()}, {"time", failure.time()}};
  const FailedObject object = ObjectOf(failure);
  if (!object.kind.empty()) json["object"] = {{"kind", object.kind}, {"name", object.name}};
  if (!failure.body().empty()) json["body"] = failure.body();
  if (failure.element_ids_size() > 0) json["element_ids"] = failure.element_ids();
  if (!failure.advice().empty()) json["advice"] = failure.advice();
  return json;
}

Json WarningsJson(const v1::Job& job) {
  Json warnings = Json::array();
  for (const v1::Warning& warning : job.warnings()) {
    Json json = {{"reason", warning.reason()}, {"message", warning.message()}, {"time", warning.time()}};
    if (!warning.body().empty()) json["body"] = warning.body();
    if (warning.element_ids_size() > 0) json["element_ids"] = warning.element_ids();
    if (!warning.advice().empty()) json["advice"] = warning.advice();
    warnings.push_back(std::move(json));
  }
  return warnings;
}

std::vector<std::string> NamesOfRigidBodies(const v1::Geometry& geometry, bool moving) {
  std::vector<std::string> names;
  for (const v1::RigidBodyGeometry& body : geometry.rigid_bodies()) {
    if (body.moves() == moving) names.push_back(body.name());
  }
  return names;
}

std::vector<std::string> NamesOfLines(const v1::Geometry& geometry) {
  std::vector<std::string> names;
  for (const v1::LineGeometry& line : geometry.lines()) names.push_back(line.name());
  return names;
}

// Prints nothing if there are no names.
void PrintNames(const char* what, const std::vector<std::string>& names) {
  if (names.empty()) return;
  std::printf("%s ", what);
  for (const std::string& name : names) std::printf(" %s", name.c_str());
  std::printf("\n");
}

// Final, lowest and highest value of every series.
void PrintSeries(const SeriesTable& table) {
  if (table.frames().front() != 0) {
    std::printf("values of frames %lld to %lld\n", static_cast<long long>(table.frames().front()),
                static_cast<long long>(table.frames().back()));
  }
  int width = 6;
  for (const SeriesTable::Column& column : table.columns()) {
    if (!column.is_pose) width = std::max(width, static_cast<int>(column.name.size()));
  }
  std::printf("%-*s  %-6s %13s %13s %13s\n", width, "series", "unit", "final", "min", "max");
  for (const SeriesTable::Column& column : table.columns()) {
    if (column.is_pose) continue;
    const Extremes e = ExtremesOf(column.values);
    std::printf("%-*s  %-6s %13.6g %13.6g %13.6g\n", width, column.name.c_str(), column.unit.c_str(), e.final, e.lowest,
                e.highest);
  }
}

double WallSeconds(const v1::Job& job) {
  using google::protobuf::util::TimeUtil;
  if (!job.has_start_time() || !job.has_end_time()) return NAN;
  return 1e-3 * static_cast<double>(TimeUtil::DurationToMilliseconds(job.end_time() - job.start_time()));
}

}  // namespace

Json JobJson(const v1::Job& job) {
  using google::protobuf::util::TimeUtil;
  Json json = {{"job", job.name()},
               {"scene", job.scene_name()},
               {"state", StateName(job.state())},
               {"frames", job.frame_count()},
               {"fraction", job.progress().fraction()},
               {"time", job.progress().time()},
               {"steps", job.progress().step()},
               {"threads", job.threads()},
               {"attempt", job.attempt()},
               {"stored_bytes", job.stored_bytes()}};
  if (job.threads_in_use() > 0) json["threads_in_use"] = job.threads_in_use();
  if (job.first_frame() > 0) json["first_frame"] = job.first_frame();
  if (!job.owner().empty()) json["owner"] = job.owner();
  if (job.priority() != 0) json["priority"] = job.priority();
  for (const auto& [key, value] : std::map<std::string, std::string>(job.labels().begin(), job.labels().end()))
    json["labels"][key] = value;
  if (job.ttl().seconds() > 0) json["ttl_seconds"] = job.ttl().seconds();
  if (job.pinned()) json["pinned"] = true;
  if (job.state() == v1::Job::STATE_QUEUED) json["queue_position"] = job.queue_position();
  if (job.has_create_time()) json["created"] = TimeUtil::ToString(job.create_time());
  if (job.has_start_time()) json["started"] = TimeUtil::ToString(job.start_time());
  if (job.has_end_time()) json["ended"] = TimeUtil::ToString(job.end_time());
  if (job.has_failure()) json["failure"] = FailureJson(job.failure());
  if (job.warnings_size() > 0) json["warnings"] = WarningsJson(job);
  if (job.has_imported()) {
    json["imported"] = {{"job", job.imported().original_name()}, {"time", TimeUtil::ToString(job.imported().time())}};
  }
  return json;
}

Json SummaryJson(const Followed& followed) {
  const v1::Job& job = followed.job;
  const SeriesTable& table = followed.table;
  Json json = {{"job", job.name()}, {"state", StateName(job.state())}, {"frames", job.frame_count()}};
  if (table.size() > 0) {
    json["time"] = table.times().back();
    json["steps"] = table.steps().back();
    json["first_frame"] = table.frames().front();
  }
  const double wall = WallSeconds(job);
  if (std::isfinite(wall)) json["wall_seconds"] = wall;
  Json series = Json::object();
  for (const SeriesTable::Column& column : table.columns()) {
    if (column.is_pose) continue;
    const Extremes e = ExtremesOf(column.values);
    series[column.name] = {{"unit", column.unit}, {"final", e.final}, {"min", e.lowest}, {"max", e.highest}};
  }
  json["series"] = std::move(series);
  for (const v1::BodyGeometry& body : followed.geometry.bodies()) {
    for (const std::string& note : body.notes()) json["notes"].push_back(note);
  }
  for (const std::string& note : followed.geometry.notes()) json["notes"].push_back(note);
  for (const v1::RigidBodyGeometry& body : followed.geometry.rigid_bodies()) {
    json["rigid_bodies"].push_back({{"name", body.name()}, {"moves", body.moves()}});
  }
  for (const v1::LineGeometry& line : followed.geometry.lines()) json["lines"].push_back(line.name());
  if (job.has_failure()) json["failure"] = FailureJson(job.failure());
  if (job.warnings_size() > 0) json["warnings"] = WarningsJson(job);
  return json;
}

void PrintWarnings(const v1::Job& job) {
  for (const v1::Warning& warning : job.warnings()) {
    std::printf("warning  %s", warning.reason().c_str());
    if (!warning.body().empty()) std::printf(", %s", warning.body().c_str());
    std::printf(", t = %.6g s: %s\n", warning.time(), warning.message().c_str());
    if (!warning.advice().empty()) std::printf("  try: %s\n", warning.advice().c_str());
  }
}

void PrintState(const v1::Job& job, bool json) {
  if (json) return PrintJson(JobJson(job));
  std::cout << job.name() << "  " << StateName(job.state()) << '\n';
}

void PrintFailure(const v1::Failure& failure) {
  std::printf("failure  %s at t = %.6g s, step %lld\n  %s\n", failure.reason().c_str(), failure.time(),
              static_cast<long long>(failure.step()), failure.message().c_str());
  const FailedObject object = ObjectOf(failure);
  if (!object.kind.empty()) std::printf("  %s: %s\n", object.kind.c_str(), object.name.c_str());
  if (failure.element_ids_size() > 0) {
    std::printf("  elements:");
    for (const std::int64_t id : failure.element_ids()) std::printf(" %lld", static_cast<long long>(id));
    std::printf("\n");
  }
  if (!failure.advice().empty()) std::printf("  try: %s\n", failure.advice().c_str());
}

void PrintSummary(const Followed& followed) {
  const v1::Job& job = followed.job;
  const SeriesTable& table = followed.table;
  std::printf("%s  %s  %lld frames", job.name().c_str(), StateName(job.state()).c_str(),
              static_cast<long long>(job.frame_count()));
  if (table.size() > 0) {
    std::printf(", t = %.6g s, %lld steps", table.times().back(), static_cast<long long>(table.steps().back()));
  }
  const double wall = WallSeconds(job);
  if (std::isfinite(wall)) std::printf(", wall time %.3g s", wall);
  std::printf("\n");
  if (job.has_failure()) PrintFailure(job.failure());
  for (const v1::BodyGeometry& body : followed.geometry.bodies()) {
    for (const std::string& note : body.notes()) std::printf("note  %s\n", note.c_str());
  }
  for (const std::string& note : followed.geometry.notes()) std::printf("note  %s\n", note.c_str());
  PrintNames("rigid bodies that move", NamesOfRigidBodies(followed.geometry, true));
  PrintNames("rigid bodies that stay", NamesOfRigidBodies(followed.geometry, false));
  PrintNames("lines", NamesOfLines(followed.geometry));
  if (table.size() > 0) PrintSeries(table);
  PrintWarnings(job);
}

int ExitCodeOf(const v1::Job& job) {
  switch (job.state()) {
    case v1::Job::STATE_FAILED:
      return kJobFailed;
    case v1::Job::STATE_CANCELLED:
    case v1::Job::STATE_CANCELLING:
      return kCancelled;
    default:
      return kDone;
  }
}

}  // namespace fascicle::client
