#ifndef FASCICLE_CORE_BASE_LINE_FITTER_H_
#define FASCICLE_CORE_BASE_LINE_FITTER_H_

#include <algorithm>
#include <limits>

#include "core/base/archive.h"
#include "core/base/curve.h"

namespace fascicle {

// Simplifies a sequence of points to a polyline through some of them, with all others within a tolerance. A line is
// extended as long as some slope from its start passes every point closely enough.
class LineFitter {
 public:
  explicit LineFitter(double tolerance) : tolerance_(tolerance) {}

  // Times must not decrease. A point that equals the last one is ignored.
  void Add(double time, double value) {
    if (curve_.times.empty()) {
      Push(time, value);
    } else if (time == time_) {
      return;
    } else {
      const double slope = SlopeTo(time, value);
      if (slope < low_ || slope > high_) Push(time_, value_);
      low_ = std::max(low_, SlopeTo(time, value - tolerance_));
      high_ = std::min(high_, SlopeTo(time, value + tolerance_));
    }
    time_ = time;
    value_ = value;
  }

  // After the last point.
  void Finish() {
    if (time_ > curve_.times.back()) Push(time_, value_);
  }

  // The polyline so far; further points only append to it. Empty before the first point.
  const Curve& curve() const { return curve_; }

  // Removes the polyline's points before a time, except for the last of them.
  void DiscardBefore(double time) {
    const auto later = std::upper_bound(curve_.times.begin(), curve_.times.end(), time) - curve_.times.begin();
    if (later < 2) return;
    curve_.times.erase(curve_.times.begin(), curve_.times.begin() + (later - 1));
    curve_.values.erase(curve_.values.begin(), curve_.values.begin() + (later - 1));
  }

  void Save(ArchiveWriter& archive) const {
    archive.PutDoubles("times", curve_.times);
    archive.PutDoubles("values", curve_.values);
    archive.PutDouble("time", time_);
    archive.PutDouble("value", value_);
    archive.PutDouble("low", low_);
    archive.PutDouble("high", high_);
  }
  void Load(ArchiveReader& archive) {
    archive.GetDoubles("times", curve_.times);
    archive.GetDoubles("values", curve_.values);
    time_ = archive.GetDouble("time");
    value_ = archive.GetDouble("value");
    low_ = archive.GetDouble("low");
    high_ = archive.GetDouble("high");
    if (curve_.times.size() != curve_.values.size()) archive.Fail();
  }

 private:
  double SlopeTo(double time, double value) const {
    return (value - curve_.values.back()) / (time - curve_.times.back());
  }
  void Push(double time, double value) {
    curve_.times.push_back(time);
    curve_.values.push_back(value);
    low_ = -std::numeric_limits<double>::infinity();
    high_ = std::numeric_limits<double>::infinity();
  }

  double tolerance_;
  Curve curve_;
  double time_ = 0, value_ = 0;  // the last point
  double low_ = 0, high_ = 0;    // range of slopes that pass all points since the last one of the curve
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_LINE_FITTER_H_
