#include <algorithm>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/job_options.h"
#include "client/cli/start_frame.h"
#include "client/cli/summary.h"
#include "client/cli/sweep.h"

namespace fascicle::client {
namespace {

constexpr const char* kSubmitExamples =
    R"text(  fascicle --server lab:7300 submit scene.json             prints the job's name
  fascicle submit scene.json --threads 4                   with FASCICLE_SERVER set
  fascicle submit scene.json --set duration=2 --set 'name=twice as long'
  fascicle watch "$(fascicle submit scene.json)"           submit, then follow
  fascicle submit scene.json --priority 5 --label study=knee --ttl 7d
  fascicle submit scene.json scene.json                    a job for each file
  fascicle submit scene.json --sweep 'bodies[0].density=[1000, 1060]' --sweep 'duration=[0.1, 0.2]'
)text";

struct SubmitOptions {
  std::vector<std::string> paths;
  SceneArgument scene;  // of each path
  std::vector<std::string> sweeps;
  int threads = 0;
  JobOptions settings;
  std::string owner = UserName();
  bool pin = false;
};

// The jobs to submit, with the files of their scenes, each once.
struct Submission {
  std::vector<WantedJob> jobs;
  std::vector<AssetFile> assets;
};

v1::Job JobWithoutScene(const SubmitOptions& options) {
  v1::Job job;
  job.set_threads(options.threads);
  job.set_owner(options.owner);
  job.set_pinned(options.pin);
  SetOptions(options.settings, job);
  return job;
}

// ", bodies[0].density=1000": what tells the jobs of a sweep apart.
std::string ValuesOf(const SweepPoint& point) {
  std::string values;
  for (const std::string& setting : point) values += ", " + setting;
  return values;
}

void AddScene(const Context& context, const SubmitOptions& options, const std::string& path, const SweepPoint& point,
              Submission& submission) {
  SceneArgument argument = {path, options.scene.settings, options.scene.start};
  argument.settings.insert(argument.settings.end(), point.begin(), point.end());
  ScenePackage package = LoadSceneOrFail(argument);
  PackStart(context, argument.start, package);
  package.scene.mutable_name()->append(ValuesOf(point));
  WantedJob& wanted = submission.jobs.emplace_back(WantedJob{path + ValuesOf(point), JobWithoutScene(options)});
  wanted.job.mutable_scene()->Swap(&package.scene);
  for (AssetFile& file : package.assets) {
    const auto is_same = [&](const AssetFile& other) { return other.sha256_hex == file.sha256_hex; };
    if (std::none_of(submission.assets.begin(), submission.assets.end(), is_same)) {
      submission.assets.push_back(std::move(file));
    }
  }
}

// Collects what is wrong with a scene, each fault of a file once.
class SceneFaults {
 public:
  void Add(const std::string& path, const SweepPoint& point, const Error& error) {
    Problems problems = error.problems;
    if (problems.empty()) problems.Add("", error.message);
    for (const Problem& problem : problems.kept()) {
      const std::string field = problem.path == path ? "" : problem.path;
      if (!told_.insert(path + '\n' + field + '\n' + problem.message).second) continue;
      problems_.Add(path + ValuesOf(point) + (field.empty() ? "" : ": " + field), problem.message, problem.hint);
    }
  }
  const Problems& problems() const { return problems_; }

 private:
  std::set<std::string> told_;
  Problems problems_;
};

// Loads all scenes; CommandError with the problems of all of them.
Submission Load(const SubmitOptions& options, const Context& context) {
  const std::vector<SweepPoint> points = PointsOf(options.sweeps);
  const bool is_one = options.paths.size() * points.size() == 1;
  Submission submission;
  SceneFaults faults;
  for (const std::string& path : options.paths) {
    for (const SweepPoint& point : points) {
      try {
        AddScene(context, options, path, point, submission);
      } catch (const CommandError& error) {
        if (is_one || error.error().kind != Error::Kind::kInvalid) throw;
        faults.Add(path, point, error.error());
      }
    }
  }
  if (!faults.problems().empty()) {
    throw CommandError({Error::Kind::kInvalid, "some of the scenes are not valid", "INVALID_SCENE", faults.problems()});
  }
  return submission;
}

void PrintSubmitted(const v1::Job& job, bool json) {
  if (json) return PrintJson(JobJson(job));
  std::cout << job.name() << '\n';
}

int Submit(const SubmitOptions& options, const Context& context) {
  Submission submission = Load(options, context);
  Client client = Connect(context);
  const auto print = [&](const v1::Job& job) { PrintSubmitted(job, context.json); };
  if (submission.jobs.size() > 1) {
    Check(client.SubmitAll(submission.assets, std::move(submission.jobs), print));
  } else {
    v1::Job& wanted = submission.jobs.front().job;
    const ScenePackage package = {std::move(*wanted.mutable_scene()), std::move(submission.assets)};
    print(Take(client.Submit(package, wanted)));
  }
  return kDone;
}

}  // namespace

void AddSubmit(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "submit", "Send scenes to a server and return at once", kSubmitExamples);
  const auto options = std::make_shared<SubmitOptions>();
  command->add_option("SCENE", options->paths, "The scene files (JSON, see `fascicle schema`); a job for each")
      ->required();
  AddSetOption(*command, options->scene.settings);
  AddSweepOption(*command, options->sweeps);
  AddStartOption(*command, options->scene);
  command->add_option("--threads", options->threads, "Number of threads; 0: the server's default")
      ->check(CLI::Range(0, 256));
  AddJobOptions(*command, options->settings);
  command->add_option("--owner", options->owner, "Who submits it; there is no login: servers believe it")
      ->type_name("NAME")
      ->default_str("this user");
  command->add_flag("--pin", options->pin, "Keep it until somebody deletes it");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Submit(*options, context); }; });
}

}  // namespace fascicle::client
