#include "client/cli/stage_progress.h"

#include <unistd.h>

#include <cstdio>

#include "client/cli/progress_bar.h"

namespace fascicle::client {
namespace {

constexpr std::chrono::seconds kBetweenStageLines{5};
constexpr int kStageBarWidth = 20;

}  // namespace

StageProgress::StageProgress()
    : on_terminal_(isatty(STDERR_FILENO) != 0), start_(std::chrono::steady_clock::now()), last_line_(start_) {}

StageProgress::~StageProgress() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
}

void StageProgress::Show(double fraction, const std::string& stage) {
  const auto now = std::chrono::steady_clock::now();
  if (!on_terminal_ && now - last_line_ < kBetweenStageLines) return;
  last_line_ = now;
  std::string text = stage;
  if (on_terminal_) {
    text += " [";
    for (int i = 0; i < kStageBarWidth; ++i) text += (i + 0.5) / kStageBarWidth <= fraction ? "█" : "░";
    text += "]";
  }
  text += " " + std::to_string(static_cast<int>(100 * fraction)) + " %";
  if (fraction > 0 && fraction < 1) {
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    text += "  ETA " + DurationText(elapsed * (1 - fraction) / fraction);
  }
  std::fprintf(stderr, on_terminal_ ? "\r%s\x1b[K" : "%s\n", text.c_str());
  std::fflush(stderr);
  drawn_ = on_terminal_;
}

}  // namespace fascicle::client
