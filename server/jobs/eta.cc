#include "server/jobs/eta.h"

#include <algorithm>
#include <cmath>

namespace fascicle::server {
namespace {

constexpr double kSampleSeconds = 0.2;
constexpr double kSmoothingSeconds = 10;

double SecondsBetween(EtaEstimator::TimePoint from, EtaEstimator::TimePoint to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

void EtaEstimator::Add(double fraction, TimePoint now) {
  if (!last_) {
    last_ = {fraction, now};
    return;
  }
  const double elapsed = SecondsBetween(last_->time, now);
  if (elapsed < kSampleSeconds) return;
  const double speed = std::max(0.0, fraction - last_->fraction) / elapsed;
  const double weight = speed_ ? 1 - std::exp(-elapsed / kSmoothingSeconds) : 1;
  speed_ = speed_.value_or(0) + weight * (speed - speed_.value_or(0));
  last_ = {fraction, now};
}

double EtaEstimator::Seconds(TimePoint now) const {
  if (!speed_ || *speed_ <= 0) return -1;
  return std::max(0.0, (1 - last_->fraction) / *speed_ - SecondsBetween(last_->time, now));
}

}  // namespace fascicle::server
