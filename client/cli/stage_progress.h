#ifndef FASCICLE_CLIENT_CLI_STAGE_PROGRESS_H_
#define FASCICLE_CLIENT_CLI_STAGE_PROGRESS_H_

#include <chrono>
#include <string>

namespace fascicle::client {

// Shows the progress of work in this process on stderr: a bar that is redrawn on a terminal, otherwise a line from time
// to time. Not thread-safe.
class StageProgress {
 public:
  StageProgress();
  // Clears the bar.
  ~StageProgress();
  StageProgress(const StageProgress&) = delete;
  StageProgress& operator=(const StageProgress&) = delete;

  // Reports the completed fraction and the next stage.
  void Show(double fraction, const std::string& stage);

 private:
  const bool on_terminal_;
  bool drawn_ = false;
  const std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_line_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_STAGE_PROGRESS_H_
