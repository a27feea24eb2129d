#include "server/jobs/job_id.h"

#include <algorithm>

namespace fascicle::server {
namespace {

constexpr std::string_view kAlphabet = "0123456789abcdefghjkmnpqrstvwxyz";

constexpr std::size_t kIdLength = 26, kTimeLength = 10;

}  // namespace

bool IsPastJobId(std::string_view id, std::int64_t unix_time_ms) {
  if (id.size() != kIdLength || id.find_first_not_of(kAlphabet) != std::string_view::npos) return false;
  std::int64_t time = 0;
  for (const char digit : id.substr(0, kTimeLength)) {
    time = time << 5 | static_cast<std::int64_t>(kAlphabet.find(digit));
  }
  return time <= unix_time_ms;
}

JobIdGenerator::JobIdGenerator(std::string_view newest) {
  if (newest.size() != kDigits || newest.find_first_not_of(kAlphabet) != std::string_view::npos) return;
  for (std::size_t i = 0; i < last_.size(); ++i) last_[i] = static_cast<std::uint8_t>(kAlphabet.find(newest[i]));
}

std::string JobIdGenerator::Next(std::int64_t unix_time_ms) {
  const std::lock_guard lock(mutex_);
  std::array<std::uint8_t, kDigits> next = {};
  for (int i = kTimeDigits; i-- > 0; unix_time_ms >>= 5) next[static_cast<std::size_t>(i)] = unix_time_ms & 31;
  const bool is_later = std::lexicographical_compare(last_.begin(), last_.begin() + kTimeDigits, next.begin(),
                                                     next.begin() + kTimeDigits);
  if (is_later) {
    for (std::size_t i = kTimeDigits; i < next.size(); ++i) next[i] = random_() & 31;
  } else {
    next = last_;  // the same millisecond, or the clock was set back: increment
    for (std::size_t i = next.size(); i-- > 0;) {
      next[i] = (next[i] + 1) & 31;
      if (next[i] != 0) break;
    }
  }
  last_ = next;
  std::string id;
  for (std::uint8_t digit : next) id.push_back(kAlphabet[digit]);
  return id;
}

}  // namespace fascicle::server
