#include "client/import/curves.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

constexpr std::size_t kMaxPoints = 10'000;  // of a scene's curve
constexpr int kSamples = 20;                // in an interval of a curve that is not linear
constexpr double kRamp = 1e-6;              // relative to an interval that starts with a step

double Line(double t, double t0, double f0, double t1, double f1) { return f0 + (f1 - f0) * (t - t0) / (t1 - t0); }

// The parabola through three points of a curve.
double Parabola(const LoadCurve& c, std::size_t first, double t) {
  double sum = 0;
  for (std::size_t i = first; i < first + 3; ++i) {
    double weight = c.values[i];
    for (std::size_t j = first; j < first + 3; ++j) {
      if (j != i) weight *= (t - c.times[j]) / (c.times[i] - c.times[j]);
    }
    sum += weight;
  }
  return sum;
}

// Value between points k and k + 1: a blend of the parabolas through the neighbours on either side [FEBio, load curve
// "smooth"].
double Smooth(const LoadCurve& c, std::size_t k, double t) {
  const std::size_t last = c.times.size() - 2;
  if (c.times.size() < 3) return Line(t, c.times[k], c.values[k], c.times[k + 1], c.values[k + 1]);
  if (k == 0) return Parabola(c, 0, t);
  if (k == last) return Parabola(c, k - 1, t);
  return Line(t, c.times[k], Parabola(c, k - 1, t), c.times[k + 1], Parabola(c, k, t));
}

double SmoothStep(const LoadCurve& c, std::size_t k, double t) {
  const double w = (t - c.times[k]) / (c.times[k + 1] - c.times[k]);
  return c.values[k] + (c.values[k + 1] - c.values[k]) * w * w * w * (10 - 15 * w + 6 * w * w);
}

// A cubic spline through the points, whose third derivative is continuous at the second point and at the last but one
// [de Boor 1978, chapter IV, "not-a-knot"], as FEBio's spline of order 4 is. With three points a parabola.
class Spline {
 public:
  explicit Spline(const LoadCurve& c) : c_(c), second_(Eigen::VectorXd::Zero(Index(c.times.size()))) {
    const Eigen::Index n = second_.size();
    if (n < 3) return;
    if (n == 3) {
      second_.setConstant(2 * (Slope(1) - Slope(0)) / (c.times[2] - c.times[0]));
      return;
    }
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 1; i + 1 < n; ++i) {
      A(i, i - 1) = Width(i - 1);
      A(i, i) = 2 * (Width(i - 1) + Width(i));
      A(i, i + 1) = Width(i);
      right[i] = 6 * (Slope(i) - Slope(i - 1));
    }
    for (const auto& [row, k] : {std::pair(Eigen::Index{0}, Eigen::Index{0}), std::pair(n - 1, n - 3)}) {
      A(row, k) = Width(k + 1);
      A(row, k + 1) = -(Width(k) + Width(k + 1));
      A(row, k + 2) = Width(k);
    }
    second_ = A.partialPivLu().solve(right);
  }

  double At(std::size_t k, double t) const {
    const auto i = Index(k);
    const double h = Width(i), s = t - c_.times[k];
    const double slope = Slope(i) - h * (2 * second_[i] + second_[i + 1]) / 6;
    return c_.values[k] + s * (slope + s * (second_[i] / 2 + s * (second_[i + 1] - second_[i]) / (6 * h)));
  }

 private:
  static Eigen::Index Index(std::size_t k) { return static_cast<Eigen::Index>(k); }
  double Width(Eigen::Index k) const {
    const auto i = static_cast<std::size_t>(k);
    return c_.times[i + 1] - c_.times[i];
  }
  double Slope(Eigen::Index k) const {
    const auto i = static_cast<std::size_t>(k);
    return (c_.values[i + 1] - c_.values[i]) / Width(k);
  }

  const LoadCurve& c_;
  Eigen::VectorXd second_;  // derivatives at the points
};

}  // namespace

void CurveMaker::TellOnce(std::int64_t controller, const LoadCurve& curve, const char* message) {
  if (told_.insert(controller).second) source_.Remark(Notice::Kind::kNote, curve.node, message);
}

