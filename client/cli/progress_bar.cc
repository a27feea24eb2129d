#include "client/cli/progress_bar.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/letters.h"

namespace fascicle::client {
namespace {

constexpr std::chrono::seconds kBetweenLines{5};
constexpr std::size_t kBarWidth = 30;

std::size_t TerminalWidth() {
  winsize size = {};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string Format(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

std::string StateName(v1::Job::State state) {
  std::string name = v1::Job::State_Name(state);
  if (name.starts_with("STATE_")) name.erase(0, 6);
  return Lower(name);
}

std::string DurationText(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  char text[64];
  if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%lld:%02lld", whole / 60, whole % 60);
  }
  return text;
}

ProgressBar::ProgressBar() : on_terminal_(isatty(STDERR_FILENO) != 0), last_line_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
}

void ProgressBar::Show(v1::Job::State state, const v1::Progress& progress, int queue_position) {
  const std::lock_guard lock(mutex_);
  const bool changed = state != state_;
  state_ = state;
  // Heartbeats and frames may arrive out of order.
  if (progress.fraction() >= progress_.fraction()) progress_ = progress;
  queue_position_ = queue_position;
  Draw(changed);
}

void ProgressBar::SetFrames(std::int64_t frames) {
  const std::lock_guard lock(mutex_);
  frames_ = std::max(frames_, frames);
  Draw(false);
}

void ProgressBar::Say(const std::string& line) {
  const std::lock_guard lock(mutex_);
  std::fprintf(stderr, "%s%s\n", drawn_ ? "\r\x1b[K" : "", line.c_str());
  drawn_ = false;
}

std::string ProgressBar::Text(std::size_t bar_width) const {
  std::string text = StateName(state_);
  if (state_ == v1::Job::STATE_QUEUED) return text + ", " + std::to_string(queue_position_) + " ahead of it";
  if (bar_width > 0) {
    const double filled = std::clamp(progress_.fraction(), 0.0, 1.0) * static_cast<double>(bar_width);
    text += " [";
    for (std::size_t i = 0; i < bar_width; ++i) text += static_cast<double>(i) + 0.5 <= filled ? "█" : "░";
    text += "]";
  }
  text += Format(" %3.0f %%", 100 * progress_.fraction());
  text += Format("  t = %.4g s", progress_.time());
  text += "  step " + std::to_string(progress_.step());
  if (progress_.time_step() > 0) text += Format(" of %.3g s", progress_.time_step());
  text += "  frames " + std::to_string(frames_);
  if (!progress_.waiting().empty()) return text + "  waits: " + progress_.waiting();
  if (progress_.has_eta()) {
    text += "  ETA " + DurationText(static_cast<double>(progress_.eta().seconds()) + 1e-9 * progress_.eta().nanos());
  }
  return text;
}

void ProgressBar::Draw(bool finished) {
  if (state_ == v1::Job::STATE_UNSPECIFIED) return;
  if (on_terminal_) {
    const bool wide = TerminalWidth() >= 110;
    std::fprintf(stderr, "\r%s\x1b[K", Text(wide ? kBarWidth : 12).c_str());
    std::fflush(stderr);
    drawn_ = true;
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (!finished && now - last_line_ < kBetweenLines) return;
  last_line_ = now;
  std::fprintf(stderr, "%s\n", Text(0).c_str());
}

}  // namespace fascicle::client
