#ifndef FASCICLE_CLIENT_CLI_FOLLOW_H_
#define FASCICLE_CLIENT_CLI_FOLLOW_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "client/cli/command.h"
#include "client/lib/series_table.h"

namespace fascicle::client {

// A job as it was seen from one of its frames on.
struct Followed {
  v1::Job job;
  v1::Geometry geometry;  // empty when the job ended before it had any
  SeriesTable table;
  std::optional<v1::Frame> last_frame;
  bool stopped = false;  // by the stop request, before the job was final
};

using FrameHook = std::function<void(const v1::Geometry& geometry, const v1::Frame& frame)>;

// Waits for the job to start and follows it to its end, with a progress bar on stderr. `on_frame` may be empty.
// CommandError when the server is lost or knows no such job.
Followed Follow(Client& client, const std::string& job, std::int64_t start_index, const FrameHook& on_frame,
                const std::stop_token& stop);

// What is stored of a job, from `start_index` on; `on_frame` returns whether it wants more. No progress bar.
Followed ReadStored(Client& client, const std::string& job, std::int64_t start_index,
                    const std::function<bool(const v1::Geometry& geometry, const v1::Frame& frame)>& on_frame);

bool IsFinal(v1::Job::State state);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_FOLLOW_H_
