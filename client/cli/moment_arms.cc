#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/interrupts.h"
#include "client/cli/outputs.h"
#include "client/cli/skeleton_run.h"
#include "client/lib/replace_file.h"
#include "core/base/letters.h"

namespace fascicle::client {
namespace {

constexpr const char* kMomentArmsExamples =
    R"(  fascicle examples write upper_arm                  a scene to try the lines below with
  fascicle moment-arms upper_arm.json                a table over the range of each coordinate
  fascicle moment-arms upper_arm.json --coordinate elbow --points 131 --csv elbow.csv --out elbow.png
  fascicle moment-arms upper_arm.json --set 'skeleton.coordinates[0].value=0.5'   in another pose of the others
  fascicle moment-arms upper_arm.json --json         one object per coordinate and muscle

Each coordinate that has a `range` goes through it while the others keep their `value`. A moment arm is -dL/dq, positive
where the muscle's tension increases the coordinate; muscles that do not cross the joint are left out.
)";

struct MomentArmsOptions {
  SceneArgument scene;
  std::vector<std::string> coordinates;
  int points = 91;
  std::string csv, out;
};

// Moment arms of a muscle about a coordinate.
struct ArmCurve {
  std::string coordinate, muscle;
  std::string unit;  // of the coordinate
  std::vector<double> values, arms, lengths;
};

// The coordinates to go through; CommandError with all problems.
std::vector<const v1::Coordinate*> ChosenCoordinates(const v1::Skeleton& skeleton, const MomentArmsOptions& options) {
  Problems problems;
  std::vector<const v1::Coordinate*> chosen;
  for (const std::string& name : options.coordinates) {
    const auto found = std::find_if(skeleton.coordinates().begin(), skeleton.coordinates().end(),
                                    [&](const v1::Coordinate& c) { return c.name() == name; });
    if (found == skeleton.coordinates().end()) {
      std::string known;
      for (const v1::Coordinate& c : skeleton.coordinates()) known += (known.empty() ? "" : ", ") + c.name();
      problems.Add("--coordinate " + name, "there is no such coordinate", "known: " + known.substr(0, 400));
    } else if (found->range_size() != 2) {
      problems.Add(
          "--coordinate " + name, "has no range",
          "--set 'skeleton.coordinates[" + std::to_string(found - skeleton.coordinates().begin()) + "].range=[-1, 1]'");
    } else {
      chosen.push_back(&*found);
    }
  }
  if (options.coordinates.empty()) {
    for (const v1::Coordinate& coordinate : skeleton.coordinates()) {
      if (coordinate.range_size() == 2 && !coordinate.locked()) chosen.push_back(&coordinate);
    }
    if (chosen.empty()) problems.Add("skeleton.coordinates", "none has a range", "give a coordinate its `range`");
  }
  if (skeleton.muscles().empty()) problems.Add("skeleton.muscles", "is empty", "moment arms are those of muscles");
  if (!problems.empty()) {
    throw CommandError(Error{Error::Kind::kInvalid, "there are no moment arms", "INVALID_ARGUMENT", problems});
  }
  return chosen;
}

// The scene in which one coordinate goes through its range.
ScenePackage Through(const ScenePackage& package, const v1::Coordinate& coordinate, int points) {
  ScenePackage through = package;
  v1::Skeleton& skeleton = *through.scene.mutable_skeleton();
  skeleton.clear_motion();
  skeleton.clear_drive();
  v1::CoordinateKeys& keys = *skeleton.mutable_motion()->add_coordinates();
  keys.set_coordinate(coordinate.name());
  keys.add_times(0);
  keys.add_times(1);
  keys.add_values(coordinate.range(0));
  keys.add_values(coordinate.range(1));
  keys.set_curve(v1::KEY_CURVE_SPLINE);  // straight between two keys
  for (v1::Coordinate& other : *skeleton.mutable_coordinates()) {
    if (other.name() == coordinate.name()) other.clear_locked();
  }
  through.scene.set_duration(1);
  through.scene.mutable_output()->set_frame_interval(1.0 / (points - 1));
  return through;
}

const SeriesTable::Column* Find(const SeriesTable& table, const std::string& name) {
  const auto found = std::find_if(table.columns().begin(), table.columns().end(),
                                  [&](const SeriesTable::Column& column) { return column.name == name; });
  return found == table.columns().end() ? nullptr : &*found;
}

void AddCurves(const SeriesTable& table, const v1::Skeleton& skeleton, const std::string& coordinate,
               std::vector<ArmCurve>& curves) {
  const SeriesTable::Column* value = Find(table, "skeleton/" + coordinate + "/angle");
  if (value == nullptr) value = Find(table, "skeleton/" + coordinate + "/distance");
  for (const v1::LineMuscle& muscle : skeleton.muscles()) {
    const auto* arm = Find(table, "skeleton/" + muscle.name() + "/moment_arm/" + coordinate);
    if (arm == nullptr) continue;
    curves.push_back({coordinate, muscle.name(), value->unit, value->values, arm->values,
                      Find(table, muscle.name() + "/length")->values});
  }
}

std::string TableOf(const std::vector<ArmCurve>& curves) {
  std::string text = "coordinate,value [rad or m],muscle,moment_arm [m or 1],length [m]\n";
  char line[120];
  for (const ArmCurve& curve : curves) {
    for (std::size_t k = 0; k < curve.values.size(); ++k) {
      std::snprintf(line, sizeof line, ",%.17g,", curve.values[k]);
      text += curve.coordinate + line + curve.muscle;
      std::snprintf(line, sizeof line, ",%.17g,%.17g\n", curve.arms[k], curve.lengths[k]);
      text += line;
    }
  }
  return text;
}

std::vector<PlotPanel> ArmPanels(const std::vector<ArmCurve>& curves) {
  std::vector<PlotPanel> panels;
  for (const ArmCurve& curve : curves) {
    if (panels.empty() || panels.back().title != curve.coordinate) {
      const bool angle = curve.unit == "rad";
      panels.push_back({curve.coordinate,
                        curve.coordinate + " [" + curve.unit + "]",
                        angle ? "moment arm [mm]" : "moment arm [1]",
                        {}});
    }
    PlotLine line{curve.muscle, curve.values, curve.arms, false};
    if (curve.unit == "rad") {
      for (double& arm : line.y) arm *= 1e3;
    }
    panels.back().lines.push_back(std::move(line));
  }
  return panels;
}

int MomentArms(const MomentArmsOptions& options, const Context& context) {
  if (!options.out.empty() && LowerExtension(options.out) != ".png") {
    throw CommandError::Invalid("--out: plots are written as PNG: the name must end in .png");
  }
  const ScenePackage package = SkeletonOf(LoadSceneOrFail(options.scene));
  const v1::Skeleton& skeleton = package.scene.skeleton();
  const std::vector<const v1::Coordinate*> coordinates = ChosenCoordinates(skeleton, options);
  const StopOnInterrupt interrupts;
  SkeletonRuns runs(interrupts.token());
  std::vector<ArmCurve> curves;
  for (const v1::Coordinate* coordinate : coordinates) {
    AddCurves(runs.Run(Through(package, *coordinate, options.points)).table, skeleton, coordinate->name(), curves);
  }
  if (!options.csv.empty()) ReplaceFile(options.csv, TableOf(curves));
  if (!options.out.empty()) WritePlot(ArmPanels(curves), options.out);
  if (context.json) {
    for (const ArmCurve& curve : curves) {
      PrintJson({{"coordinate", curve.coordinate},
                 {"unit", curve.unit},
                 {"muscle", curve.muscle},
                 {"value", curve.values},
                 {"moment_arm", curve.arms},
                 {"length", curve.lengths}});
    }
  } else if (options.csv.empty()) {
    std::cout << TableOf(curves);
  }
  return kDone;
}

}  // namespace

void AddMomentArms(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "moment-arms", "Moment arms and lengths of muscles over the range of each joint",
                                 kMomentArmsExamples);
  const auto options = std::make_shared<MomentArmsOptions>();
  AddSceneArgument(*command, options->scene);
  command->add_option("--coordinate", options->coordinates, "Only this coordinate; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command->add_option("--points", options->points, "Values of each coordinate")->check(CLI::Range(2, 10000));
  command->add_option("--csv", options->csv, "Write the table to a file")->type_name("FILE.csv");
  command->add_option("--out", options->out, "Draw the moment arms")->type_name("FILE.png");
  command->callback(
      [options, &context] { context.action = [options, &context] { return MomentArms(*options, context); }; });
}

}  // namespace fascicle::client
