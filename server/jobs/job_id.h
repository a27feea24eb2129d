#ifndef FASCICLE_SERVER_JOBS_JOB_ID_H_
#define FASCICLE_SERVER_JOBS_JOB_ID_H_

#include <array>
#include <cstdint>
#include <mutex>
#include <random>
#include <string>
#include <string_view>

namespace fascicle::server {

// Whether `id` is of the form that JobIdGenerator gives, and made at or before this time.
bool IsPastJobId(std::string_view id, std::int64_t unix_time_ms);

// Generates identifiers that sort by creation time: 26 digits of Crockford's base 32 (0-9a-z without i, l, o, u), 10
// for the milliseconds since the Unix epoch and 16 random ones, like a lower-case ULID. Each id is greater than the one
// before, within a millisecond and after the clock was set back, too. Thread-safe.
class JobIdGenerator {
 public:
  // All ids will be greater than `newest`, which may be empty or invalid: no bound.
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
