#ifndef FASCICLE_SERVER_JOBS_JOB_ID_H_
#define FASCICLE_SERVER_JOBS_JOB_ID_H_

#include <array>
#include <cstdint>
#include <mutex>
#include <random>
#include <string>
#include <string_view>

namespace fascicle::server {

// Makes identifiers that sort by creation: 26 digits of Crockford's base 32 (0-9a-z without i, l, o, u), 10 for the
// milliseconds since the Unix epoch and 16 at random, as a ULID in lower case. Each is greater than the one before,
// also within a millisecond and when the clock is set back. Thread-safe.
class JobIdGenerator {
 public:
  // All ids will be greater than `newest`; empty, or anything that is not an id, stands for none.
  explicit JobIdGenerator(std::string_view newest);

  std::string Next(std::int64_t unix_time_ms);

 private:
  static constexpr int kDigits = 26;
  static constexpr int kTimeDigits = 10;

  std::mutex mutex_;
  std::random_device random_;
  std::array<std::uint8_t, kDigits> last_ = {};  // values of the digits, 0 to 31
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_JOB_ID_H_
