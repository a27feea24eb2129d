#include <unistd.h>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include "client/cli/command.h"
#include "client/cli/input_file.h"
#include "client/cli/terminal_plot.h"
#include "client/export/csv.h"
#include "client/lib/replace_file.h"
#include "client/render/plot.h"
#include "core/base/text_lines.h"
#include "core/materials/curve_fit.h"
#include "core/materials/material.h"
#include "core/materials/uniaxial_curve.h"

namespace fascicle::client {
namespace {

constexpr const char* kMaterialsExamples =
    R"(  fascicle materials                                   the laws, their parameters and sources
  fascicle materials muscle                            one of them
  fascicle materials curve muscle --activation 0 0.5 1 --stretch 0.6 1.8
  fascicle materials curve neo_hookean --set young_modulus=3e4 --set poisson_ratio=0.45 --csv curve.csv --out curve.png
)";

constexpr const char* kCurveExamples = R"(  fascicle materials curve muscle --activation 0 0.5 1 --stretch 0.6 1.8
  fascicle materials curve tendon --stretch 1 1.1 --csv tendon.csv --out tendon.png
  fascicle materials curve mooney_rivlin --set c1=1e4 --set bulk_modulus=1e6
  fascicle materials curve muscle --activation 1 --set max_velocity=10 --velocity -5

  fascicle materials curve ogden --data rubber.csv --set c1=1e5 --set m1=2 --set bulk_modulus=1e9 --fit c1 m1

A bar is stretched along its fibres with free sides; the stress is force per rest area (nominal) and per deformed area
(Cauchy). --data draws a measured curve over the law's and prints the root mean square of the differences: a text with
two numbers a line, the stretch and the nominal stress [Pa], separated by a comma or blanks, after an optional line of
headings. --fit changes the named parameters to minimize it, beginning with the values of --set.
)";

struct CurveOptions {
  std::string law;
  std::vector<std::string> settings;
  std::vector<double> activations = {0};
  std::vector<double> range = {0.6, 1.8};
  bool range_given = false;
  double velocity = 0;  // [1/s]
  int points = 121;
  std::string csv;
  std::string out;
  std::string data;
  std::vector<std::string> fit;
};

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

Json LawJson(const LawInfo& law) {
  Json parameters = Json::array();
  for (const ParameterInfo& p : law.parameters) {
    Json item = {
        {"name", p.name}, {"unit", p.unit}, {"range", RangeText(p)}, {"required", std::isnan(p.default_value)}};
    if (!std::isnan(p.default_value)) item["default"] = p.default_value;
    item["meaning"] = p.meaning;
    parameters.push_back(std::move(item));
  }
  return {{"law", law.name},
          {"title", law.title},
          {"source", law.source},
          {"needs_fibres", law.needs_fibres},
          {"parameters", std::move(parameters)}};
}

void PrintLaw(const LawInfo& law) {
  std::printf("%s: %s%s\n  source: %s\n", law.name, law.title, law.needs_fibres ? " (needs fibres)" : "", law.source);
  for (const ParameterInfo& p : law.parameters) {
    const std::string value = std::isnan(p.default_value) ? "required" : "default " + Number(p.default_value);
    std::printf("  %-20s %-4s %-16s %-18s %s\n", p.name, p.unit, RangeText(p).c_str(), value.c_str(), p.meaning);
  }
  std::printf("\n");
}

const LawInfo& LawOrFail(const std::string& name) {
  if (const LawInfo* law = FindLaw(name)) return *law;
  std::string known;
  for (const LawInfo& law : Laws()) known += std::string(known.empty() ? "" : ", ") + law.name;
  throw CommandError::Invalid("there is no law `" + name + "`; known laws: " + known);
}

// The law's parameters: defaults, overridden by `--set name=value`; reports all mistakes at once.
std::vector<double> ParameterValues(const LawInfo& law, const std::vector<std::string>& settings) {
  std::vector<double> values;
  for (const ParameterInfo& p : law.parameters) values.push_back(p.default_value);
  Problems problems;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    const std::string name = setting.substr(0, equals);
    std::size_t i = 0;
    while (i < law.parameters.size() && law.parameters[i].name != name) ++i;
    double value = 0;
    if (i == law.parameters.size()) {
      problems.Add("--set " + name, "unknown parameter",
                   "`fascicle materials " + std::string(law.name) + "` lists them");
    } else if (equals == std::string::npos || !CLI::detail::lexical_cast(setting.substr(equals + 1), value)) {
      problems.Add("--set " + name, "expects NAME=NUMBER");
    } else {
      values[i] = value;
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ParameterInfo& p = law.parameters[i];
    if (std::isnan(values[i])) {
      problems.Add(p.name, "is required", "--set " + std::string(p.name) + "=VALUE [" + p.unit + "]");
    } else if (!InRange(p, values[i])) {
      problems.Add(p.name, Number(values[i]) + " is out of range", "must be in " + RangeText(p) + " [" + p.unit + "]");
    }
  }
  if (!problems.empty()) {
    throw CommandError(Error{Error::Kind::kInvalid, "the parameters are not valid", "INVALID_PARAMETERS", problems});
  }
  return values;
}