std::optional<CurveMaker::Points> CurveMaker::Resolve(std::int64_t controller, pugi::xml_node node) {
  const auto found = model_.curves.find(controller);
  if (found != model_.curves.end() && !found->second.refused.empty()) {
    source_.Fail(node, "load controller " + std::to_string(controller) + " is not supported: " + found->second.refused,
                 "write it as a linear load curve");
    return std::nullopt;
  }
  const auto known = resolved_.find(controller);
  if (known == resolved_.end()) return resolved_.emplace(controller, Compute(controller, node)).first->second;
  return known->second;
}

std::optional<CurveMaker::Points> CurveMaker::Compute(std::int64_t controller, pugi::xml_node node) {
  const auto refuse = [&](const std::string& message, const std::string& hint) {
    source_.Fail(node, "load controller " + std::to_string(controller) + " " + message, hint);
    return std::nullopt;
  };
  const auto found = model_.curves.find(controller);
  if (found == model_.curves.end()) return refuse("does not exist", "add it to LoadData, or remove lc");
  const LoadCurve& curve = found->second;
  if (curve.times.empty() && !curve.formula) return std::nullopt;  // already reported
  if (!(End() > 0)) return std::nullopt;                           // the same
  const auto too_many = [&] {
    return refuse("has too many points", "a curve may have 10,000 points, and one that is smooth 500");
  };
  std::optional<Points> points = curve.formula ? OfFormula(controller, curve) : OfPoints(controller, curve);
  if (!points) return too_many();
  for (const double value : points->values) {
    if (!std::isfinite(value)) return refuse("is not finite", "correct its formula");
  }
  if (curve.extension == LoadCurve::Extension::kExtrapolate &&
      curve.interpolation == LoadCurve::Interpolation::kSpline &&
      (points->times.front() > 0 || points->times.back() < End())) {
    return refuse("is extrapolated beyond its spline, which is not supported", "write points up to the end");
  }
  if (!ExtendAfter(curve, *points) || !ExtendBefore(curve, *points)) return too_many();
  return points;
}

std::optional<CurveMaker::Points> CurveMaker::OfFormula(std::int64_t controller, const LoadCurve& curve) {
  constexpr double kFewest = 1000;
  const double steps = model_.control.steps;
  const double begin = curve.times.empty() ? 0 : curve.times[0], end = curve.times.empty() ? End() : curve.times[1];
  const double pieces = steps * std::ceil(kFewest / std::max(1.0, steps));
  if (!(pieces >= 1 && pieces < kMaxPoints)) return std::nullopt;
  Points points;
  for (double i = 0; i <= pieces; ++i) {
    const double t = begin + (end - begin) * (i / pieces);
    points.Add(t, curve.formula->At(t));
  }
  const auto straight = [&](std::size_t i) {
    const double line = Line(points.times[i], begin, points.values.front(), end, points.values.back());
    return std::abs(points.values[i] - line) <= 1e-12 * (std::abs(line) + std::abs(points.values.back()));
  };
  bool is_straight = true;
  for (std::size_t i = 0; i < points.times.size(); ++i) is_straight = is_straight && straight(i);
  if (is_straight) return Points{{begin, end}, {points.values.front(), points.values.back()}};
  TellOnce(controller, curve, "a formula, replaced by straight lines through its values at 1,000 or more times");
  return points;
}

std::optional<CurveMaker::Points> CurveMaker::OfPoints(std::int64_t controller, const LoadCurve& curve) {
  using enum LoadCurve::Interpolation;
  const std::size_t intervals = curve.times.size() - 1;
  const bool is_step = curve.interpolation == kStep;
  const bool is_straight =
      curve.interpolation == kLinear || (curve.interpolation != kSmoothStep && !is_step && intervals < 2);
  if (intervals * (is_straight ? 1 : is_step ? 2 : kSamples) + 4 > kMaxPoints) return std::nullopt;
  std::optional<Spline> spline;
  if (curve.interpolation == kSpline) spline.emplace(curve);
  const auto value = [&](std::size_t k, double t) {
    if (spline) return spline->At(k, t);
    return curve.interpolation == kSmooth ? Smooth(curve, k, t) : SmoothStep(curve, k, t);
  };
  Points points;
  points.Add(curve.times[0], curve.values[0]);
  for (std::size_t k = 0; k < intervals; ++k) {
    const double begin = curve.times[k], end = curve.times[k + 1];
    if (is_step && curve.values[k] != curve.values[k + 1]) {
      const double ramp = begin + kRamp * (end - begin);
      if (ramp > begin && ramp < end) points.Add(ramp, curve.values[k + 1]);
    }
    if (!is_straight && !is_step) {
      for (const double t : SampleTimes(curve, k)) points.Add(t, value(k, t));
    }
    points.Add(end, curve.values[k + 1]);
  }
  if (is_step) TellOnce(controller, curve, "each step is a ramp over a millionth of its interval");
  if (!is_step && !is_straight) {
    TellOnce(controller, curve, "replaced by straight lines: at least 20 in each interval, exact at the time steps");
  }
  return points.times.size() > kMaxPoints ? std::nullopt : std::optional(points);
}

