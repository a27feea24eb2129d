#include "core/materials/muscle_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>

#include "core/materials/gauss_integral.h"

namespace fascicle {
namespace {

// --- Published curves ---

struct Point {
  double value, slope;
};

std::vector<double> Uniform(double low, double high, int points) {
  std::vector<double> at;
  for (int i = 0; i < points; ++i) at.push_back(low + (high - low) * i / (points - 1));
  return at;
}

// The cubic through points of f, with its slopes; zero slope at the first point, and at the last one unless a line
// follows.
template <class Function>
PointCurve Sampled(const Function& f, const std::vector<double>& at, PointCurve::Beyond beyond) {
  std::vector<double> values, slopes;
  for (const double x : at) {
    const Point p = f(x);
    values.push_back(p.value);
    slopes.push_back(p.slope);
  }
  slopes.front() = 0;
  if (beyond == PointCurve::Beyond::kConstant) slopes.back() = 0;
  return {at, values, slopes};
}

// (exp(k (r - 1)/strain) - 1)/(exp k - 1): 0 at r = 1, 1 at r = 1 + strain.
PointCurve ExponentialPassive(double shape, double strain) {
  const double rate = shape / strain;
  const auto f = [&](double r) {
    return Point{std::expm1(rate * (r - 1)) / std::expm1(shape), rate * std::exp(rate * (r - 1)) / std::expm1(shape)};
  };
  return Sampled(f, Uniform(1, 1 + strain, PointCurve::kMostPoints), PointCurve::Beyond::kLine);
}

MuscleCurves Thelen() {
  constexpr double kWidth = 0.45, kHill = 0.25, kPlateau = 1.4;
  const auto active = [&](double r) {
    const double value = std::exp(-(r - 1) * (r - 1) / kWidth);
    return Point{value, -2 * (r - 1) / kWidth * value};
  };
  // Shortening and lengthening, solved for the force. The slope jumps from 5 to 10 at zero; here it is 5.
  const auto velocity = [&](double v) {
    if (v <= 0) {
      const double denominator = 1 - v / kHill;
      return Point{(1 + v) / denominator, (1 + 1 / kHill) / (denominator * denominator)};
    }
    const double c = (2 + 2 / kHill) / (kPlateau - 1);  // v = (F - 1)/(c (plateau - F))
    return Point{(1 + c * v * kPlateau) / (1 + c * v), c * (kPlateau - 1) / ((1 + c * v) * (1 + c * v))};
  };
  const std::vector<double> velocities = {-1.0,  -0.9,   -0.8,  -0.7, -0.6,  -0.5,  -0.4,  -0.32, -0.25, -0.19, -0.14,
                                          -0.1,  -0.065, -0.03, 0.0,  0.005, 0.011, 0.018, 0.027, 0.038, 0.052, 0.07,
                                          0.094, 0.125,  0.17,  0.22, 0.29,  0.4,   0.6,   1.0,   1.8,   4.0};
  // The curve is not flat at short lengths: a short first piece rounds it off.
  std::vector<double> lengths = Uniform(0.12, 2.4, PointCurve::kMostPoints - 1);
  lengths.insert(lengths.begin(), 0.1);
  return {Sampled(active, lengths, PointCurve::Beyond::kConstant), ExponentialPassive(5, 0.6),
          Sampled(velocity, velocities, PointCurve::Beyond::kConstant), CurveStress::kForce};
}

MuscleCurves DeGroote() {
  struct Gaussian {
    double height, centre, width, width_slope;
  };
  constexpr Gaussian kGaussians[] = {{0.8150671134243542, 1.055033428970575, 0.162384573599574, 0.063303448465465},
                                     {0.433004984392647, 0.716775413397760, -0.029947116970696, 0.200356847296188},
                                     {0.1, 1.0, 0.353553390593274, 0}};
  const auto active = [&](double r) {
    Point sum = {0, 0};
    for (const Gaussian& g : kGaussians) {
      const double width = g.width + g.width_slope * r, z = (r - g.centre) / width;
      const double value = g.height * std::exp(-0.5 * z * z);
      sum.value += value;
      sum.slope -= value * z * (1 - z * g.width_slope) / width;
    }
    return sum;
  };
  constexpr double kD1 = -0.3211346127989808, kD2 = -8.149, kD3 = -0.374, kD4 = 0.8825327733249912;
  // Exactly one at velocity zero, a point of the table.
  const auto velocity = [&](double v) {
    const double z = kD2 * v + kD3;
    return Point{v == 0 ? 1 : kD1 * std::asinh(z) + kD4, kD1 * kD2 / std::sqrt(z * z + 1)};
  };
  return {Sampled(active, Uniform(0.3, 1.9, PointCurve::kMostPoints), PointCurve::Beyond::kConstant),
          ExponentialPassive(4, 0.6),
          Sampled(velocity, Uniform(-1, 1, PointCurve::kMostPoints), PointCurve::Beyond::kConstant),
          CurveStress::kForce};
}

MuscleCurves Almonacid() {
  struct Sine {
    double height, frequency, phase;
  };
  constexpr Sine kSines[] = {{0.642587074375392, 1.290128342448810, 0.629168420414746},
                             {0.325979591577056, 5.308969899884336, -4.520101562237307},
                             {0.328204247867325, 6.744187042136006, 1.689155892259429},
                             {0.015388902741327, 19.823676877725276, -7.386155292116579},
                             {0.139240359517525, 8.038287396059996, 2.543022326676525},
                             {0.001801867529599, 32.237736486095052, -6.454098315528945},
                             {0.012560837549867, 23.117614057963024, -2.643346778503341}};
  constexpr double kLow = 0.4, kHigh = 1.75;
  // Zero where the sum is slightly negative, and at both ends.
  const auto active = [&](double r) {
    Point sum = {0, 0};
    for (const Sine& s : kSines) {
      sum.value += s.height * std::sin(s.frequency * r + s.phase);
      sum.slope += s.height * s.frequency * std::cos(s.frequency * r + s.phase);
    }
    return sum.value > 0 && r < kHigh ? sum : Point{0, 0};
  };
  constexpr std::array kVelocities = {-1.2, -0.25, 0.0, 0.05, 0.75};
  constexpr std::array kForces = {0.0, 0.3503552027590582, 1.0, 1.3743240862369306, 1.5950466421954534};
  constexpr std::array kForceSlopes = {0.0, 0.9703687419567255, 6.090887473114851, 0.9678639805763023, 0.0};
  constexpr std::array kLengths = {1.0, 1.25, 1.5, 1.65};
  constexpr std::array kStresses = {0.0, 0.1471153017268245, 0.6561181989622077, 1.1};
  constexpr std::array kStressSlopes = {0.0, 1.176922413814596, 2.8951007640684696, 3.023323249768765};
  return {Sampled(active, Uniform(kLow, kHigh, PointCurve::kMostPoints), PointCurve::Beyond::kConstant),
          PointCurve(kLengths, kStresses, kStressSlopes), PointCurve(kVelocities, kForces, kForceSlopes),
          CurveStress::kCauchy};
}

// --- A user's tables ---

// Two points that are closer than this are meant as a jump.
constexpr double kLeastDistance = 1e-3;

std::string NumberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

void CheckPositions(const CurveTable& table, const char* positions, double low, double high, Problems& problems) {
  const std::size_t n = table.at.size();
  if (n < 2 || n > PointCurve::kMostPoints) {
    problems.Add(positions, "has " + std::to_string(n) + " points",
                 "2 to " + std::to_string(PointCurve::kMostPoints) + " points");
  }
  if (table.values.size() != n) {
    problems.Add("values",
                 "has " + std::to_string(table.values.size()) + " values for " + std::to_string(n) + " points",
                 "one value for each point");
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double x = table.at[i];
    if (!(x >= low && x <= high)) {
      problems.Add(IndexPath(positions, i),
                   "is " + NumberText(x) + ", outside the range [" + NumberText(low) + ", " + NumberText(high) + "]",
                   "positions are relative to the optimal length, or to the maximum velocity of shortening");
    }
    if (i == 0) continue;
    if (!(x > table.at[i - 1]) && x != table.at[i - 1]) {
      problems.Add(IndexPath(positions, i), "is " + NumberText(x) + " after " + NumberText(table.at[i - 1]),
                   "positions must increase strictly");
    } else if (!(x - table.at[i - 1] >= kLeastDistance)) {
      problems.Add(IndexPath(positions, i),
                   "makes the curve jump: it is only " + NumberText(x - table.at[i - 1]) + " after the point before",
                   "the stress must be continuous: points are at least " + NumberText(kLeastDistance) + " apart");
    }
  }
}

void CheckValues(const CurveTable& table, bool may_fall, Problems& problems) {
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    const double y = table.values[i];
    if (!(y >= 0 && y <= 100)) {
      problems.Add(IndexPath("values", i), "is " + NumberText(y) + ", outside the range [0, 100]",
                   "values are relative to the peak stress");
    } else if (!may_fall && i > 0 && y < table.values[i - 1]) {
      problems.Add(IndexPath("values", i), "is " + NumberText(y) + ", less than the value before",
                   "this curve never falls");
    }
  }
}

PointCurve Checked(const CurveTable& table, PointCurve::Beyond beyond, const PointCurve& fallback, const Problems& own,
                   Problems& problems) {
  problems.Append("", own);
  return own.empty() ? PointCurve(table.at, table.values, beyond) : fallback;
}

}  // namespace

