#include "client/import/curves.h"

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

}  // namespace

void CurveMaker::TellOnce(std::int64_t controller, const LoadCurve& curve, const char* message) {
  if (told_.insert(controller).second) source_.Tell(Notice::Kind::kChanged, curve.node, message);
}

std::optional<CurveMaker::Points> CurveMaker::Resolve(std::int64_t controller, pugi::xml_node node) {
  const auto refuse = [&](const std::string& message, const std::string& hint) {
    source_.Fail(node, "load controller " + std::to_string(controller) + " " + message, hint);
    return std::nullopt;
  };
  const auto found = model_.curves.find(controller);
  if (found == model_.curves.end()) return refuse("does not exist", "add it to LoadData, or remove lc");
  const LoadCurve& curve = found->second;
  if (!curve.refused.empty()) return refuse("is not supported: " + curve.refused, "write it as a linear load curve");
  if (curve.times.empty()) return std::nullopt;  // already reported
  const std::size_t intervals = curve.times.size() - 1;
  const bool is_step = curve.interpolation == LoadCurve::Interpolation::kStep;
  const bool is_smooth = curve.interpolation == LoadCurve::Interpolation::kSmooth;
  const bool is_straight = curve.interpolation == LoadCurve::Interpolation::kLinear || (is_smooth && intervals < 2);
  if (intervals * (is_straight ? 1 : is_step ? 2 : kSamples) + 4 > kMaxPoints) {
    return refuse("has too many points", "a curve may have 10,000 points, and one that is smooth 500");
  }
  Points points;
  points.Add(curve.times[0], curve.values[0]);
  for (std::size_t k = 0; k < intervals; ++k) {
    const double begin = curve.times[k], end = curve.times[k + 1];
    if (is_step && curve.values[k] != curve.values[k + 1]) {
      const double ramp = begin + kRamp * (end - begin);
      if (ramp > begin && ramp < end) points.Add(ramp, curve.values[k + 1]);
    }
    for (int s = 1; !is_straight && !is_step && s < kSamples; ++s) {
      const double t = begin + (end - begin) * s / kSamples;
      if (t > points.times.back() && t < end) points.Add(t, is_smooth ? Smooth(curve, k, t) : SmoothStep(curve, k, t));
    }
    points.Add(end, curve.values[k + 1]);
  }
  if (is_step) TellOnce(controller, curve, "each step is a ramp over a millionth of its interval");
  if (!is_step && !is_straight) TellOnce(controller, curve, "replaced by 20 straight lines in each interval");
  const bool leaves = points.times.front() > 0 || points.times.back() < End();
  if (leaves && curve.extension == LoadCurve::Extension::kOther) {
    return refuse("repeats itself, which is not supported", "write all of its points up to the end of the analysis");
  }
  if (curve.extension == LoadCurve::Extension::kExtrapolate && is_straight && intervals > 0) {
    const auto& [t, v] = std::pair(points.times, points.values);
    const std::size_t n = t.size() - 1;
    if (t[n] < End()) points.Add(End(), Line(End(), t[n - 1], v[n - 1], t[n], v[n]));
    if (t[0] > 0) {
      points.values.insert(points.values.begin(), Line(0, t[0], v[0], t[1], v[1]));
      points.times.insert(points.times.begin(), 0);
    }
  } else if (leaves && curve.extension == LoadCurve::Extension::kExtrapolate && !is_step && intervals > 0) {
    return refuse("is extrapolated beyond its smooth points, which is not supported", "write points up to the end");
  }
  return points;
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
  for (const double value : curve.values()) {
    if (value >= low && value <= high) continue;
    char text[96];
    std::snprintf(text, sizeof(text), "reaches %.6g; values may be in [%g, %g]", value, low, high);
    source_.Fail(node, text, "values are those of the load curve times its factor, in SI");
    return std::nullopt;
  }
  return curve;
}

std::optional<v1::Curve> CurveMaker::Make(double factor, const std::optional<std::int64_t>& controller, double low,
                                          double high, pugi::xml_node node) {
  if (controller) {
    const auto points = Resolve(*controller, node);
    return points ? ToCurve(factor, *points, low, high, node) : std::nullopt;
  }
  return ToCurve(factor, {{0, model_.control.step_size}, {0, 1}}, low, high, node);
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
