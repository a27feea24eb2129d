#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "client/cli/input_file.h"
#include "client/cli/job_source.h"
#include "client/cli/outputs.h"
#include "client/cli/units.h"
#include "client/export/architecture.h"
#include "client/export/csv.h"
#include "client/export/read_series.h"
#include "client/export/sample.h"
#include "client/lib/replace_file.h"
#include "core/base/vector_text.h"

namespace fascicle::client {
namespace {

constexpr const char* kSampleExamples =
    R"(  fascicle sample 3f2a --line 0,0,0:0,0,0.12:50                    all fields along a line, at the last frame
  fascicle sample 3f2a --line 0,0,0:0,0,120:50 --unit mm --fields 'principal_*' --out line.csv --plot line.png
  fascicle sample 3f2a --points electrodes.csv --frames all --deformed
  fascicle sample 3f2a --region insertion --frames all --out insertion.csv    mean, extremes and integral
  fascicle sample out --region muscle/belly --json                 frames in a folder that `run --out` or `export` wrote
  fascicle sample out --sections 0,0,1:20 --plot sections.png      areas of cross-sections along an axis
  fascicle sample out --fibres --frames all --deformed             volume, length of fibres, pennation, PCSA

Points are those of the bodies at rest; with --deformed they are points of space. Nodal fields are interpolated within
the element that contains a point, fields of elements are that element's. Outside of all bodies cells are empty.
Fibres are traced through the elements from points that represent equal parts of the volume. The physiological
cross-section (PCSA) adds up each fibre's part of the volume times the cosine of its pennation over its length.
A region is sampled over the elements inside of it, weighted by volume, or else over its faces, weighted by area.
)";

struct SampleOptions {
  std::string source;
  std::string line, points, region, sections, line_of_action;
  bool fibres = false;
  std::string frames = "last";
  std::vector<std::string> fields;
  std::string unit = "m";
  bool deformed = false;
  std::string out, plot;
};

std::optional<double> NumberIn(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<std::string> SplitAt(char separator, const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

// X,Y,Z and further columns, which are ignored.
std::optional<Vec3> PointIn(const std::string& text) {
  const std::vector<std::string> parts = SplitAt(',', text);
  if (parts.size() < 3) return std::nullopt;
  Vec3 point;
  for (int d = 0; d < 3; ++d) {
    const std::optional<double> value = NumberIn(parts[static_cast<std::size_t>(d)]);
    if (!value) return std::nullopt;
    point[d] = *value;
  }
  return point;
}

// Equidistant points from one end to the other [m].
std::vector<Vec3> PointsOfLine(const SampleOptions& options) {
  constexpr double kMostPoints = 100'000;
  const std::vector<std::string> parts = SplitAt(':', options.line);
  const std::optional<Vec3> from = parts.size() == 3 ? PointIn(parts[0]) : std::nullopt;
  const std::optional<Vec3> to = parts.size() == 3 ? PointIn(parts[1]) : std::nullopt;
  const std::optional<double> count = parts.size() == 3 ? NumberIn(parts[2]) : std::nullopt;
  if (!from || !to || !count || !(*count >= 2) || !(*count <= kMostPoints) || *count != std::floor(*count)) {
    throw CommandError::Invalid("--line: expects X,Y,Z:X,Y,Z:N, two points and 2 to 100000 places, such as " +
                                std::string("0,0,0:0,0,0.12:50"));
  }
  std::vector<Vec3> points;
  for (int i = 0; i < static_cast<int>(*count); ++i) {
    points.emplace_back(MetresIn(options.unit) * (*from + i / (*count - 1) * (*to - *from)));
  }
  return points;
}

// The first three columns of a CSV file [m]; a first line that is not numbers is a header.
std::vector<Vec3> PointsOfFile(const SampleOptions& options) {
  Problems problems;
  const std::optional<std::string> text = ReadInputFile(options.points, problems);
  if (!text) throw CommandError::Invalid("--points: " + options.points + ": " + problems.kept().front().message);
  std::vector<Vec3> points;
  const std::vector<std::string> lines = SplitAt('\n', *text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::optional<Vec3> point = PointIn(lines[i]);
    if (!point && i == 0) continue;
    if (!point) {
      throw CommandError::Invalid("--points: " + options.points + ", line " + std::to_string(i + 1) +
                                  ": expects three numbers x,y,z separated by commas");
    }
    points.emplace_back(MetresIn(options.unit) * *point);
  }
  if (points.empty()) throw CommandError::Invalid("--points: " + options.points + " has no points");
  return points;
}

// `last`, `all`, or numbers separated by commas; `count` frames exist, numbered from 0.
std::vector<std::int64_t> ChosenFrames(const std::string& text, std::int64_t count) {
  std::vector<std::int64_t> frames;
  if (text == "last") return {count - 1};
  for (std::int64_t k = 0; text == "all" && k < count; ++k) frames.push_back(k);
  if (text == "all") return frames;
  for (const std::string& part : SplitAt(',', text)) {
    const std::optional<double> number = NumberIn(part);
    if (!number || *number != std::floor(*number) || *number < 0 || !(*number < static_cast<double>(count))) {
      throw CommandError::Invalid("--frames: expects `last`, `all`, or numbers from 0 to " + std::to_string(count - 1) +
                                  " separated by commas");
    }
    frames.push_back(static_cast<std::int64_t>(*number));
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

// Calls call(snapshot) for each chosen frame, in order.
template <class Call>
void ForSnapshots(const SampleOptions& options, const Context& context, const Call& call) {
  if (std::filesystem::is_directory(options.source) && !IsJobFolder(options.source)) {
    if (!HasSeries(options.source)) {
      throw CommandError::Invalid(options.source + " has no frames.pvd; give a job, or a folder that `fascicle run " +
                                  "--out` or `fascicle export` wrote");
    }
    const std::vector<ExportedFrame> frames = ReadSeriesIndex(options.source);
    for (const std::int64_t k : ChosenFrames(options.frames, static_cast<std::int64_t>(frames.size()))) {
      call(ReadSnapshot(frames[static_cast<std::size_t>(k)]));
    }
    return;
  }
  JobSource source = OpenJob(context, options.source);
  const std::string& name = source.job;
  const v1::Job job = Take(source.client.GetJob(name));
  if (job.frame_count() == 0) throw CommandError::Invalid(name + " has no frames yet");
  const std::vector<std::int64_t> frames = ChosenFrames(options.frames, job.frame_count());
  ReadStored(source.client, name, FramesFrom(frames.front()),
             [&](const v1::Geometry& geometry, const v1::Frame& frame) {
               if (!std::binary_search(frames.begin(), frames.end(), frame.index())) return true;
               CheckDigest(frame);
               call(SnapshotOf(geometry, frame));
               return frame.index() < frames.back();
             });
}

bool IsWanted(const SampleOptions& options, const std::string& name) {
  return options.fields.empty() || std::any_of(options.fields.begin(), options.fields.end(), [&](const auto& glob) {
           return MatchesGlob(glob, name) || MatchesGlob(glob + "/*", name);
         });
}

std::string Heading(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

void CheckFieldsFound(const SampleOptions& options, std::size_t found, const std::string& known) {
  if (found > 0) return;
  std::string wanted;
  for (const std::string& glob : options.fields) wanted += " " + glob;
  throw CommandError::Invalid("--fields: nothing matches" + wanted + "; fields of the frame:" + known +
                              " (see the scene's output.fields)");
}

void WriteTable(const SampleOptions& options, const Context& context, const std::vector<CsvColumn>& columns,
                const std::vector<PlotPanel>& panels) {
  if (!options.out.empty()) ReplaceFile(options.out, CsvOf(columns));
  if (!options.plot.empty()) WritePlot(panels, options.plot);
  if (context.json) return;
  if (options.out.empty() && options.plot.empty()) std::cout << CsvOf(columns);
  if (!options.out.empty()) std::cout << "the table is in " << options.out << '\n';
  if (!options.plot.empty()) std::cout << "the plot is in " << options.plot << '\n';
}

std::string TimeText(double time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g s", time);
  return text;
}

Json PointJson(const Vec3& x) { return {x[0], x[1], x[2]}; }

// A table of points: a row for each frame and point.
struct PointTable {
  std::vector<CsvColumn> columns;
  std::vector<PlotPanel> panels;
};

void AddFrame(const Snapshot& snapshot, const std::vector<SampledColumn>& sampled, const std::vector<Vec3>& points,
              const std::vector<double>& places, const std::string& place, PointTable& table) {
  if (table.columns.empty()) {
    for (const std::string& heading : {std::string("frame"), std::string("time [s]"), place, std::string("x [m]"),
                                       std::string("y [m]"), std::string("z [m]")}) {
      table.columns.push_back({heading, {}});
    }
    for (const SampledColumn& column : sampled) {
      table.columns.push_back({Heading(column.name, column.unit), {}});
      table.panels.push_back({"", place, Heading(column.name, column.unit == "1" ? "" : column.unit), {}});
    }
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double head[] = {
        static_cast<double>(snapshot.frame), snapshot.time, places[p], points[p][0], points[p][1], points[p][2]};
    for (std::size_t k = 0; k < std::size(head); ++k) table.columns[k].values.push_back(head[k]);
    for (std::size_t k = 0; k < sampled.size(); ++k) table.columns[6 + k].values.push_back(sampled[k].values[p]);
  }
  for (std::size_t k = 0; k < sampled.size(); ++k) {
    table.panels[k].lines.push_back({TimeText(snapshot.time), places, sampled[k].values});
  }
}

std::string BoundsText(const Snapshot& snapshot, bool deformed) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const BodySnapshot& body : snapshot.bodies) {
    for (const Vec3& x : deformed ? body.positions : body.shape.positions) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
  }
  return VectorText(low) + " to " + VectorText(high) + " m";
}

void CheckInside(const SampleOptions& options, const Snapshot& snapshot, const std::vector<SampledColumn>& sampled) {
  const bool has_inside = std::any_of(snapshot.bodies.begin(), snapshot.bodies.end(),
                                      [](const BodySnapshot& body) { return body.shape.triangles.empty(); });
  if (!has_inside) {
    throw CommandError::Invalid(
        "the bodies are surfaces, without elements inside; use --region, or probes in the scene");
  }
  for (const SampledColumn& column : sampled) {
    if (std::any_of(column.values.begin(), column.values.end(), [](double v) { return std::isfinite(v); })) return;
  }
  throw CommandError::Invalid("no point is inside of a body; the bodies extend from " +
                              BoundsText(snapshot, options.deformed) + "; see --unit");
}

int SamplePoints(const SampleOptions& options, const Context& context) {
  const bool is_line = !options.line.empty();
  const std::vector<Vec3> points = is_line ? PointsOfLine(options) : PointsOfFile(options);
  std::vector<double> places;
  for (std::size_t p = 0; p < points.size(); ++p) {
    places.push_back(is_line ? (points[p] - points[0]).norm() : static_cast<double>(p));
  }
  PointTable table;
  ForSnapshots(options, context, [&](const Snapshot& snapshot) {
    std::vector<SampledColumn> sampled = SampleAtPoints(snapshot, points, options.deformed);
    CheckInside(options, snapshot, sampled);
    std::string known;
    for (const SampledColumn& column : sampled) known += " " + column.name;
    std::erase_if(sampled, [&](const SampledColumn& column) { return !IsWanted(options, column.name); });
    CheckFieldsFound(options, sampled.size(), known);
    AddFrame(snapshot, sampled, points, places, is_line ? "distance [m]" : "point", table);
    if (!context.json) return;
    Json json = {{"frame", snapshot.frame}, {"time", snapshot.time}};
    for (const Vec3& point : points) json["points"].push_back(PointJson(point));
    for (const SampledColumn& column : sampled) {
      json["fields"][column.name] = {{"unit", column.unit}, {"values", column.values}};
    }
    PrintJson(json);
  });
  WriteTable(options, context, table.columns, table.panels);
  return kDone;
}

std::optional<RegionSample> RegionIn(const Snapshot& snapshot, const SampleOptions& options) {
  try {
    return SampleRegion(snapshot, options.region, options.deformed);
  } catch (const std::runtime_error& error) {
    throw CommandError::Invalid(std::string("--region: ") + error.what());
  }
}

int SampleOneRegion(const SampleOptions& options, const Context& context) {
  std::vector<CsvColumn> columns;
  std::vector<PlotPanel> panels;
  ForSnapshots(options, context, [&](const Snapshot& snapshot) {
    std::optional<RegionSample> sample = RegionIn(snapshot, options);
    if (!sample) {
      throw CommandError::Invalid("--region: `" + options.region +
                                  "` has neither an element nor a face of the surface");
    }
    std::string known;
    for (const RegionStatistics& field : sample->fields) known += " " + field.name;
    std::erase_if(sample->fields, [&](const RegionStatistics& field) { return !IsWanted(options, field.name); });
    CheckFieldsFound(options, sample->fields.size(), known);
    const std::string size = sample->is_volume ? "m^3" : "m^2";
    if (columns.empty()) {
      columns = {{"frame", {}}, {"time [s]", {}}, {(sample->is_volume ? "volume [" : "area [") + size + "]", {}}};
      for (const RegionStatistics& field : sample->fields) {
        const std::string of_integral = field.unit.empty() ? "" : field.unit == "1" ? size : field.unit + " " + size;
        columns.push_back({Heading(field.name + " mean", field.unit), {}});
        columns.push_back({Heading(field.name + " min", field.unit), {}});
        columns.push_back({Heading(field.name + " max", field.unit), {}});
        columns.push_back({Heading(field.name + " integral", of_integral), {}});
        panels.push_back({options.region,
                          "time [s]",
                          Heading(field.name, field.unit == "1" ? "" : field.unit),
                          {{"mean", {}, {}}, {"min", {}, {}}, {"max", {}, {}}}});
      }
    }
    std::vector<double> row = {static_cast<double>(snapshot.frame), snapshot.time, sample->size};
    Json json = {{"frame", snapshot.frame},
                 {"time", snapshot.time},
                 {"region", options.region},
                 {sample->is_volume ? "volume" : "area", sample->size}};
    for (std::size_t k = 0; k < sample->fields.size(); ++k) {
      const RegionStatistics& field = sample->fields[k];
      const double values[] = {field.mean, field.smallest, field.largest};
      row.insert(row.end(), {field.mean, field.smallest, field.largest, field.integral});
      for (std::size_t i = 0; i < 3; ++i) {
        panels[k].lines[i].x.push_back(snapshot.time);
        panels[k].lines[i].y.push_back(values[i]);
      }
      json["fields"][field.name] = {{"unit", field.unit},
                                    {"mean", field.mean},
                                    {"min", field.smallest},
                                    {"max", field.largest},
                                    {"integral", field.integral}};
    }
    for (std::size_t k = 0; k < row.size(); ++k) columns[k].values.push_back(row[k]);
    if (context.json) PrintJson(json);
  });
  WriteTable(options, context, columns, panels);
  return kDone;
}

// An axis and a number of places: X,Y,Z:N.
std::pair<Vec3, int> AxisAndCount(const std::string& text) {
  constexpr double kMostSections = 10'000;
  const std::vector<std::string> parts = SplitAt(':', text);
  const std::optional<Vec3> axis = parts.size() == 2 ? PointIn(parts[0]) : std::nullopt;
  const std::optional<double> count = parts.size() == 2 ? NumberIn(parts[1]) : std::nullopt;
  if (!axis || !(axis->norm() > 0) || !count || !(*count >= 1) || !(*count <= kMostSections) ||
      *count != std::floor(*count)) {
    throw CommandError::Invalid("--sections: expects X,Y,Z:N, an axis and 1 to 10000 places, such as 0,0,1:20");
  }
  return {*axis, static_cast<int>(*count)};
}

int SampleSections(const SampleOptions& options, const Context& context) {
  const auto [axis, count] = AxisAndCount(options.sections);
  std::vector<CsvColumn> columns = {{"frame", {}}, {"time [s]", {}}};
  std::vector<PlotPanel> panels;
  ForSnapshots(options, context, [&, axis = axis, count = count](const Snapshot& snapshot) {
    Json json = {{"frame", snapshot.frame}, {"time", snapshot.time}, {"bodies", Json::array()}};
    for (std::size_t b = 0; b < snapshot.bodies.size(); ++b) {
      const std::string& name = snapshot.bodies[b].shape.name;
      const CrossSectionAreas cut = CrossSectionAreasOf(snapshot.bodies[b], axis, count, options.deformed);
      if (panels.size() == b) {
        panels.push_back({name, "position along the axis [m]", "cross-section [m^2]", {}});
        columns.push_back({name + " position [m]", {}});
        columns.push_back({name + " area [m^2]", {}});
      }
      panels[b].lines.push_back({TimeText(snapshot.time), cut.places, cut.areas});
      std::vector<double>&places = columns[2 + 2 * b].values, &areas = columns[3 + 2 * b].values;
      places.insert(places.end(), cut.places.begin(), cut.places.end());
      areas.insert(areas.end(), cut.areas.begin(), cut.areas.end());
      json["bodies"].push_back({{"body", name}, {"positions", cut.places}, {"areas", cut.areas}});
    }
    columns[0].values.insert(columns[0].values.end(), static_cast<std::size_t>(count),
                             static_cast<double>(snapshot.frame));
    columns[1].values.insert(columns[1].values.end(), static_cast<std::size_t>(count), snapshot.time);
    if (context.json) PrintJson(json);
  });
  WriteTable(options, context, columns, panels);
  return kDone;
}

std::optional<Vec3> LineOfAction(const SampleOptions& options) {
  if (options.line_of_action.empty()) return std::nullopt;
  const std::optional<Vec3> line = PointIn(options.line_of_action);
  if (line && line->norm() > 0) return line;
  throw CommandError::Invalid("--line-of-action: expects a direction X,Y,Z");
}

int SampleFibres(const SampleOptions& options, const Context& context) {
  const std::optional<Vec3> line = LineOfAction(options);
  std::vector<CsvColumn> columns = {{"frame", {}}, {"time [s]", {}}};
  std::map<std::string, PlotPanel> panels;
  ForSnapshots(options, context, [&](const Snapshot& snapshot) {
    const bool is_first = columns[0].values.empty();
    std::vector<double> row = {static_cast<double>(snapshot.frame), snapshot.time};
    for (const BodySnapshot& body : snapshot.bodies) {
      const std::optional<FibreArchitecture> fibres = FibreArchitectureOf(body, line, options.deformed);
      if (!fibres) continue;
      const std::string& name = body.shape.name;
      const std::pair<const char*, double> values[] = {
          {"volume [m^3]", fibres->volume},       {"fibre length [m]", fibres->length},
          {"shortest [m]", fibres->shortest},     {"longest [m]", fibres->longest},
          {"pennation [rad]", fibres->pennation}, {"PCSA [m^2]", fibres->cross_section}};
      Json json = {{"frame", snapshot.frame}, {"time", snapshot.time}, {"body", name}, {"fibres", fibres->fibres}};
      for (const auto& [heading, value] : values) {
        if (is_first) columns.push_back({name + " " + heading, {}});
        row.push_back(value);
        PlotPanel& panel = panels.try_emplace(heading, PlotPanel{"", "time [s]", heading, {}}).first->second;
        if (is_first) panel.lines.push_back({name, {}, {}});
        auto line_of = std::find_if(panel.lines.begin(), panel.lines.end(), [&](auto& l) { return l.name == name; });
        line_of->x.push_back(snapshot.time);
        line_of->y.push_back(value);
        json[std::string(heading, std::string(heading).find(" ["))] = value;
      }
      if (context.json) PrintJson(json);
    }
    if (row.size() == 2) throw CommandError::Invalid("--fibres: no body has elements with fibres");
    for (std::size_t k = 0; k < row.size(); ++k) columns[k].values.push_back(row[k]);
  });
  std::vector<PlotPanel> list;
  for (auto& [heading, panel] : panels) list.push_back(std::move(panel));
  WriteTable(options, context, columns, list);
  return kDone;
}

int Sample(const SampleOptions& options, const Context& context) {
  const bool ways[] = {!options.line.empty(), !options.points.empty(), !options.region.empty(),
                       !options.sections.empty(), options.fibres};
  if (std::count(std::begin(ways), std::end(ways), true) != 1) {
    throw CommandError::Invalid("give one of --line, --points, --region, --sections and --fibres");
  }
  if (!options.sections.empty()) return SampleSections(options, context);
  if (options.fibres) return SampleFibres(options, context);
  return options.region.empty() ? SamplePoints(options, context) : SampleOneRegion(options, context);
}

}  // namespace

void AddSample(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "sample", "Values of fields along a line, at points or over a region", kSampleExamples);
  const auto options = std::make_shared<SampleOptions>();
  command->add_option("JOB|FOLDER", options->source, "The job, or a folder with exported frames")->required();
  command->add_option("--line", options->line, "N places from one point to another")->type_name("X,Y,Z:X,Y,Z:N");
  command->add_option("--points", options->points, "Points: the first three columns x,y,z of a table")
      ->type_name("FILE.csv");
  command->add_option("--region", options->region, "Mean, extremes and integral over a region")
      ->type_name("[BODY/]NAME");
  command->add_option("--sections", options->sections, "Areas of N cross-sections along an axis")->type_name("X,Y,Z:N");
  command->add_flag("--fibres", options->fibres, "Volume, length of fibres, pennation and PCSA of each body");
  command
      ->add_option("--line-of-action", options->line_of_action,
                   "Line of action for --fibres; the body's longest axis by default")
      ->type_name("X,Y,Z");
  command->add_option("--frames", options->frames, "Frames: `last`, `all`, or indices separated by commas")
      ->type_name("I,J,...");
  command->add_option("--fields", options->fields, "Fields by name, with * and ?; all by default; may be repeated")
      ->type_name("GLOB")
      ->allow_extra_args(false);
  command->add_option("--unit", options->unit, "Unit of the given points; m by default")
      ->check(CLI::IsMember({"m", "cm", "mm"}));
  command->add_flag("--deformed", options->deformed, "Points of space, and volumes and areas of the deformed body");
  command->add_option("--out", options->out, "Write the table to a file")->type_name("FILE.csv");
  command->add_option("--plot", options->plot, "Also draw a picture")->type_name("FILE.png");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Sample(*options, context); }; });
}

}  // namespace fascicle::client
