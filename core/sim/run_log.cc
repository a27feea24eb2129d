#include "core/sim/run_log.h"

namespace fascicle {
namespace {

constexpr std::int64_t kEachStep = 20;  // of a frame
constexpr int kMostCutLines = 20;       // in a frame

// Whether the step with this number in its frame has a line: all of the first ones, then those of one digit and zeros.
bool HasLine(std::int64_t number) {
  if (number <= kEachStep) return true;
  std::int64_t unit = 1;
  while (number / unit >= 10) unit *= 10;
  return number % unit == 0;
}

LogLine LineAt(LogLine::Kind kind, const RunClock& now) {
  LogLine line;
  line.kind = kind;
  line.step = now.step;
  line.time = now.time;
  return line;
}

}  // namespace

void RunLog::Write(LogLine line) { sink_->PutLine(next_number_++, std::move(line)); }

void RunLog::WriteSums(LogLine line, Sums& sums) {
  line.steps = sums.steps;
  line.iterations = sums.iterations;
  line.cuts = sums.cuts;
  sums = {};
  Write(std::move(line));
}

void RunLog::AddStep(const RunClock& now, const StepOutcome& step, int cuts) {
  for (Sums* sums : {&since_line_, &since_frame_}) {
    ++sums->steps;
    sums->iterations += now.iterations - iterations_;
    sums->cuts += cuts;
  }
  iterations_ = now.iterations;
  if (!HasLine(since_frame_.steps)) return;
  LogLine line = LineAt(LogLine::Kind::kStep, now);
  line.time_step = now.time_step;
  line.residual = step.residual;
  WriteSums(std::move(line), since_line_);
}

void RunLog::AddCut(const RunClock& now, double dt, const std::string& reason) {
  if (++cut_lines_ > kMostCutLines) return;
  LogLine line = LineAt(LogLine::Kind::kCut, now);
  line.time_step = dt;
  line.text = reason;
  Write(std::move(line));
}

void RunLog::AddInputs(const RunClock& now, const std::vector<SteeringInput>& inputs) {
  for (const SteeringInput& input : inputs) {
    LogLine line = LineAt(LogLine::Kind::kInput, now);
    ++line.step;
    line.sequence = input.sequence;
    Write(std::move(line));
  }
}

void RunLog::AddFrame(const RunClock& now, std::int64_t index) {
  since_frame_.iterations += now.iterations - iterations_;  // those before the first step
  iterations_ = now.iterations;
  since_line_ = {};
  cut_lines_ = 0;
  LogLine line = LineAt(LogLine::Kind::kFrame, now);
  line.time_step = now.time_step;
  line.frame = index;
  WriteSums(std::move(line), since_frame_);
}

void RunLog::AddWarnings(const RunClock& now, const std::vector<Warning>& warnings) {
  for (const Warning& warning : warnings) {
    if (!warned_.insert({warning.reason, warning.body}).second) continue;
    LogLine line = LineAt(LogLine::Kind::kWarning, now);
    line.text = warning.reason + (warning.body.empty() ? "" : ", " + warning.body) + ": " + warning.message;
    Write(std::move(line));
  }
}

void RunLog::AddFailure(const Failure& failure) {
  LogLine line;
  line.kind = LogLine::Kind::kFailure;
  line.step = failure.step;
  line.time = failure.time;
  line.text = failure.reason + (failure.object.empty() ? "" : ", " + failure.object) + ": " + failure.message;
  Write(std::move(line));
}

void RunLog::Restore(std::int64_t lines, const RunClock& now, const std::vector<Warning>& warnings) {
  next_number_ = lines;
  iterations_ = now.iterations;
  since_line_ = since_frame_ = {};
  cut_lines_ = 0;
  warned_.clear();
  for (const Warning& warning : warnings) warned_.insert({warning.reason, warning.body});
}

}  // namespace fascicle
