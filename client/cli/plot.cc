#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iostream>
#include <iterator>
#include <memory>

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "client/cli/job_source.h"
#include "client/cli/outputs.h"
#include "client/cli/terminal_plot.h"
#include "core/base/letters.h"

namespace fascicle::client {
namespace {

constexpr const char* kPlotExamples =
    R"(  fascicle plot 3f2a                                         every series that is not zero, in the terminal
  fascicle plot out                                          those of the run that wrote the folder out
  fascicle plot 3f2a --series '*/reaction/*' --series 'energy/*'
  fascicle plot 3f2a --series '*volume_ratio' --out volume.png
  fascicle plot 3f2a 77c1 --series '*/reaction/end/z' --x probe/end/z --from 1 --out force_length.png
  fascicle plot 3f2a --series 'probe/*' --json              times and values, one object per series
)";

struct PlotOptions {
  std::vector<std::string> jobs;
  std::vector<std::string> series;
  std::string x;
  double from = 0;  // [s]
  std::string out;
};

int Columns() {
  winsize size = {};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

const SeriesTable::Column& ColumnOf(const SeriesTable& table, const std::string& name) {
  std::string known;
  for (const SeriesTable::Column& column : table.columns()) {
    if (column.name == name) return column;
    known += "\n  " + column.name;
  }
  throw CommandError::Invalid("there is no series " + name + "; existing series:" + known);
}

// Replaces time by a series as the abscissa, and drops everything before `from`.
void SetAbscissa(const SeriesTable& table, const PlotOptions& options, std::vector<PlotPanel>& panels) {
  const SeriesTable::Column* const x = options.x.empty() ? nullptr : &ColumnOf(table, options.x);
  const std::vector<double>& times = table.times();
  const auto first = std::lower_bound(times.begin(), times.end(), options.from) - times.begin();
  for (PlotPanel& panel : panels) {
    if (x != nullptr) panel.x_label = x->name + (x->unit == "1" ? "" : " [" + x->unit + "]");
    for (PlotLine& line : panel.lines) {
      if (x != nullptr) line.x = x->values;
      line.x.erase(line.x.begin(), line.x.begin() + first);
      line.y.erase(line.y.begin(), line.y.begin() + first);
    }
  }
}

// Adds the lines of a job to the panels of other jobs with the same axes.
void Merge(const v1::Job& job, std::vector<PlotPanel> own, std::vector<PlotPanel>& panels) {
  for (PlotPanel& panel : own) {
    for (PlotLine& line : panel.lines) line.name = job.scene_name() + ": " + line.name;
    const auto same = std::find_if(panels.begin(), panels.end(), [&](const PlotPanel& other) {
      return other.title == panel.title && other.y_label == panel.y_label;
    });
    if (same == panels.end()) {
      panels.push_back(std::move(panel));
    } else {
      std::move(panel.lines.begin(), panel.lines.end(), std::back_inserter(same->lines));
    }
  }
}

std::vector<PlotPanel> PanelsOfJobs(const PlotOptions& options, const Context& context) {
  std::vector<PlotPanel> panels;
  for (const std::string& name : options.jobs) {
    JobSource source = OpenJob(context, name);
    const Followed job =
        ReadStored(source.client, source.job, OnlySeries(), [](const v1::Geometry&, const v1::Frame&) { return true; });
    std::vector<PlotPanel> own = PanelsOf(job.table, options.series);
    SetAbscissa(job.table, options, own);
    if (options.jobs.size() == 1) return own;
    Merge(job.job, std::move(own), panels);
  }
  return panels;
}

int Plot(const PlotOptions& options, const Context& context) {
  if (!options.out.empty() && LowerExtension(options.out) != ".png") {
    throw CommandError::Invalid("--out: plots are written as PNG: the name must end in .png");
  }
  const std::vector<PlotPanel> panels = PanelsOfJobs(options, context);
  if (panels.empty()) throw CommandError::Invalid("all series are zero; choose some with --series");
  if (!options.out.empty()) WritePlot(panels, options.out);
  if (context.json) {
    for (const PlotPanel& panel : panels) {
      for (const PlotLine& line : panel.lines) {
        PrintJson({{"series", line.name},
                   {"axis", panel.y_label},
                   {options.x.empty() ? "time" : "x", line.x},
                   {"values", line.y}});
      }
    }
    return kDone;
  }
  const int width = std::clamp(Columns() - 16, 20, 160);
  for (const PlotPanel& panel : panels) std::cout << TerminalPlot(panel, width, 12, isatty(STDOUT_FILENO) != 0) << '\n';
  if (!options.out.empty()) std::cout << "the plot is in " << options.out << '\n';
  return kDone;
}

}  // namespace

void AddPlot(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "plot", "Plot series of jobs over time, or over another series", kPlotExamples);
  const auto options = std::make_shared<PlotOptions>();
  command->add_option("JOB", options->jobs, "The job; several are plotted together")->required();
  command->add_option("--series", options->series, "Series by name, with * and ?; may be repeated")
      ->type_name("GLOB")
      ->allow_extra_args(false);
  command->add_option("--x", options->x, "The series on the x axis, in place of time")->type_name("SERIES");
  command->add_option("--from", options->from, "Omit everything before this time [s]")->check(CLI::NonNegativeNumber);
  command->add_option("--out", options->out, "Also draw a picture")->type_name("FILE.png");
  command->callback([options, &context] { context.action = [options, &context] { return Plot(*options, context); }; });
}

}  // namespace fascicle::client
