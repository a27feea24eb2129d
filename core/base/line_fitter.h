#ifndef FASCICLE_CORE_BASE_LINE_FITTER_H_
#define FASCICLE_CORE_BASE_LINE_FITTER_H_

#include <algorithm>
#include <limits>
#include <utility>

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

  Curve Finish() {
    if (time_ > curve_.times.back()) Push(time_, value_);
    return std::move(curve_);
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