double MuscleCurves::ActiveWork(double from, double to, double velocity_per_length) const {
  if (!std::isfinite(from) || !std::isfinite(to)) return from - to;
  const double direction = to < from ? -1 : 1;
  const double reach = std::abs(to - from);
  const auto pull = [&](double distance) {
    const double r = from + direction * distance;
    const double f = active_length.At(r).value * force_velocity.At(velocity_per_length * direction * distance).value;
    return stress == CurveStress::kCauchy ? f / r : f;
  };
  // Both factors are cubic between these places.
  std::array<double, 2 * PointCurve::kMostPoints + 2> bends = {0, reach};
  std::size_t count = 2;
  for (const double r : active_length.at()) bends[count++] = std::clamp(direction * (r - from), 0.0, reach);
  for (const double v : force_velocity.at()) {
    bends[count++] = std::clamp(direction * v / velocity_per_length, 0.0, reach);
  }
  std::sort(bends.begin(), bends.begin() + static_cast<std::ptrdiff_t>(count));
  double sum = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if (bends[i + 1] > bends[i]) sum += GaussIntegral(bends[i], bends[i + 1], pull);
  }
  return direction * sum;
}

MuscleCurves CurvesOf(PublishedCurves set) {
  switch (set) {
    case PublishedCurves::kThelen2003:
      return Thelen();
    case PublishedCurves::kDeGroote2016:
      return DeGroote();
    case PublishedCurves::kAlmonacid2024:
      return Almonacid();
  }
  return Thelen();
}

