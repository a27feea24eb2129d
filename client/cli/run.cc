#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "client/cli/command.h"
#include "client/cli/convergence.h"
#include "client/cli/digests.h"
#include "client/cli/follow.h"
#include "client/cli/interrupts.h"
#include "client/cli/job_source.h"
#include "client/cli/outputs.h"
#include "client/cli/profile_table.h"
#include "client/cli/start_frame.h"
#include "client/cli/summary.h"
#include "client/cli/temporary_folder.h"
#include "client/export/csv.h"
#include "client/export/vtk_series.h"
#include "client/lib/replace_file.h"
#include "client/render/display.h"
#include "server/embedded_server.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunExamples = R"(  fascicle run scene.json                         simulate and print a summary
  fascicle run scene.json --out out               and keep series.csv, series.png, frames.pvd and last.png in out/
  fascicle render out --out fibres.png --fibres   the same job again: plot, render, export, sample and show take out/
  fascicle run scene.json --threads 2 --data db   on two threads; the server's database stays in db/
  fascicle run scene.json --profile               and print the time spent in each stage
  fascicle run scene.json --check                 again with half the step and half the mesh size: is it converged?
  fascicle run scene.json --set 'bodies[0].activation.values=[0, 0.5]'
  fascicle run scene.json --json | jq .series     for programs

out/largest.png is the frame with the largest displacement, where a body is nearer to its rest shape at the end.
Ctrl-C cancels the job (exit code 4); results so far are kept.
)";

struct RunOptions {
  SceneArgument scene;
  std::string out;
  std::string data;
  int threads = 1;
  bool digests = false;
  bool profile = false;
  bool check = false;
};

// Removes the folders that a scene which is refused would leave behind.
class NewFolders {
 public:
  explicit NewFolders(fs::path results)
      : results_(std::move(results)),
        makes_data_(!fs::exists(DataFolderIn(results_))),
        makes_results_(!fs::exists(results_)) {}
  ~NewFolders() {
    std::error_code ignored;
    if (!kept_ && makes_data_) fs::remove_all(DataFolderIn(results_), ignored);
    if (!kept_ && makes_results_) fs::remove(results_, ignored);
  }
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  void Keep() { kept_ = true; }

 private:
  const fs::path results_;
  const bool makes_data_, makes_results_;
  bool kept_ = false;
};

void WriteResults(const Followed& followed, const LargestDisplacement& largest, const fs::path& folder) {
  if (followed.table.size() == 0) return;
  const std::shared_ptr<Display> display = Display::Open();  // for all pictures
  ReplaceFile(folder / "series.csv", CsvOf(followed.table));
  ReplaceFile(folder / "summary.json", SummaryJson(followed).dump(2) + "\n");
  const std::vector<PlotPanel> panels = PanelsOf(followed.table, {});
  if (!panels.empty() && followed.table.size() > 1) WritePlot(panels, folder / "series.png");
  DrawPicture(followed.geometry, *followed.last_frame, DefaultPicture(followed.job, *followed.last_frame),
              folder / "last.png");
  if (const std::optional<v1::Frame>& frame = largest.frame()) {
    DrawPicture(followed.geometry, *frame, DefaultPicture(followed.job, *frame), folder / "largest.png");
  } else {
    fs::remove(folder / "largest.png");  // of an earlier run
  }
}

// A results folder keeps the job of its last run only. One whose run was killed would go on first.
void CancelAll(Client& client) {
  for (const v1::Job& job : Take(client.ListJobs(1000, {}))) {
    if (!IsFinal(job.state())) Take(client.CancelJob(job.name()));
  }
}
void DeleteOthers(Client& client, const std::string& job) {
  for (const v1::Job& other : Take(client.ListJobs(1000, {}))) {
    if (other.name() != job) Check(client.DeleteJob(other.name()));
  }
}

// Runs a changed scene to its end, compares its series and deletes its job.
CheckedRun RunChanged(Client& client, const ScenePackage& package, const v1::Scene& changed, std::string what,
                      const SeriesTable& before, const RunOptions& options, const std::stop_token& stop) {
  std::cerr << "check: " << what << "\n";
  const v1::Job job = Take(client.Submit({changed, package.assets}, options.threads, stop));
  const std::stop_callback cancel(stop, [&] { (void)client.CancelJob(job.name()); });
  const Followed followed = Follow(client, job.name(), OnlySeries(), {}, {});
  Check(client.DeleteJob(job.name()));
  return {std::move(what), followed.job, ChangesBetween(before, followed.table)};
}

