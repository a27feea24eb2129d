#include <iostream>
#include <memory>
#include <optional>
#include <set>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "client/cli/frame_options.h"
#include "client/cli/interrupts.h"
#include "client/cli/job_source.h"
#include "client/export/csv.h"
#include "client/export/vtk_series.h"
#include "client/lib/decode.h"
#include "client/lib/replace_file.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExportExamples =
    R"(  fascicle export 3f2a --out results                  frames.pvd with its .vtu and .vtp files, and series.csv
  fascicle export 3f2a --out results --format csv     only the table
  fascicle export out --out results                   the job of the run that wrote the folder out
  fascicle export 3f2a --database 3f2a.fascicle       the whole job as one SQLite file, for `fascicle import-job`
  fascicle export 3f2a --out results --from 10 --to 20 --every 2
  fascicle export 3f2a --out results --fields cauchy_stress --encoding quantized16 --compress   over a slow network
)";

struct ExportOptions {
  std::string job;
  std::string database;
  std::string out;
  std::vector<std::string> formats = {"vtk", "csv"};
  std::int64_t from = 0;
  std::optional<std::int64_t> to;
  std::int64_t every = 1;
  FrameOptions frames;
};

// Which frames to receive, and what of them.
WatchOptions WatchOf(const ExportOptions& options, bool vtk) {
  WatchOptions watch;
  watch.start_index = options.from;
  if (options.to) watch.end_index = *options.to + 1;
  watch.stride = options.every;
  FrameOptions frames = options.frames;
  if (!vtk && frames.fields.empty()) frames.fields = {"series"};
  SetFrameOptions(frames, vtk ? std::vector<std::string>{"positions", "series"} : std::vector<std::string>{"series"},
                  watch);
  return watch;
}

int ExportFrames(const ExportOptions& options, const Context& context) {
  const std::set<std::string> formats(options.formats.begin(), options.formats.end());
  JobSource source = OpenJob(context, options.job);
  std::optional<VtkSeriesWriter> writer;
  std::optional<SeriesTable> table;
  const auto on_frame = [&](const v1::Geometry& geometry, const v1::Frame& frame) {
    if (!frame.has_derivation()) CheckDigest(frame);
    if (!table) table.emplace(geometry);
    table->Add(frame);
    if (formats.contains("vtk")) {
      if (!writer) writer.emplace(geometry, options.out);
      writer->Add(frame);
    }
    return true;
  };
  const Followed followed = ReadStored(source.client, source.job, WatchOf(options, formats.contains("vtk")), on_frame);
  if (!table) {
    throw CommandError::Invalid("there is no such frame; the job has " + std::to_string(followed.job.frame_count()));
  }
  if (writer) writer->Finish();
  if (formats.contains("csv")) ReplaceFile(fs::path(options.out) / "series.csv", CsvOf(*table));
  if (context.json) {
    PrintJson({{"job", followed.job.name()}, {"out", options.out}, {"frames", table->size()}});
  } else {
    std::cout << table->size() << " frames of " << followed.job.name() << " are in " << options.out << '\n';
  }
  return kDone;
}

int ExportDatabase(const ExportOptions& options, const Context& context) {
  const StopOnInterrupt interrupts;
  JobSource source = OpenJob(context, options.job);
  Check(source.client.ExportJob(source.job, options.database, interrupts.token()));
  const auto bytes = static_cast<std::int64_t>(fs::file_size(options.database));
  if (context.json) {
    PrintJson({{"job", source.job}, {"database", options.database}, {"bytes", bytes}});
  } else {
    std::cout << source.job << " is in " << options.database << ", " << bytes
              << " bytes; `fascicle import-job` gives it to another server\n";
  }
  return kDone;
}

}  // namespace

void AddExport(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "export", "Write a job's frames as a VTK series and its series as CSV", kExportExamples);
  const auto options = std::make_shared<ExportOptions>();
  command->add_option("JOB", options->job, "The job")->required();
  CLI::Option* out = command->add_option("--out", options->out, "Folder for the files")->type_name("DIR");
  CLI::Option* database =
      command->add_option("--database", options->database, "Write the whole job as one file, for `import-job`")
          ->type_name("FILE")
          ->excludes(out);
  command->add_option("--format", options->formats, "What to write; may be repeated; both by default")
      ->check(CLI::IsMember({"vtk", "csv"}));
  command->add_option("--from", options->from, "First frame")->check(CLI::NonNegativeNumber);
  command->add_option("--to", options->to, "Last frame")->check(CLI::NonNegativeNumber);
  command->add_option("--every", options->every, "Only every n-th frame")->check(CLI::Range(1, 1000000));
  AddFrameOptions(*command, options->frames);
  for (CLI::Option* option : command->get_options([](const CLI::Option* o) { return o->nonpositional(); })) {
    const std::string name = option->get_name();
    if (name != "--help" && name != "--out" && name != "--database") database->excludes(option);
  }
  command->callback([options, &context] {
    if (options->out.empty() && options->database.empty()) throw CLI::RequiredError("--out or --database");
    context.action = [options, &context] {
      return options->database.empty() ? ExportFrames(*options, context) : ExportDatabase(*options, context);
    };
  });
}

}  // namespace fascicle::client