std::vector<double> CurveMaker::SampleTimes(const LoadCurve& curve, std::size_t k) const {
  const double begin = curve.times[k], end = curve.times[k + 1], step = model_.control.step_size;
  std::vector<double> times;
  // FEBio extrapolates along the chord over the first and the last thousandth of a curve.
  const double thousandth = 1e-3 * (curve.times.back() - curve.times.front());
  for (const double t : {curve.times.front() + thousandth, curve.times.back() - thousandth}) {
    if (curve.extension == LoadCurve::Extension::kExtrapolate && t > begin && t < end) times.push_back(t);
  }
  for (int s = 1; s < kSamples; ++s) times.push_back(begin + (end - begin) * s / kSamples);
  const double first = std::floor(std::max(0.0, begin) / step) + 1, last = std::min(model_.control.steps, end / step);
  if (last - first < kMaxPoints) {
    for (double n = first; n <= last; ++n) times.push_back(n * step);
  }
  std::sort(times.begin(), times.end());
  const double least = 1e-9 * (end - begin);
  std::vector<double> distinct;
  for (const double t : times) {
    if (t - (distinct.empty() ? begin : distinct.back()) > least && end - t > least) distinct.push_back(t);
  }
  return distinct;
}

bool CurveMaker::ExtendAfter(const LoadCurve& curve, Points& points) const {
  using enum LoadCurve::Extension;
  const Points base = points;
  const std::size_t n = base.times.size() - 1;
  const double end = base.times[n], period = end - base.times[0];
  if (end >= End() || n == 0) return true;
  if (curve.extension == kZero && base.values[n] != 0) points.AddLater(end + kRamp * period, 0);
  if (curve.extension == kExtrapolate && MayExtrapolate(curve)) {
    points.Add(End(), Line(End(), base.times[n - 1], base.values[n - 1], end, base.values[n]));
  }
  if (curve.extension != kRepeat && curve.extension != kRepeatOffset) return true;
  const double copies = std::ceil((End() - end) / period);
  if (copies * static_cast<double>(n + 1) > static_cast<double>(kMaxPoints)) return false;
  for (double k = 1; k <= copies; ++k) {
    const double offset = curve.extension == kRepeatOffset ? k * (base.values[n] - base.values[0]) : 0;
    const double start = points.times.back();
    if (base.values[0] + offset != points.values.back())
      points.AddLater(start + kRamp * period, base.values[0] + offset);
    for (std::size_t i = 1; i <= n; ++i) {
      points.AddLater(base.times[i] + k * period, base.values[i] + offset);
    }
  }
  return true;
}

bool CurveMaker::ExtendBefore(const LoadCurve& curve, Points& points) const {
  using enum LoadCurve::Extension;
  const double begin = points.times.front();
  if (!(begin > 0) || points.times.size() < 2) return true;
  // The curve is reversed in time and extended at its end.
  LoadCurve mirrored;
  mirrored.extension = curve.extension_before;
  mirrored.interpolation = curve.interpolation;
  const std::size_t own = curve.times.size();
  Points base;
  for (std::size_t i = points.times.size(); i-- > 0;) {
    if (own > 0 && points.times[i] > curve.times.back()) continue;  // added after the last point
    base.Add(End() - points.times[i], points.values[i]);
  }
  const std::size_t count = base.times.size();
  if (count < 2) return true;
  if (!ExtendAfter(mirrored, base)) return false;
  Points all;
  for (std::size_t i = base.times.size(); i-- > count;) all.Add(End() - base.times[i], base.values[i]);
  for (std::size_t i = 0; i < points.times.size(); ++i) all.Add(points.times[i], points.values[i]);
  points = std::move(all);
  return points.times.size() <= kMaxPoints;
}

