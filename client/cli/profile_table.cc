#include "client/cli/profile_table.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace fascicle::client {
namespace {

// The unaccounted part of a stage gets a line if it is at least this fraction of the whole.
constexpr double kLeastRest = 0.001;

struct Row {
  std::string label;        // indented
  std::int64_t calls = -1;  // negative: none
  double seconds = 0;
};

using Stages = std::vector<v1::Profile::Stage>;

Stages StagesOf(const v1::Profile& profile, bool concurrent) {
  Stages stages;
  for (const v1::Profile::Stage& stage : profile.stages()) {
    if (stage.concurrent() == concurrent) stages.push_back(stage);
  }
  return stages;
}

// Whether `name` is a direct child of `whole`; children of the empty name have no slash.
bool IsPartOf(const std::string& whole, const std::string& name) {
  const std::size_t slash = name.rfind('/');
  return slash == std::string::npos ? whole.empty() : name.compare(0, slash, whole) == 0 && slash == whole.size();
}

double SecondsOfParts(const Stages& stages, const std::string& whole) {
  double sum = 0;
  for (const v1::Profile::Stage& stage : stages) {
    if (IsPartOf(whole, stage.name())) sum += stage.seconds();
  }
  return sum;
}

// Adds rows for the children of a stage, recursively, and for the rest of its time.
void AddRows(const Stages& stages, const v1::Profile::Stage& whole, int depth, double least_rest,
             std::vector<Row>& rows) {
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  for (const v1::Profile::Stage& stage : stages) {
    if (!IsPartOf(whole.name(), stage.name())) continue;
    rows.push_back({indent + stage.name().substr(stage.name().rfind('/') + 1), stage.calls(), stage.seconds()});
    AddRows(stages, stage, depth + 1, least_rest, rows);
  }
  const double parts = SecondsOfParts(stages, whole.name());
  if (parts > 0 && whole.seconds() - parts >= least_rest)
    rows.push_back({indent + "(rest)", -1, whole.seconds() - parts});
}

std::vector<Row> RowsOf(const v1::Profile& profile) {
  v1::Profile::Stage whole;
  whole.set_seconds(profile.wall_seconds());
  std::vector<Row> rows;
  AddRows(StagesOf(profile, false), whole, 0, kLeastRest * profile.wall_seconds(), rows);
  rows.push_back({"whole", profile.runs(), profile.wall_seconds()});
  return rows;
}

std::vector<Row> ConcurrentRowsOf(const v1::Profile& profile) {
  std::vector<Row> rows;
  AddRows(StagesOf(profile, true), {}, 0, kLeastRest * profile.wall_seconds(), rows);
  return rows;
}

std::size_t WidthOf(const std::vector<Row>& rows) {
  std::size_t width = 0;
  for (const Row& row : rows) width = std::max(width, row.label.size());
  return width;
}

void Print(const Row& row, std::size_t width, double wall_seconds) {
  const std::string calls = row.calls < 0 ? "" : std::to_string(row.calls);
  std::printf("%-*s %10s %11.4g %6.1f\n", static_cast<int>(width), row.label.c_str(), calls.c_str(), row.seconds,
              wall_seconds > 0 ? 100 * row.seconds / wall_seconds : 0.0);
}

}  // namespace

void PrintProfile(const v1::Job& job) {
  if (!job.has_profile()) {
    std::printf("%s has no profile yet\n", job.name().c_str());
    return;
  }
  const v1::Profile& profile = job.profile();
  const std::vector<Row> rows = RowsOf(profile), concurrent = ConcurrentRowsOf(profile);
  const std::size_t width = std::max({std::size_t{5}, WidthOf(rows), WidthOf(concurrent)});
  std::printf("%-*s %10s %11s %6s\n", static_cast<int>(width), "stage", "calls", "seconds", "%");
  for (const Row& row : rows) Print(row, width, profile.wall_seconds());
  std::printf("processor time of all threads %.4g s\n", profile.cpu_seconds());
  if (profile.runs() < job.attempt()) {
    std::printf("%d of %d runs; the others were killed before they stored a profile\n", profile.runs(), job.attempt());
  }
  if (concurrent.empty()) return;
  std::printf("meanwhile, in the thread that stores frames:\n");
  for (const Row& row : concurrent) Print(row, width, profile.wall_seconds());
}

Json ProfileJson(const v1::Job& job) {
  if (!job.has_profile()) return nullptr;
  const v1::Profile& profile = job.profile();
  Json json = {
      {"wall_seconds", profile.wall_seconds()}, {"cpu_seconds", profile.cpu_seconds()}, {"runs", profile.runs()}};
  json["rest_seconds"] = profile.wall_seconds() - SecondsOfParts(StagesOf(profile, false), "");
  json["stages"] = Json::array();
  for (const v1::Profile::Stage& stage : profile.stages()) {
    Json entry = {{"name", stage.name()}, {"calls", stage.calls()}, {"seconds", stage.seconds()}};
    if (stage.concurrent()) entry["concurrent"] = true;
    json["stages"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace fascicle::client
