#include <cstdio>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "client/cli/command.h"
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
  AddWatch(app, context);
  AddList(app, context);
  AddShow(app, context);
  AddCancel(app, context);
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
  AddSchema(app, context);
  AddExamples(app, context);
  AddCompletion(app, context);
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
