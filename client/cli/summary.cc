#include "client/cli/summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

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

Json FailureJson(const v1::Failure& failure) {
  Json json = {
      {"reason", failure.reason()}, {"message", failure.message()}, {"step", failure.step()}, {"time", failure.time()}};
  if (!failure.body().empty()) json["body"] = failure.body();
  if (failure.element_ids_size() > 0) json["element_ids"] = failure.element_ids();
  if (!failure.advice().empty()) json["advice"] = failure.advice();
  return json;
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
  if (job.state() == v1::Job::STATE_QUEUED) json["queue_position"] = job.queue_position();
  if (job.has_create_time()) json["created"] = TimeUtil::ToString(job.create_time());
  if (job.has_start_time()) json["started"] = TimeUtil::ToString(job.start_time());
  if (job.has_end_time()) json["ended"] = TimeUtil::ToString(job.end_time());
  if (job.has_failure()) json["failure"] = FailureJson(job.failure());
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
    const Extremes e = ExtremesOf(column.values);
    series[column.name] = {{"unit", column.unit}, {"final", e.final}, {"min", e.lowest}, {"max", e.highest}};
  }
  json["series"] = std::move(series);
  for (const v1::BodyGeometry& body : followed.geometry.bodies()) {
    for (const std::string& note : body.notes()) json["notes"].push_back(note);
  }
  if (job.has_failure()) json["failure"] = FailureJson(job.failure());
  return json;
}

void PrintFailure(const v1::Failure& failure) {
  std::printf("failure  %s at t = %.6g s, step %lld\n  %s\n", failure.reason().c_str(), failure.time(),
              static_cast<long long>(failure.step()), failure.message().c_str());
  if (!failure.body().empty()) std::printf("  body: %s\n", failure.body().c_str());
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
  if (table.size() == 0) return;
  if (table.frames().front() != 0) {
    std::printf("values of frames %lld to %lld\n", static_cast<long long>(table.frames().front()),
                static_cast<long long>(table.frames().back()));
  }
  int width = 6;
  for (const SeriesTable::Column& column : table.columns())
    width = std::max(width, static_cast<int>(column.name.size()));
  std::printf("%-*s  %-6s %13s %13s %13s\n", width, "series", "unit", "final", "min", "max");
  for (const SeriesTable::Column& column : table.columns()) {
    const Extremes e = ExtremesOf(column.values);
    std::printf("%-*s  %-6s %13.6g %13.6g %13.6g\n", width, column.name.c_str(), column.unit.c_str(), e.final, e.lowest,
                e.highest);
  }
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
