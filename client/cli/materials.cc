#include <unistd.h>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include "client/cli/command.h"
#include "client/cli/terminal_plot.h"
#include "client/export/csv.h"
#include "client/lib/replace_file.h"
#include "client/render/plot.h"
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

A bar is stretched along its fibres with free sides; the stress is force per rest area (nominal) and per deformed area
(Cauchy).
)";

struct CurveOptions {
  std::string law;
  std::vector<std::string> settings;
  std::vector<double> activations = {0};
  std::vector<double> range = {0.6, 1.8};
  double velocity = 0;  // [1/s]
  int points = 121;
  std::string csv;
  std::string out;
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

int Curve(const CurveOptions& options, const Context& context) {
  const LawInfo& law = LawOrFail(options.law);
  const Material material = law.make(ParameterValues(law, options.settings));
  const std::vector<double> stretches = Stretches(options);
  PlotPanel panel{law.title, "stretch", "nominal stress [kPa]", {}};
  std::vector<CsvColumn> columns = {{"stretch [1]", stretches}};
  for (const double activation : options.activations) {
    const std::string suffix = " at activation " + Number(activation);
    CsvColumn nominal{"nominal_stress" + suffix + " [Pa]", {}}, cauchy{"cauchy_stress" + suffix + " [Pa]", {}},
        volume{"volume_ratio" + suffix + " [1]", {}};
    PlotLine line{"activation " + Number(activation), stretches, {}};
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
  curve->add_option("--stretch", options->range, "Range of the stretch")->expected(2)->type_name("LOW HIGH");
  curve
      ->add_option("--velocity", options->velocity,
                   "Rate of the fibre stretch [1/s], negative while it shortens; for laws that depend on it")
      ->type_name("V");
  curve->add_option("--points", options->points, "Number of points per curve")->check(CLI::Range(2, 100000));
  curve->add_option("--csv", options->csv, "Write the curves as a table")->type_name("FILE.csv");
  curve->add_option("--out", options->out, "Draw the curves")->type_name("FILE.png");
  curve->callback([options, &context] { context.action = [options, &context] { return Curve(*options, context); }; });
}

}  // namespace fascicle::client
