// Writes to a store until it is killed, and reports on standard output what the store has acknowledged:
//
//   store_crash_writer DIRECTORY ROUND [AFTER DELAY SEED SYNCS]
//
// With AFTER, the power fails DELAY microseconds after the start: AFTER is then the disk (lossy_disk.h). SYNCS is
// `honoured`, or `ignored` to see that this matters.
// "J number" for a job, "F number index" for a frame of a job; store_samples.h defines their contents.
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "crash_samples.h"
#include "lossy_disk.h"
#include "server/store/store.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

void Report(const std::string& line) {
  // Short enough to be written atomically.
  if (write(STDOUT_FILENO, line.data(), line.size()) != static_cast<ssize_t>(line.size())) std::abort();
}

void WriteFrames(Store& store, int number) {
  JobRecord existing;
  store.CreateJob(SampleJob(number), &existing);
  Report("J " + std::to_string(number) + "\n");
  const std::shared_ptr<FrameStore> frames = store.OpenFrames(SampleJob(number).id);
  for (std::int64_t i = 0;; ++i) {
    const SampleFrame frame = CrashFrame(number, i);
    frames->PutFrame(frame.record, frame.bytes, CrashCheckpoint(number, i));
    Report("F " + std::to_string(number) + " " + std::to_string(i) + "\n");
  }
}

void SubmitJobs(Store& store, int first) {
  for (int number = first;; ++number) {
    JobRecord existing;
    store.CreateJob(SampleJob(number), &existing);
    Report("J " + std::to_string(number) + "\n");
  }
}

void FailLater(const std::string& directory, char** arguments) {
  UseLossyDisk(std::string(arguments[3]) == "ignored" ? Syncs::kIgnored : Syncs::kHonoured);
  std::thread([=, after = std::string(arguments[0]), delay = std::atoi(arguments[1]), seed = std::atoi(arguments[2])] {
    std::this_thread::sleep_for(std::chrono::microseconds(delay));
    CutPower(directory, after, static_cast<std::uint64_t>(seed));
    _exit(0);
  }).detach();
}

void Run(const char* directory, int round) {
  const std::unique_ptr<Store> store = OpenSqliteStore(directory);
  const int first = round * kJobsPerRound;
  std::thread frames([&] { WriteFrames(*store, first); });
  std::thread jobs([&] { SubmitJobs(*store, first + 1); });
  std::thread more_jobs([&] { SubmitJobs(*store, first + kJobsPerRound / 2); });
  frames.join();
  jobs.join();
  more_jobs.join();
}

}  // namespace
}  // namespace fascicle::server

int main(int count, char** arguments) {
  if (count > 6) fascicle::server::FailLater(arguments[1], arguments + 3);
  fascicle::server::Run(arguments[1], std::atoi(arguments[2]));
}
