#ifndef FASCICLE_TESTS_SUPPORT_STORE_SAMPLES_H_
#define FASCICLE_TESTS_SUPPORT_STORE_SAMPLES_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "server/store/store.h"

namespace fascicle::server {

// `size` pseudo-random bytes that depend on `seed`.
inline std::string SampleBytes(std::uint64_t seed, std::size_t size) {
  std::string bytes(size, '\0');
  std::uint64_t state = seed * 0x9E3779B97F4A7C15u + 1;
  for (char& byte : bytes) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    byte = static_cast<char>(state >> 24);
  }
  return bytes;
}

// A job with a value in every field.
inline JobRecord SampleJob(int number) {
  const std::string digits = std::to_string(1000000 + number);
  JobRecord job;
  job.id = "0000000000000000000" + digits;
  job.request_digest = SampleBytes(static_cast<std::uint64_t>(number), 32);
  job.scene_name = "scene " + digits;
  job.spec = SampleBytes(static_cast<std::uint64_t>(number) + 7, 3000);
  job.threads = 3;
  job.create_time_us = 1'700'000'000'000'000 + number;
  return job;
}

// Frame `index` of a run: `size` bytes and a digest.
struct SampleFrame {
  FrameRecord record;
  std::string bytes;
};

inline SampleFrame MakeSampleFrame(std::int64_t index, std::size_t size, std::uint64_t run = 0) {
  const std::uint64_t seed = run * 100'003 + static_cast<std::uint64_t>(index) * 17 + 3;
  SampleFrame frame;
  frame.bytes = SampleBytes(seed, size);
  frame.record = {index, 0.25 * static_cast<double>(index), 10 * index, static_cast<std::int64_t>(size),
                  SampleBytes(seed + 1, 32)};
  return frame;
}

inline bool operator==(const FrameRecord& a, const FrameRecord& b) {
  return a.index == b.index && a.time == b.time && a.step == b.step && a.size == b.size && a.digest == b.digest;
}

// All chunks of a frame, concatenated.
inline std::string ReadFrame(FrameStore& frames, std::int64_t index) {
  std::string bytes;
  for (std::int64_t chunk = 0;; ++chunk) {
    const std::optional<std::string> next = frames.ReadChunk(index, chunk);
    if (!next) return bytes;
    bytes += *next;
  }
}

// All chunks of the geometry, concatenated; nothing if there is none.
inline std::optional<std::string> ReadGeometry(FrameStore& frames) {
  if (!frames.GeometrySize()) return std::nullopt;
  std::string bytes;
  for (std::int64_t chunk = 0;; ++chunk) {
    const std::optional<std::string> next = frames.ReadGeometryChunk(chunk);
    if (!next) return bytes;
    bytes += *next;
  }
}

// The newest checkpoint; nothing if there is none.
inline std::optional<std::string> NewestCheckpoint(FrameStore& frames) {
  std::optional<CheckpointRecord> newest = frames.GetCheckpoint(frames.frame_count());
  if (!newest) return std::nullopt;
  return std::move(newest->bytes);
}

// The message of the StoreError that `action` throws; empty if it throws none.
inline std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const StoreError& error) {
    return error.what();
  }
  return {};
}

}  // namespace fascicle::server

#endif  // FASCICLE_TESTS_SUPPORT_STORE_SAMPLES_H_
