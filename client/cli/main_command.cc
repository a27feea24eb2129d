#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "client/cli/command.h"
#include "core/base/edit_distance.h"
#include "core/base/stop.h"

namespace fascicle::client {
namespace {

constexpr const char* kFooter = R"(First steps:
  fascicle examples write fusiform_isometric      a muscle that contracts between fixed ends
  fascicle run fusiform_isometric.json --out out  simulate it here; out/ gets tables and pictures
  fascicle schema                                 all fields of a scene
  fascicle COMMAND --help                         more, with examples

Exit codes:
  0  done
  1  the job failed, or another error occurred
  2  invalid input; each problem is on its own line
  3  no server, or no response
  4  cancelled
)";

// The first word, if it is the name of no command.
std::optional<std::string> UnknownCommand(const CLI::App& app, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--server") ++i;  // its value
    if (word.empty() || word.starts_with("-")) continue;
    const auto has_name = [&](const CLI::App* command) { return command->get_name() == word; };
    return app.get_subcommands(has_name).empty() ? std::optional<std::string>(word) : std::nullopt;
  }
  return std::nullopt;
}

// Names of other programs' commands for the same, otherwise the command that is spelled most nearly so.
std::string NearCommand(const CLI::App& app, const std::string& wrong) {
  static const std::map<std::string, const char*> kOtherNames = {{"status", "show` or `list"},
                                                                 {"tail", "log"},
                                                                 {"logs", "log"},
                                                                 {"server", "info"},
                                                                 {"hold", "pause"},
                                                                 {"suspend", "pause"},
                                                                 {"continue", "resume` or `restart"},
                                                                 {"label", "update"},
                                                                 {"pin", "update"},
                                                                 {"priority", "update"},
                                                                 {"jobs", "list"},
                                                                 {"ls", "list"},
                                                                 {"ps", "list"},
                                                                 {"queue", "list"},
                                                                 {"stop", "cancel"},
                                                                 {"kill", "cancel"},
                                                                 {"abort", "cancel"},
                                                                 {"rm", "delete"},
                                                                 {"remove", "delete"},
                                                                 {"clean", "delete"},
                                                                 {"start", "run"},
                                                                 {"simulate", "run"},
                                                                 {"solve", "run"},
                                                                 {"check", "validate"},
                                                                 {"lint", "validate"},
                                                                 {"convert", "import` or `mesh"},
                                                                 {"draw", "render"},
                                                                 {"picture", "render"},
                                                                 {"view", "render"},
                                                                 {"animate", "render"},
                                                                 {"chart", "plot"},
                                                                 {"graph", "plot"},
                                                                 {"follow", "watch"},
                                                                 {"attach", "watch"},
                                                                 {"probe", "sample"},
                                                                 {"values", "sample"},
                                                                 {"tetrahedralize", "mesh"},
                                                                 {"laws", "materials"},
                                                                 {"fields", "schema"},
                                                                 {"example", "examples"},
                                                                 {"send", "submit"},
                                                                 {"voxels", "voxelize"},
                                                                 {"control", "steer"},
                                                                 {"repeat", "replay"}};
  if (const auto known = kOtherNames.find(wrong); known != kOtherNames.end()) return known->second;
  std::string nearest;
  std::size_t best = std::max<std::size_t>(2, wrong.size() / 3) + 1;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    const std::size_t distance = EditDistance(wrong.substr(0, 64), command->get_name());
    if (distance >= best) continue;
    best = distance;
    nearest = command->get_name();
  }
  return nearest;
}

Error NoSuchCommand(const CLI::App& app, const std::string& wrong) {
  const std::string near = NearCommand(app, wrong);
  const std::string hint = near.empty() ? "" : "did you mean `" + near + "`? ";
  return {Error::Kind::kInvalid,
          "there is no command `" + wrong + "`; " + hint + "`fascicle --help` lists the commands",
          "",
          {}};
}

int Run(int argc, char** argv) {
  CLI::App app("fascicle simulates skeletal muscle and other soft tissue, here or on a server.", "fascicle");
  Context context;
  app.add_option("--server", context.server, "The server; 127.0.0.1:7300 by default. `run` needs none")
      ->envname("FASCICLE_SERVER")
      ->type_name("HOST:PORT");
  app.add_flag("--json", context.json, "Write one JSON object per line to stdout");
  app.set_version_flag("--version", std::string("fascicle ") + FASCICLE_VERSION);
  app.require_subcommand(1);
  app.footer(kFooter);
  AddRun(app, context);
  AddSubmit(app, context);
  AddValidate(app, context);
  AddImport(app, context);
  AddImportJob(app, context);
  AddWatch(app, context);
  AddList(app, context);
  AddShow(app, context);
  AddInfo(app, context);
  AddUpdate(app, context);
  AddPause(app, context);
  AddResume(app, context);
  AddCancel(app, context);
  AddRestart(app, context);
  AddVerify(app, context);
  AddSteer(app, context);
  AddReplay(app, context);
  AddLog(app, context);
  AddDelete(app, context);
  AddExport(app, context);
  AddRender(app, context);
  AddPlot(app, context);
  AddSample(app, context);
  AddMesh(app, context);
  AddPhantom(app, context);
  AddSegment(app, context);
  AddVoxelize(app, context);
  AddMaterials(app, context);
  AddActivations(app, context);
  AddMomentArms(app, context);
  AddSchema(app, context);
  AddExamples(app, context);
  AddCompletion(app, context);
  if (const std::optional<std::string> wrong = UnknownCommand(app, argc, argv)) {
    const bool json =
        std::any_of(argv + 1, argv + argc, [](const char* word) { return std::string_view(word) == "--json"; });
    PrintError(NoSuchCommand(app, *wrong), json);
    return kInvalidInput;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kInvalidInput;
  }
  try {
    return context.action();
  } catch (const CommandError& error) {
    PrintError(error.error(), context.json);
    return ExitCodeOf(error.error().kind);
  } catch (const Stopped&) {
    PrintError({Error::Kind::kStopped, "interrupted", "", {}}, context.json);
    return kCancelled;
  } catch (const std::exception& error) {
    PrintError({Error::Kind::kInternal, error.what(), "", {}}, context.json);
    return kJobFailed;
  }
}

// Whether everything that was printed has been written. The kernel may refuse it as late as here: a full disk, a closed
// pipe.
bool WroteAll() {
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  return flushed && std::cout.good() && std::ferror(stdout) == 0;
}

}  // namespace

int Main(int argc, char** argv) {
  const int code = Run(argc, argv);
  if (WroteAll()) return code;
  std::cerr << "fascicle: the output could not be written to stdout: is the disk full?\n";
  return code == kDone ? kJobFailed : code;
}

}  // namespace fascicle::client