bool CurveMaker::MayExtrapolate(const LoadCurve& curve) {
  return curve.interpolation == LoadCurve::Interpolation::kLinear ||
         curve.interpolation == LoadCurve::Interpolation::kSmooth;
}

std::optional<v1::Curve> CurveMaker::ToCurve(double factor, const Points& points, double low, double high,
                                             pugi::xml_node node) {
  v1::Curve curve;
  const auto add = [&](double time, double value) {
    curve.add_times(time);
    curve.add_values(value);
  };
  for (std::size_t i = 0; i < points.times.size(); ++i) {
    const double t = points.times[i], value = factor * points.values[i];
    // A scene starts at time 0.
    const bool is_before = i + 1 < points.times.size() && points.times[i + 1] <= 0;
    if (t < 0 && is_before) continue;
    if (t < 0 && i + 1 < points.times.size()) {
      add(0, Line(0, t, value, points.times[i + 1], factor * points.values[i + 1]));
    } else {
      add(std::max(t, 0.0), value);
    }
  }
  return InRange(curve, low, high, node) ? std::optional(curve) : std::nullopt;
}

bool CurveMaker::InRange(const v1::Curve& curve, double low, double high, pugi::xml_node node) {
  for (const double value : curve.values()) {
    if (value >= low && value <= high) continue;
    char text[96];
    std::snprintf(text, sizeof(text), "reaches %.6g; values may be in [%g, %g]", value, low, high);
    source_.Fail(node, text, "values are those of the load curve times its factor, in SI");
    return false;
  }
  return true;
}

std::optional<v1::Curve> CurveMaker::Make(double factor, const std::optional<std::int64_t>& controller, double low,
                                          double high, pugi::xml_node node) {
  if (controller) {
    const auto points = Resolve(*controller, node);
    return points ? ToCurve(factor, *points, low, high, node) : std::nullopt;
  }
  return ToCurve(factor, {{0, model_.control.step_size}, {0, 1}}, low, high, node);
}

double CurveMaker::Largest(const Driven& driven) {
  if (!driven.controller) return driven.value;
  const auto found = model_.curves.find(*driven.controller);
  if (found == model_.curves.end() || !found->second.refused.empty()) return 0;  // reported where it is used
  const auto points = Resolve(*driven.controller, driven.node);
  double largest = 0;
  if (points) {
    for (const double value : points->values) largest = std::max(largest, driven.value * value);
  }
  return largest;
}

std::optional<v1::Curve> CurveMaker::MakeActivation(double factor, const std::optional<std::int64_t>& controller,
                                                    pugi::xml_node node) {
  constexpr double kAny = 1e300;
  auto curve = Make(factor, controller, -kAny, kAny, node);
  if (!curve) return curve;
  double lowest = 0;
  for (double& value : *curve->mutable_values()) {
    lowest = std::min(lowest, value);
    value = std::max(value, 0.0);
    if (value > 1 && value < 1 + 1e-12) value = 1;  // rounded
  }
  if (lowest < 0) {
    char text[96];
    std::snprintf(text, sizeof(text), "falls to %.3g; activations below 0 are taken as 0", lowest);
    source_.Remark(Notice::Kind::kNote, node, text);
  }
  return InRange(*curve, 0, 1, node) ? curve : std::nullopt;
}

std::optional<v1::Curve> CurveMaker::MakeMotion(double factor, const std::optional<std::int64_t>& controller,
                                                double low, double high, pugi::xml_node node) {
  auto curve = Make(factor, controller, low, high, node);
  if (!curve || curve->values_size() == 0) return curve;
  const double step = model_.control.step_size;
  if (curve->values(0) == 0 || !(step > 0)) return curve;
  // The curve's value at the end of the first step, and the curve after it.
  v1::Curve started;
  const auto add = [&](double time, double value) {
    started.add_times(time);
    started.add_values(value);
  };
  add(0, 0);
  int k = 0;
  while (k < curve->times_size() && curve->times(k) <= step) ++k;
  const int before = k - 1;
  if (before < 0) {
    add(step, curve->values(0));
  } else if (k == curve->times_size()) {
    add(step, curve->values(before));
  } else {
    add(step, Line(step, curve->times(before), curve->values(before), curve->times(k), curve->values(k)));
  }
  for (; k < curve->times_size(); ++k) add(curve->times(k), curve->values(k));
  return started;
}

}  // namespace fascicle::client
