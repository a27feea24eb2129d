#include "client/cli/job_table.h"

#include <algorithm>
#include <cstdio>
#include <ctime>

#include "client/cli/progress_bar.h"

namespace fascicle::client {
namespace {

// "2026-11-30 09:40" in local time; empty for an absent one.
std::string TimeText(bool is_set, const google::protobuf::Timestamp& time) {
  if (!is_set) return "";
  const std::time_t seconds = time.seconds();
  std::tm local = {};
  localtime_r(&seconds, &local);
  char text[32];
  return std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &local) > 0 ? text : "";
}

// From the start to the end, or until now; empty before the start.
std::string WallText(const v1::Job& job) {
  if (!job.has_start_time()) return "";
  const double start = static_cast<double>(job.start_time().seconds()) + 1e-9 * job.start_time().nanos();
  const double end = job.has_end_time() ? static_cast<double>(job.end_time().seconds()) + 1e-9 * job.end_time().nanos()
                                        : static_cast<double>(std::time(nullptr));
  return DurationText(end - start);
}

}  // namespace

JobTable::JobTable(const std::vector<v1::Job>& jobs) {
  for (const v1::Job& job : jobs) {
    name_width_ = std::max(name_width_, static_cast<int>(job.name().size()));
    owner_width_ = std::max(owner_width_, static_cast<int>(job.owner().size()));
  }
}

void JobTable::PrintHead() const {
  std::printf("%-*s  %-10s %-*s %5s %7s %7s  %-16s %8s  %s\n", name_width_, "job", "state", owner_width_, "owner",
              "done", "frames", "size", "created", "wall", "scene");
}

void JobTable::Print(const v1::Job& job) const {
  std::printf("%-*s  %-10s %-*s %3.0f %% %7lld %7s  %-16s %8s  %s\n", name_width_, job.name().c_str(),
              StateName(job.state()).c_str(), owner_width_, job.owner().c_str(), 100 * job.progress().fraction(),
              static_cast<long long>(job.frame_count() - job.first_frame()), SizeText(job.stored_bytes()).c_str(),
              TimeText(job.has_create_time(), job.create_time()).c_str(), WallText(job).c_str(),
              job.scene_name().c_str());
}

std::string SizeText(std::int64_t bytes) {
  double size = static_cast<double>(bytes);
  const char* unit = "B";
  for (const char* larger : {"kB", "MB", "GB", "TB"}) {
    if (size < 999.5) break;
    size /= 1000;
    unit = larger;
  }
  char text[32];
  std::snprintf(text, sizeof text, size < 9.95 && *unit != 'B' ? "%.1f %s" : "%.0f %s", size, unit);
  return text;
}

}  // namespace fascicle::client
