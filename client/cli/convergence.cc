#include "client/cli/convergence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include <nlohmann/json.hpp>

#include "client/cli/progress_bar.h"
#include "client/cli/summary.h"
#include "proto/rules/field_rules.h"

namespace fascicle::client {
namespace {

constexpr double kWorthMentioning = 0.01;  // relative change
constexpr int kMostRefinements = 3;        // the range in scene.proto

bool IsExplicit(v1::Stepping stepping) {
  return stepping == v1::STEPPING_UNSPECIFIED || stepping == v1::STEPPING_EXPLICIT || stepping == v1::STEPPING_MIXED;
}

void HalveStep(v1::TetMethod& method, double frame_interval) {
  if (method.has_time_step()) {
    method.set_time_step(method.time_step() / 2);
  } else if (IsExplicit(method.stepping())) {
    FillDefaults(method);
    method.set_safety(method.safety() / 2);
  } else {
    method.set_time_step(frame_interval / 2);
  }
}

// The quantity to which a column belongs: `muscle/reaction/end/x` and `.../y` are components of one.
std::string QuantityOf(const SeriesTable::Column& column) {
  return column.name.substr(0, column.name.rfind('/')) + " [" + column.unit + "]";
}

double LargestOf(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::fmax(largest, std::fabs(value));  // ignores NaN
  return largest;
}

// Moments and energies have the same dimension. Moments that vanish by symmetry are small beside energies.
const std::string& DimensionOf(const SeriesTable::Column& column) {
  static const std::string joule = "J";
  return column.unit == "N m" ? joule : column.unit;
}

// The largest absolute value of each quantity, at least a millionth of the largest with its dimension.
std::map<std::string, double> ScalesOf(const SeriesTable& table) {
  constexpr double kNegligible = 1e-6;
  std::map<std::string, double> of_quantity, of_dimension;
  for (const SeriesTable::Column& column : table.columns()) {
    double& quantity = of_quantity[QuantityOf(column)];
    quantity = std::fmax(quantity, LargestOf(column.values));
    double& dimension = of_dimension[DimensionOf(column)];
    dimension = std::fmax(dimension, quantity);
  }
  for (const SeriesTable::Column& column : table.columns()) {
    double& quantity = of_quantity[QuantityOf(column)];
    quantity = std::fmax(quantity, kNegligible * of_dimension[DimensionOf(column)]);
  }
  return of_quantity;
}

const SeriesChange* LargestChange(const std::vector<SeriesChange>& changes) {
  const auto largest = std::max_element(changes.begin(), changes.end(),
                                        [](const auto& a, const auto& b) { return a.relative < b.relative; });
  return largest == changes.end() ? nullptr : &*largest;
}

void PrintChanges(const CheckedRun& run) {
  std::printf("\n%s", run.what.c_str());
  if (run.job.has_failure()) {
    std::printf("\n");
    PrintFailure(run.job.failure());
  }
  const SeriesChange* largest = LargestChange(run.changes);
  if (largest == nullptr) {
    std::printf(": no result to compare\n");
    return;
  }
  std::printf(": changes at most %.3g %% (%s)\n", 100 * largest->relative, largest->name.c_str());
  int width = 6;
  for (const SeriesChange& change : run.changes) width = std::max(width, static_cast<int>(change.name.size()));
  std::printf("%-*s  %-6s %13s %13s %9s\n", width, "series", "unit", "final", "with it", "change");
  for (const SeriesChange& change : run.changes) {
    std::printf("%-*s  %-6s %13.6g %13.6g %7.3g %%\n", width, change.name.c_str(), change.unit.c_str(), change.before,
                change.after, 100 * change.relative);
  }
  if (largest->relative > kWorthMentioning) {
    std::printf("  the answer is not converged: run with %s and check again\n", run.what.c_str());
  }
}

}  // namespace

std::optional<v1::Scene> WithHalfStep(const v1::Scene& scene, std::int64_t steps) {
  v1::Scene half = scene;
  const double frame_interval = scene.output().frame_interval();
  if (scene.has_voxel()) {
    v1::VoxelMethod& method = *half.mutable_voxel();
    if (method.stepping() != v1::VOXEL_STEPPING_DYNAMIC) return std::nullopt;
    method.set_time_step((method.has_time_step() ? method.time_step() : frame_interval) / 2);
  } else if (scene.has_eulerian()) {
    v1::EulerianMethod& method = *half.mutable_eulerian();
    const double mean = scene.duration() / static_cast<double>(std::max<std::int64_t>(steps, 1));
    method.set_time_step((method.has_time_step() ? std::min(method.time_step(), mean) : mean) / 2);
  } else {
    HalveStep(*half.mutable_tet(), frame_interval);
  }
  return half;
}

std::optional<v1::Scene> WithHalfMeshSize(const v1::Scene& scene) {
  // A frame from which the scene starts belongs to its mesh.
  if (scene.refinements() >= kMostRefinements || scene.start().has_frame()) return std::nullopt;
  v1::Scene half = scene;
  half.set_refinements(scene.refinements() + 1);
  return half;
}

std::vector<SeriesChange> ChangesBetween(const SeriesTable& before, const SeriesTable& after) {
  const std::map<std::string, double> scales = ScalesOf(before);
  const std::size_t frames = std::min(before.size(), after.size());
  std::vector<SeriesChange> changes;
  for (std::size_t c = 0; c < before.columns().size() && frames > 0; ++c) {
    const SeriesTable::Column &a = before.columns()[c], &b = after.columns()[c];
    if (a.is_pose || a.name.starts_with("solver/")) continue;
    SeriesChange change = {a.name, a.unit, a.values[frames - 1], b.values[frames - 1]};
    double largest = 0;
    for (std::size_t f = 0; f < frames; ++f) largest = std::fmax(largest, std::fabs(b.values[f] - a.values[f]));
    const double scale = scales.at(QuantityOf(a));
    if (scale > 0) change.relative = largest / scale;
    changes.push_back(std::move(change));
  }
  return changes;
}

void PrintCheck(const std::vector<CheckedRun>& runs) {
  for (const CheckedRun& run : runs) PrintChanges(run);
}

Json CheckJson(const std::vector<CheckedRun>& runs) {
  Json json = Json::array();
  for (const CheckedRun& run : runs) {
    Json series = Json::object();
    for (const SeriesChange& change : run.changes) {
      series[change.name] = {{"unit", change.unit}, {"final", change.after}, {"relative_change", change.relative}};
    }
    Json entry = {{"with", run.what}, {"state", StateName(run.job.state())}, {"series", std::move(series)}};
    if (const SeriesChange* largest = LargestChange(run.changes)) {
      entry["largest_change"] = {{"series", largest->name}, {"relative_change", largest->relative}};
    }
    json.push_back(std::move(entry));
  }
  return json;
}

}  // namespace fascicle::client
