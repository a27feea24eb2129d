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

// A job as followed from one of its frames on.
struct Followed {
  v1::Job job;
  v1::Geometry geometry;  // empty if the job ended before it had one
  SeriesTable table;
  std::optional<v1::Frame> last_frame;
  bool stopped = false;  // by a stop request, before the job was final
};

using FrameHook = std::function<void(const v1::Geometry& geometry, const v1::Frame& frame)>;

// Waits for the job to start and follows it to its end, with a progress bar on stderr. `on_frame` may be empty.
// `options` has the frames and what is received of them, the series at least. CommandError if the connection is lost or
// the job does not exist.
Followed Follow(Client& client, const std::string& job, const WatchOptions& options, const FrameHook& on_frame,
                const std::stop_token& stop);

// Reads stored frames of a job, until `on_frame` returns false. No progress bar.
Followed ReadStored(Client& client, const std::string& job, WatchOptions options,
                    const std::function<bool(const v1::Geometry& geometry, const v1::Frame& frame)>& on_frame);

// All frames from `start_index` on.
WatchOptions FramesFrom(std::int64_t start_index);

// All frames, but nothing of them except for series, poses and lines.
WatchOptions OnlySeries();

bool IsFinal(v1::Job::State state);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_FOLLOW_H_
