#ifndef FASCICLE_CLIENT_CLI_PROGRESS_BAR_H_
#define FASCICLE_CLIENT_CLI_PROGRESS_BAR_H_

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "fascicle/v1/job.pb.h"

namespace fascicle::client {

// Shows the progress of a job on stderr: a bar that is redrawn on a terminal, otherwise a line from time to time.
// Thread-safe.
class ProgressBar {
 public:
  ProgressBar();
  // Clears the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  bool on_terminal() const { return on_terminal_; }
  void Show(v1::Job::State state, const v1::Progress& progress, int queue_position = 0);
  void SetFrames(std::int64_t frames);
  // Prints a separate line above the bar.
  void Say(const std::string& line);

 private:
  void Draw(bool finished);
  std::string Text(std::size_t bar_width) const;

  std::mutex mutex_;
  const bool on_terminal_;
  bool drawn_ = false;
  v1::Job::State state_ = v1::Job::STATE_UNSPECIFIED;
  v1::Progress progress_;
  int queue_position_ = 0;
  std::int64_t frames_ = 0;
  std::chrono::steady_clock::time_point last_line_;
};

// "succeeded" for STATE_SUCCEEDED.
std::string StateName(v1::Job::State state);

// "0:07", "1:02:03".
std::string DurationText(double seconds);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_PROGRESS_BAR_H_