std::vector<double> Stretches(const CurveOptions& options) {
  const double low = options.range[0], high = options.range[1];
  if (!(low > 0) || !(high > low) || high > 10) {
    throw CommandError::Invalid("--stretch: expects two stretches, 0 < LOW < HIGH <= 10");
  }
  std::vector<double> stretches;
  for (int i = 0; i < options.points; ++i) stretches.push_back(low + (high - low) * i / (options.points - 1));
  return stretches;
}

// The measured points of `--data`.
std::vector<MeasuredPoint> ReadMeasured(const std::string& file) {
  Problems problems;
  Problems unreadable;
  std::string text = ReadInputFile(file, unreadable).value_or("");
  problems.Append(file, unreadable);
  for (char& c : text) {
    if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
  }
  std::vector<MeasuredPoint> points;
  bool heading = true;
  for (TextLines lines(text); lines.Next(); heading = false) {
    double numbers[2];
    const std::string place = file + ", line " + std::to_string(lines.number());
    if (!ParseNumbers(lines.line(), numbers)) {
      if (!heading) problems.Add(place, "expects two numbers", "the stretch and the nominal stress [Pa]");
    } else if (!(numbers[0] > 0 && numbers[0] <= 10)) {
      problems.Add(place, "the stretch " + Number(numbers[0]) + " is out of range",
                   "must be in (0, 10], 1 at rest; a strain is the stretch less 1");
    } else {
      points.push_back({numbers[0], numbers[1]});
    }
  }
  if (points.empty() && problems.empty()) problems.Add(file, "has no points");
  if (!problems.empty()) {
    throw CommandError(Error{Error::Kind::kInvalid, "the measured curve is not valid", "INVALID_DATA", problems});
  }
  return points;
}

// The indices of the parameters of `--fit`, ascending.
std::vector<std::size_t> FreeParameters(const LawInfo& law, const CurveOptions& options) {
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < law.parameters.size(); ++i) {
    const std::string name = law.parameters[i].name;
    if (std::find(options.fit.begin(), options.fit.end(), name) != options.fit.end()) free.push_back(i);
  }
  Problems problems;
  for (const std::string& name : options.fit) {
    const auto is_name = [&](const ParameterInfo& p) { return p.name == name; };
    if (std::none_of(law.parameters.begin(), law.parameters.end(), is_name)) {
      problems.Add("--fit " + name, "unknown parameter",
                   "`fascicle materials " + std::string(law.name) + "` lists them");
    }
  }
  if (!options.fit.empty() && options.data.empty()) problems.Add("--fit", "needs a measured curve", "--data FILE");
  if (!options.fit.empty() && options.activations.size() != 1) {
    problems.Add("--fit", "needs a single activation", "--activation A");
  }
  if (!problems.empty()) {
    throw CommandError(Error{Error::Kind::kInvalid, "the fit is not valid", "INVALID_PARAMETERS", problems});
  }
  return free;
}

void PrintFit(const LawInfo& law, const CurveOptions& options, const CurveFit& fit,
              const std::vector<std::size_t>& free, const Context& context) {
  if (context.json) {
    Json values = Json::object();
    for (std::size_t i = 0; i < fit.values.size(); ++i) values[law.parameters[i].name] = fit.values[i];
    Json line = {{"law", law.name},
                 {"data", options.data},
                 {"residual", fit.residual},
                 {"stress", fit.stresses},
                 {"parameters", std::move(values)}};
    if (!free.empty()) line.update({{"iterations", fit.iterations}, {"converged", fit.converged}});
    PrintJson(line);
    return;
  }
  for (const std::size_t i : free) {
    const ParameterInfo& p = law.parameters[i];
    std::printf("%s = %.6g %s%s\n", p.name, fit.values[i], p.unit,
                fit.values[i] == p.min || fit.values[i] == p.max ? ", the end of its range" : "");
  }
  std::printf("root mean square of the differences: %.4g Pa\n", fit.residual);
  if (!free.empty() && !fit.converged) std::printf("the fit has not converged: begin with other values (--set)\n");
}

// Adds the measured points to the plot and prints how far the law is from them. Returns the law's parameters, fitted if
// that is asked for.
std::vector<double> UseMeasured(const LawInfo& law, const CurveOptions& options, std::vector<double> values,
                                const Context& context, std::vector<MeasuredPoint>& points) {
  const std::vector<std::size_t> free = FreeParameters(law, options);
  if (options.data.empty()) return values;
  points = ReadMeasured(options.data);
  if (free.size() > points.size()) {
    throw CommandError::Invalid("--fit: more parameters than the " + std::to_string(points.size()) + " points of " +
                                options.data);
  }
  const Contraction contraction{options.activations[0], options.velocity};
  const CurveFit fit = free.empty() ? CompareWithCurve(law, std::move(values), contraction, points)
                                    : FitToCurve(law, std::move(values), free, contraction, points);
  PrintFit(law, options, fit, free, context);
  return fit.values;
}

