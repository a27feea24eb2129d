#include "server/rpc/job_settings.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace fascicle::server {
namespace {

constexpr int kHighestPriority = 100;
constexpr std::size_t kMostLabels = 32;
constexpr std::size_t kLongestName = 64;
constexpr std::size_t kLongestValue = 128;
constexpr std::int64_t kLongestTtl = 315'576'000;  // ten years [s]
constexpr std::string_view kLabelPrefix = "labels.";

// Whether a text has letters, digits and some other characters only.
bool IsName(std::string_view text, std::string_view others) {
  return text.size() <= kLongestName && std::all_of(text.begin(), text.end(), [&](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                  others.find(c) != std::string_view::npos;
         });
}

void CheckLabel(const std::string& key, const std::string& value, Problems& problems) {
  const std::string path = "job.labels." + key.substr(0, kLongestName);
  if (key.empty() || !IsName(key, "._/-")) {
    problems.Add(path, "is no key of a label", "1 to 64 letters, digits and the characters . _ / -");
  }
  if (value.size() > kLongestValue) problems.Add(path, "has a value of more than 128 bytes");
  if (std::any_of(value.begin(), value.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; })) {
    problems.Add(path, "has a value with a control character");
  }
}

void CheckLabels(const v1::Job& job, Problems& problems) {
  if (job.labels_size() > static_cast<int>(kMostLabels)) problems.Add("job.labels", "are more than 32");
  for (const auto& [key, value] : job.labels()) CheckLabel(key, value, problems);
}

void CheckPriority(const v1::Job& job, Problems& problems) {
  if (job.priority() < -kHighestPriority || job.priority() > kHighestPriority) {
    problems.Add("job.priority", "must be in [-100, 100]");
  }
}

void CheckTtl(const v1::Job& job, Problems& problems) {
  const bool is_whole = job.ttl().nanos() == 0;
  if (job.ttl().seconds() < 0 || job.ttl().seconds() > kLongestTtl || !is_whole) {
    problems.Add("job.ttl", "must be a whole number of seconds in [0, 315576000]", "0 leaves it to the server");
  }
}

// The key of `labels.KEY`; empty for any other path.
std::string LabelOf(std::string_view path) {
  return path.starts_with(kLabelPrefix) ? std::string(path.substr(kLabelPrefix.size())) : std::string();
}

}  // namespace

void CheckSettings(const v1::Job& job, Problems& problems) {
  if (!IsName(job.owner(), "._@-")) {
    problems.Add("job.owner", "is no name of an owner", "up to 64 letters, digits and the characters . _ @ -");
  }
  CheckLabels(job, problems);
  CheckPriority(job, problems);
  CheckTtl(job, problems);
}

void CopySettings(const v1::Job& job, JobRecord& record) {
  record.owner = job.owner();
  record.labels = {job.labels().begin(), job.labels().end()};
  record.priority = job.priority();
  record.ttl_s = job.ttl().seconds();
  record.is_pinned = job.pinned();
}

void CheckUpdate(const v1::UpdateJobRequest& request, Problems& problems) {
  constexpr const char* kPaths = "one of labels, labels.KEY, priority, ttl, pinned";
  if (request.update_mask().paths().empty()) problems.Add("update_mask", "is missing", kPaths);
  if (request.update_mask().paths_size() > static_cast<int>(2 * kMostLabels)) {
    return problems.Add("update_mask", "has more than 64 paths");
  }
  for (int i = 0; i < request.update_mask().paths_size(); ++i) {
    const std::string& path = request.update_mask().paths(i);
    if (const std::string key = LabelOf(path); !key.empty()) {
      const auto found = request.job().labels().find(key);
      CheckLabel(key, found == request.job().labels().end() ? std::string() : found->second, problems);
    } else if (path == "labels") {
      CheckLabels(request.job(), problems);
    } else if (path == "priority") {
      CheckPriority(request.job(), problems);
    } else if (path == "ttl") {
      CheckTtl(request.job(), problems);
    } else if (path != "pinned") {
      problems.Add(IndexPath("update_mask.paths", static_cast<std::size_t>(i)), "is nothing that can be changed",
                   kPaths);
    }
  }
}

void ApplyUpdate(const v1::UpdateJobRequest& request, JobRecord& record, Problems& problems) {
  const v1::Job& job = request.job();
  JobRecord changed = record;
  for (const std::string& path : request.update_mask().paths()) {
    if (const std::string key = LabelOf(path); !key.empty()) {
      const auto found = job.labels().find(key);
      if (found == job.labels().end()) {
        changed.labels.erase(key);
      } else {
        changed.labels[key] = found->second;
      }
    }
    if (path == "labels") changed.labels = {job.labels().begin(), job.labels().end()};
    if (path == "priority") changed.priority = job.priority();
    if (path == "ttl") changed.ttl_s = job.ttl().seconds();
    if (path == "pinned") changed.is_pinned = job.pinned();
  }
  if (changed.labels.size() > kMostLabels) return problems.Add("job.labels", "are more than 32 with those it has");
  record = std::move(changed);
}

}  // namespace fascicle::server
