#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "client/cli/outputs.h"
#include "client/cli/terminal_plot.h"

namespace fascicle::client {
namespace {

constexpr const char* kExamples =
    R"(  fascicle plot 3f2a                                         every series that is not zero, in the terminal
  fascicle plot 3f2a --series '*/reaction/*' --series 'energy/*'
  fascicle plot 3f2a --series '*volume_ratio' --out volume.png
  fascicle plot 3f2a --series 'probe/*' --json              times and values, one object for each series
)";

struct Options {
  std::string job;
  std::vector<std::string> series;
  std::string out;
};

int Columns() {
  winsize size = {};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

int Plot(const Options& options, const Context& context) {
  Client client = Connect(context);
  const Followed followed =
      ReadStored(client, JobName(options.job), 0, [](const v1::Geometry&, const v1::Frame&) { return true; });
  const std::vector<PlotPanel> panels = PanelsOf(followed.table, options.series);
  if (panels.empty()) throw CommandError::Invalid("all series stay zero; choose some with --series");
  if (!options.out.empty()) WritePlot(panels, options.out);
  if (context.json) {
    for (const PlotPanel& panel : panels) {
      for (const PlotLine& line : panel.lines) {
        PrintJson({{"series", line.name}, {"axis", panel.y_label}, {"time", line.x}, {"values", line.y}});
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
  CLI::App* command = AddCommand(app, "plot", "Plot series of a job over time", kExamples);
  const auto options = std::make_shared<Options>();
  command->add_option("JOB", options->job, "The job")->required();
  command->add_option("--series", options->series, "Series by name, with * and ?; may be repeated")->type_name("GLOB");
  command->add_option("--out", options->out, "Also draw a picture")->type_name("FILE.png");
  command->callback([options, &context] { context.action = [options, &context] { return Plot(*options, context); }; });
}

}  // namespace fascicle::client
