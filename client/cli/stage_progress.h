#ifndef FASCICLE_CLIENT_CLI_STAGE_PROGRESS_H_
#define FASCICLE_CLIENT_CLI_STAGE_PROGRESS_H_

#include <chrono>
#include <string>

namespace fascicle::client {

// Shows on stderr how far work in this process is: a bar that is redrawn on a terminal, otherwise a line now and then.
// From one thread.
class StageProgress {
 public:
  StageProgress();
  // Clears the bar.
  ~StageProgress();
  StageProgress(const StageProgress&) = delete;
  StageProgress& operator=(const StageProgress&) = delete;

  // `fraction` of the whole is done, and what comes next.
  void Show(double fraction, const std::string& stage);

 private:
  const bool on_terminal_;
  bool drawn_ = false;
  const std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_line_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_STAGE_PROGRESS_H_
