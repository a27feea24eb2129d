#include "client/lib/submit_all.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>
#include <utility>

#include "client/lib/status_error.h"

namespace fascicle::client {
namespace {

// A message may have 4 MiB; a batch is checked within a second.
constexpr std::size_t kMostBytes = 3 << 20, kMostJobs = 200;

// How many of the first jobs fit into a batch; at least one.
std::size_t SizeOfBatch(std::span<const WantedJob> jobs) {
  std::size_t bytes = 0, count = 0;
  while (count < jobs.size() && count < kMostJobs) {
    bytes += jobs[count].job.ByteSizeLong();
    if (count > 0 && bytes > kMostBytes) break;
    ++count;
  }
  return count;
}

// "requests[2].job.scene.duration" to "c.json: duration", where the job 2 is from c.json.
std::string PathWithOrigin(std::string_view field, std::span<const WantedJob> jobs) {
  constexpr std::string_view kRequests = "requests[";
  if (!field.starts_with(kRequests)) return std::string(field);
  std::size_t index = 0;
  const char* const end = field.data() + field.size();
  const auto [after, error] = std::from_chars(field.data() + kRequests.size(), end, index);
  if (error != std::errc() || index >= jobs.size()) return std::string(field);
  std::string_view rest(after, static_cast<std::size_t>(end - after));
  rest.remove_prefix(std::min(rest.size(), std::string_view("].").size()));
  const std::string path = ScenePath(rest);
  return path.empty() ? jobs[index].origin : jobs[index].origin + ": " + path;
}

}  // namespace

std::optional<Error> SendInBatches(std::span<const WantedJob> jobs,
                                   const std::function<std::optional<Error>(std::span<const WantedJob>)>& send) {
  std::size_t most = kMostJobs;
  while (!jobs.empty()) {
    const std::size_t count = std::min(SizeOfBatch(jobs), most);
    std::optional<Error> error = send(jobs.first(count));
    if (error && error->reason == "BATCH_TOO_LARGE" && count > 1) {
      most = count / 2;
      continue;
    }
    if (error) return error;
    jobs = jobs.subspan(count);
  }
  return std::nullopt;
}

Error ErrorOfBatch(Error error, std::span<const WantedJob> jobs) {
  Problems problems;
  for (const Problem& problem : error.problems.kept()) {
    problems.Add(PathWithOrigin(problem.path, jobs), problem.message, problem.hint);
  }
  while (problems.count() < error.problems.count()) problems.Add("", "");  // counted, not kept
  if (!problems.empty()) error.message = "some of the scenes are not valid";
  error.problems = std::move(problems);
  return error;
}

}  // namespace fascicle::client