// The further runs of `--check`. Ends early if the user interrupts it.
std::vector<CheckedRun> CheckConvergence(Client& client, const ScenePackage& package, const Followed& followed,
                                         const RunOptions& options, const std::stop_token& stop) {
  std::vector<CheckedRun> runs;
  if (followed.job.state() != v1::Job::STATE_SUCCEEDED) return runs;
  const SeriesTable& before = followed.table;
  const auto run = [&](const std::optional<v1::Scene>& changed, const char* what) {
    if (!changed || stop.stop_requested()) return;
    runs.push_back(RunChanged(client, package, *changed, what, before, options, stop));
  };
  run(WithHalfStep(package.scene, before.steps().back()), "half the time step");
  if (package.scene.start().has_frame()) {
    std::cerr
        << "check: not with half the mesh size, because the frame in which the scene starts belongs to its mesh\n";
  }
  run(WithHalfMeshSize(package.scene), "half the mesh size");
  return runs;
}

int Run(const RunOptions& options, const Context& context) {
  ScenePackage package = LoadSceneOrFail(options.scene);
  PackStart(context, options.scene.start, package);
  // Created before the server, whose threads must not receive the signals.
  const StopOnInterrupt interrupts;
  std::unique_ptr<TemporaryFolder> temporary;
  const bool keeps_one = options.data.empty() && !options.out.empty();
  if (options.data.empty() && options.out.empty()) temporary = std::make_unique<TemporaryFolder>();
  std::optional<NewFolders> folders;  // outlives the server
  if (keeps_one) folders.emplace(options.out);
  server::ServerOptions server_options;
  server_options.data_directory = temporary   ? temporary->path().string()
                                  : keeps_one ? DataFolderIn(options.out).string()
                                              : options.data;
  server_options.workers = 1;
  server_options.default_threads = options.threads;
  const auto server = server::EmbeddedServer::Start(server_options);
  Client client(server->address());
  if (keeps_one) CancelAll(client);
  const v1::Job job = Take(client.Submit(package, options.threads, interrupts.token()));
  if (folders) folders->Keep();
  const std::stop_callback cancel(interrupts.token(), [&] { (void)client.CancelJob(job.name()); });
  std::optional<VtkSeriesWriter> frames;
  LargestDisplacement largest;
  const auto on_frame = [&](const v1::Geometry& geometry, const v1::Frame& frame) {
    if (options.digests) PrintDigest(frame, context.json);
    if (options.out.empty()) return;
    if (!frames) frames.emplace(geometry, options.out);
    frames->Add(frame);
    largest.Add(geometry, frame);
  };
  const Followed followed = Follow(client, job.name(), {}, on_frame, {});
  const std::vector<CheckedRun> checked = options.check
                                              ? CheckConvergence(client, package, followed, options, interrupts.token())
                                              : std::vector<CheckedRun>();
  if (keeps_one) DeleteOthers(client, job.name());
  server->Stop();
  if (frames) frames->Finish();
  if (context.json) {
    Json summary = SummaryJson(followed);
    if (options.profile) summary["profile"] = ProfileJson(followed.job);
    if (options.check) summary["check"] = CheckJson(checked);
    PrintJson(summary);
  } else {
    PrintSummary(followed);
    if (options.profile) PrintProfile(followed.job);
    PrintCheck(checked);
  }
  if (!options.out.empty()) {
    WriteResults(followed, largest, options.out);
    if (!context.json) {
      std::cout << "results written to " << options.out << "; for more: fascicle plot " << options.out
                << ", fascicle render " << options.out << " --out picture.png\n";
    }
  }
  return ExitCodeOf(followed.job);
}

}  // namespace

void AddRun(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "run", "Simulate a scene on this machine, without a server", kRunExamples);
  const auto options = std::make_shared<RunOptions>();
  AddSceneArgument(*command, options->scene);
  AddStartOption(*command, options->scene);
  command
      ->add_option("--out", options->out, "Folder for results: the job, series.csv, frames.pvd, pictures, summary.json")
      ->type_name("DIR");
  command->add_option("--data", options->data, "Keep the server's database in this folder")->type_name("DIR");
  command->add_option("--threads", options->threads, "Number of threads; results do not depend on it")
      ->check(CLI::Range(1, 256));
  command->add_flag("--digests", options->digests, "Print a line with the digest of each frame");
  command->add_flag("--check", options->check,
                    "Run twice more, with half the time step and half the mesh size, and compare all series");
  command->add_flag("--profile", options->profile, "Print the time spent in each stage");
  command->callback([options, &context] { context.action = [options, &context] { return Run(*options, context); }; });
}

}  // namespace fascicle::client