PointCurve ActiveLengthCurve(const CurveTable& table, const PointCurve& fallback, Problems& problems) {
  Problems own;
  CheckPositions(table, "lengths", 0.01, 10, own);
  CheckValues(table, true, own);
  return Checked(table, PointCurve::Beyond::kConstant, fallback, own, problems);
}

PointCurve PassiveLengthCurve(const CurveTable& table, const PointCurve& fallback, Problems& problems) {
  Problems own;
  CheckPositions(table, "lengths", 0.01, 10, own);
  CheckValues(table, false, own);
  if (!table.values.empty() && table.values[0] != 0) {
    own.Add("values[0]", "is " + NumberText(table.values[0]) + ", but shorter fibres are slack",
            "begin with the longest slack length and the value 0");
  }
  return Checked(table, PointCurve::Beyond::kLine, fallback, own, problems);
}

PointCurve VelocityCurve(const CurveTable& table, const PointCurve& fallback, Problems& problems) {
  Problems own;
  CheckPositions(table, "velocities", -10, 10, own);
  CheckValues(table, false, own);
  const auto zero = std::find(table.at.begin(), table.at.end(), 0.0);
  const auto index = static_cast<std::size_t>(zero - table.at.begin());
  if (zero == table.at.end()) {
    own.Add("velocities", "has no point at velocity 0", "an isometric fibre has velocity 0 and the value 1");
  } else if (index < table.values.size() && table.values[index] != 1) {
    own.Add(IndexPath("values", index), "is " + NumberText(table.values[index]) + " at velocity 0",
            "values are relative to the isometric stress: 1 at velocity 0");
  }
  return Checked(table, PointCurve::Beyond::kConstant, fallback, own, problems);
}

}  // namespace fascicle
