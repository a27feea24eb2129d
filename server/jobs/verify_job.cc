#include "server/jobs/verify_job.h"

#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "core/base/stop.h"

namespace fascicle::server {
namespace {

// Calls `read`, and notes the damage that it meets.
template <class Read>
void Note(JobCheck& check, const Read& read) {
  try {
    read();
  } catch (const DamageError& error) {
    if (check.damages.size() < kMostDamages) check.damages.emplace_back(error.what());
  }
}

void VerifyGeometry(FrameStore& frames, JobCheck& check, const std::stop_token& stop) {
  const std::int64_t size = frames.GeometrySize().value_or(0);
  std::int64_t read = 0;
  for (std::int64_t chunk = 0; read < size; ++chunk) {
    ThrowIfStopped(stop);
    const std::optional<std::string> bytes = frames.ReadGeometryChunk(chunk);
    if (!bytes || bytes->empty()) throw DamageError("the geometry is incomplete");
    read += static_cast<std::int64_t>(bytes->size());
  }
  check.bytes += read;
}

void VerifyFrame(FrameStore& frames, std::int64_t index, JobCheck& check, const std::stop_token& stop) {
  const std::vector<FrameRecord> records = frames.ListFrames(index, 1);
  const std::string name = "frame " + std::to_string(index);
  if (records.empty() || records.front().index != index) throw DamageError(name + " is missing");
  std::int64_t read = 0;
  for (std::int64_t chunk = 0; read < records.front().size; ++chunk) {
    ThrowIfStopped(stop);
    const std::optional<std::string> bytes = frames.ReadChunk(index, chunk);
    if (!bytes || bytes->empty()) throw DamageError(name + " is incomplete");
    read += static_cast<std::int64_t>(bytes->size());
  }
  check.bytes += read;
  ++check.frames;
}

void VerifyLog(FrameStore& frames, const std::stop_token& stop) {
  constexpr int kPage = 1000;
  std::vector<LogRow> lines;
  for (std::int64_t start = 0; !(lines = frames.ReadLog(start, kPage)).empty(); start = lines.back().number + 1) {
    ThrowIfStopped(stop);
  }
}

}  // namespace

JobCheck VerifyFrames(Store& store, std::string_view id, std::int64_t expected_frames, const std::stop_token& stop) {
  JobCheck check;
  std::shared_ptr<FrameStore> frames;
  Note(check, [&] { frames = store.OpenFrames(id); });
  if (frames == nullptr) return check;
  Note(check, [&] { VerifyGeometry(*frames, check, stop); });
  Note(check, [&] { frames->ListSteering(1, std::numeric_limits<int>::max()); });
  Note(check, [&] { VerifyLog(*frames, stop); });
  const std::int64_t count = std::max(frames->frame_count(), expected_frames);
  for (std::int64_t index = 0; index < count; ++index) {
    Note(check, [&] { VerifyFrame(*frames, index, check, stop); });
  }
  return check;
}

}  // namespace fascicle::server
