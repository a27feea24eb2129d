#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/interrupts.h"
#include "client/cli/job_source.h"
#include "client/cli/summary.h"
#include "proto/rules/enum_names.h"

namespace fascicle::client {
namespace {

constexpr const char* kLogExamples =
    R"(  fascicle log jobs/3f2a              steps, iterations, cuts and warnings of a job so far
  fascicle log 3f2a --follow          and what follows, until it has ended
  fascicle log 3f2a --tail 20         the last 20 lines

Within a frame, the first 20 steps have a line each; later lines sum up several. Of long logs, the first
1,000 and the last 20,000 lines are kept. With --follow, the exit code is that of the job; Ctrl-C leaves
it running.
)";

struct LogArguments {
  std::string job;
  bool follow = false;
  int tail = 0;
};

std::string Count(std::int64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string Number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string Sums(const v1::LogLine& line) {
  std::string text;
  if (line.iterations() > 0) text += ", " + Count(line.iterations(), "iteration");
  if (line.cuts() > 0) text += ", " + Count(line.cuts(), "cut");
  if (line.has_residual()) text += ", residual " + Number("%.2g", line.residual());
  return text;
}

std::string StepsOf(const v1::LogLine& line) {
  const std::string last = std::to_string(line.step());
  if (line.steps() <= 1) return "step " + last;
  return "steps " + std::to_string(line.step() - line.steps() + 1) + " to " + last;
}

std::string TextOf(const v1::LogLine& line) {
  const std::string time = Number("t = %.6g s", line.time());
  switch (line.kind()) {
    case v1::LogLine::KIND_STEP:
      return "  " + StepsOf(line) + ": " + time + Number(", dt %.3g s", line.time_step()) + Sums(line);
    case v1::LogLine::KIND_CUT:
      return "  step " + std::to_string(line.step() + 1) + ": " + line.text() +
             Number(" with dt %.3g s; a shorter one follows", line.time_step());
    case v1::LogLine::KIND_FRAME:
      return "frame " + std::to_string(line.frame()) + ": " + time + ", " + Count(line.steps(), "step") + Sums(line);
    case v1::LogLine::KIND_INPUT:
      return "  input " + std::to_string(line.sequence()) + " takes effect with step " + std::to_string(line.step()) +
             ", " + time;
    case v1::LogLine::KIND_WARNING:
      return "warning  " + line.text();
    case v1::LogLine::KIND_FAILURE:
      return "failure  " + line.text() + " (step " + std::to_string(line.step() + 1) + ", " + time + ")";
    default:  // of a newer server
      return line.text();
  }
}

Json JsonOf(const v1::LogLine& line) {
  Json json = {{"line", line.number()},
               {"kind", NameOf(*line.GetDescriptor()->FindEnumTypeByName("Kind")->FindValueByNumber(line.kind()))},
               {"step", line.step()},
               {"time", line.time()}};
  if (line.kind() == v1::LogLine::KIND_STEP || line.kind() == v1::LogLine::KIND_FRAME) {
    json["steps"] = line.steps();
    json["iterations"] = line.iterations();
    json["cuts"] = line.cuts();
  }
  if (line.time_step() > 0) json["time_step"] = line.time_step();
  if (line.has_residual()) json["residual"] = line.residual();
  if (line.has_frame()) json["frame"] = line.frame();
  if (line.sequence() > 0) json["sequence"] = line.sequence();
  if (!line.text().empty()) json["text"] = line.text();
  return json;
}

// Prints lines; says where some are missing.
class LinePrinter {
 public:
  explicit LinePrinter(bool json) : json_(json) {}

  void Print(const v1::LogLine& line) {
    if (json_) {
      PrintJson(JsonOf(line));
    } else {
      if (next_ >= 0 && line.number() > next_) std::cout << "  (" << line.number() - next_ << " lines were not kept)\n";
      std::cout << TextOf(line) << '\n';
    }
    std::cout.flush();  // for a reader at the other end of a pipe
    next_ = line.number() + 1;
  }

 private:
  const bool json_;
  std::int64_t next_ = -1;
};

int Log(const LogArguments& arguments, const Context& context) {
  std::stop_source interrupted;
  const Interrupts interrupts([&] { interrupted.request_stop(); });
  JobSource source = OpenJob(context, arguments.job);
  LinePrinter printer(context.json);
  Result<v1::Job> end = source.client.WatchLog(
      source.job, {arguments.tail, arguments.follow}, [&](const v1::LogLine& line) { printer.Print(line); },
      interrupted.get_token());
  if (!end.ok() && end.error().kind == Error::Kind::kStopped) return kCancelled;
  const v1::Job job = Take(std::move(end));
  if (!arguments.follow) return kDone;
  PrintState(job, context.json);
  return ExitCodeOf(job);
}

}  // namespace

void AddLog(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "log", "Show what a job has done step by step", kLogExamples);
  const auto arguments = std::make_shared<LogArguments>();
  command->add_option("JOB", arguments->job, "The job")->required();
  command->add_flag("--follow", arguments->follow, "Continue until the job has ended");
  command->add_option("--tail", arguments->tail, "Only the last lines, so many")->check(CLI::Range(1, 100'000));
  command->callback(
      [arguments, &context] { context.action = [arguments, &context] { return Log(*arguments, context); }; });
}

}  // namespace fascicle::client
