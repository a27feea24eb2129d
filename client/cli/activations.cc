#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/interrupts.h"
#include "client/cli/outputs.h"
#include "client/cli/skeleton_run.h"
#include "client/export/csv.h"
#include "client/lib/replace_file.h"
#include "core/base/letters.h"

namespace fascicle::client {
namespace {

constexpr const char* kActivationsExamples =
    R"(  fascicle examples write upper_arm                      a scene to try the lines below with
  fascicle activations upper_arm.json                    a table: times, joint torques, activations, forces
  fascicle activations upper_arm.json --csv arm.csv --out arm.png
  fascicle activations upper_arm.json --set 'skeleton.drive.distribution.at_rest=true' --csv rest.csv
  fascicle activations upper_arm.json --json             one object per series: series, unit, time, values

The scene's skeleton moves as the scene says, without its bodies; rows are the scene's frames. `torque` is what
a joint needs, `muscle_torque` what the muscles exert with their activations.
)";

struct ActivationsOptions {
  SceneArgument scene;
  std::string csv, out;
};

// What the table has of a run.
const std::vector<std::string>& ShownSeries() {
  static const std::vector<std::string> globs = {
      "skeleton/*/angle",         "skeleton/*/distance",     "skeleton/*/torque", "skeleton/*/force",
      "skeleton/*/muscle_torque", "skeleton/*/muscle_force", "*/activation"};
  return globs;
}

std::vector<const SeriesTable::Column*> ShownColumns(const SeriesTable& table) {
  std::vector<const SeriesTable::Column*> columns;
  for (const SeriesTable::Column& column : table.columns()) {
    for (const std::string& glob : ShownSeries()) {
      if (!MatchesGlob(glob, column.name)) continue;
      columns.push_back(&column);
      break;
    }
  }
  return columns;
}

std::string TableOf(const SeriesTable& table) {
  std::vector<CsvColumn> columns = {{"time [s]", table.times()}};
  for (const SeriesTable::Column* column : ShownColumns(table)) {
    columns.push_back({column->name + " [" + column->unit + "]", column->values});
  }
  return CsvOf(columns);
}

// The shown series that exist, for a plot.
std::vector<std::string> PlottedNames(const SeriesTable& table) {
  std::vector<std::string> names;
  for (const SeriesTable::Column* column : ShownColumns(table)) names.push_back(column->name);
  return names;
}

int Activations(const ActivationsOptions& options, const Context& context) {
  if (!options.out.empty() && LowerExtension(options.out) != ".png") {
    throw CommandError::Invalid("--out: plots are written as PNG: the name must end in .png");
  }
  const ScenePackage package = SkeletonOf(LoadSceneOrFail(options.scene));
  const StopOnInterrupt interrupts;
  SkeletonRuns runs(interrupts.token());
  const Followed followed = runs.Run(package);
  PrintNotes(followed);
  const SeriesTable& table = followed.table;
  if (!options.csv.empty()) ReplaceFile(options.csv, TableOf(table));
  if (!options.out.empty()) WritePlot(PanelsOf(table, PlottedNames(table)), options.out);
  if (context.json) {
    for (const SeriesTable::Column* column : ShownColumns(table)) {
      PrintJson(
          {{"series", column->name}, {"unit", column->unit}, {"time", table.times()}, {"values", column->values}});
    }
  } else if (options.csv.empty()) {
    std::cout << TableOf(table);
  }
  return kDone;
}

}  // namespace

void AddActivations(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "activations", "Joint torques and muscle activations of a scene's skeleton",
                                 kActivationsExamples);
  const auto options = std::make_shared<ActivationsOptions>();
  AddSceneArgument(*command, options->scene);
  command->add_option("--csv", options->csv, "Write the table to a file")->type_name("FILE.csv");
  command->add_option("--out", options->out, "Draw the series")->type_name("FILE.png");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Activations(*options, context); }; });
}

}  // namespace fascicle::client
