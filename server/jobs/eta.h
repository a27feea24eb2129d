#ifndef FASCICLE_SERVER_JOBS_ETA_H_
#define FASCICLE_SERVER_JOBS_ETA_H_

#include <chrono>
#include <optional>

namespace fascicle::server {

// Estimates the remaining time from the growth of the completed fraction. The speed is smoothed exponentially over
// about ten seconds, so that the estimate follows shorter steps without jumping. Not thread-safe.
class EtaEstimator {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  // Reports that `fraction` of the work is done at `now`. Cheap: most calls only compare times.
  void Add(double fraction, TimePoint now);
  // Remaining time from `now` [s]; negative if unknown.
  double Seconds(TimePoint now) const;

 private:
  struct Sample {
    double fraction;
    TimePoint time;
  };

  std::optional<Sample> last_;
  std::optional<double> speed_;  // [1/s]
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_ETA_H_