int Curve(CurveOptions options, const Context& context) {
  const LawInfo& law = LawOrFail(options.law);
  std::vector<MeasuredPoint> measured;
  const std::vector<double> values =
      UseMeasured(law, options, ParameterValues(law, options.settings), context, measured);
  const Material material = law.make(values);
  PlotLine points{"measured", {}, {}, true};
  for (const MeasuredPoint& point : measured) {
    points.x.push_back(point.stretch);
    points.y.push_back(1e-3 * point.nominal_stress);
  }
  if (!measured.empty() && !options.range_given) {
    const auto [low, high] = std::minmax_element(points.x.begin(), points.x.end());
    options.range = {std::min(1.0, *low), std::max(*high, 1.0)};
  }
  const std::vector<double> stretches = Stretches(options);
  PlotPanel panel{law.title, "stretch", "nominal stress [kPa]", {}};
  std::vector<CsvColumn> columns = {{"stretch [1]", stretches}};
  for (const double activation : options.activations) {
    const std::string suffix = " at activation " + Number(activation);
    CsvColumn nominal{"nominal_stress" + suffix + " [Pa]", {}}, cauchy{"cauchy_stress" + suffix + " [Pa]", {}},
        volume{"volume_ratio" + suffix + " [1]", {}};
    PlotLine line{"activation " + Number(activation), stretches, {}, false};
    for (const UniaxialPoint& point : UniaxialCurve(material, {activation, options.velocity}, stretches)) {
      nominal.values.push_back(point.nominal_stress);
      cauchy.values.push_back(point.cauchy_stress);
      volume.values.push_back(point.volume_ratio);
      line.y.push_back(1e-3 * point.nominal_stress);
    }
    if (context.json) {
      PrintJson({{"law", law.name},
                 {"activation", activation},
                 {"velocity", options.velocity},
                 {"stretch", stretches},
                 {"nominal_stress", nominal.values},
                 {"cauchy_stress", cauchy.values},
                 {"volume_ratio", volume.values}});
    }
    panel.lines.push_back(std::move(line));
    for (CsvColumn* column : {&nominal, &cauchy, &volume}) columns.push_back(std::move(*column));
  }
  if (!measured.empty()) panel.lines.push_back(std::move(points));
  if (!options.csv.empty()) ReplaceFile(options.csv, CsvOf(columns));
  if (!options.out.empty()) DrawPlot({panel}, {1200, 800}, options.out);
  if (!context.json) {
    std::cout << TerminalPlot(panel, 64, 16, isatty(STDOUT_FILENO) != 0);
    for (const std::string& file : {options.csv, options.out}) {
      if (!file.empty()) std::cout << "written to " << file << '\n';
    }
  }
  return kDone;
}

int List(const std::string& name, const Context& context) {
  for (const LawInfo& law : Laws()) {
    if (!name.empty() && name != law.name) continue;
    if (context.json) {
      PrintJson(LawJson(law));
    } else {
      PrintLaw(law);
    }
  }
  if (!name.empty()) (void)LawOrFail(name);
  return kDone;
}

}  // namespace

void AddMaterials(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "materials", "The constitutive laws, and their stress-stretch curves", kMaterialsExamples);
  const auto name = std::make_shared<std::string>();
  command->add_option("LAW", *name, "One law; all by default");
  command->callback([name, command, &context] {
    if (command->get_subcommands().empty()) context.action = [name, &context] { return List(*name, context); };
  });
  CLI::App* curve = AddCommand(*command, "curve", "Stress against stretch in a tension test", kCurveExamples);
  const auto options = std::make_shared<CurveOptions>();
  curve->add_option("LAW", options->law, "The law")->required();
  curve->add_option("--set", options->settings, "A parameter, as NAME=VALUE in SI; may be repeated")
      ->type_name("NAME=VALUE");
  curve->add_option("--activation", options->activations, "Activations, one curve each")
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("A ...");
  CLI::Option* stretch =
      curve->add_option("--stretch", options->range, "Range of the stretch")->expected(2)->type_name("LOW HIGH");
  curve
      ->add_option("--velocity", options->velocity,
                   "Rate of the fibre stretch [1/s], negative while it shortens; for laws that depend on it")
      ->type_name("V");
  curve->add_option("--points", options->points, "Number of points per curve")->check(CLI::Range(2, 100000));
  curve->add_option("--csv", options->csv, "Write the curves as a table")->type_name("FILE.csv");
  curve->add_option("--out", options->out, "Draw the curves")->type_name("FILE.png");
  curve->add_option("--data", options->data, "A measured curve: lines of stretch and nominal stress [Pa]")
      ->type_name("FILE.csv");
  curve->add_option("--fit", options->fit, "Parameters to fit to the measured curve")->type_name("NAME ...");
  curve->callback([options, stretch, &context] {
    options->range_given = stretch->count() > 0;
    context.action = [options, &context] { return Curve(*options, context); };
  });
}

}  // namespace fascicle::client
