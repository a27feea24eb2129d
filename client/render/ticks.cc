#include "client/render/ticks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fascicle::client {
namespace {

std::string TickLabel(double value, double step) {
  char text[64];
  const double largest = std::abs(value);
  if (largest >= 1e6 || step < 1e-6) {
    std::snprintf(text, sizeof text, "%.8g", value);
  } else {
    std::snprintf(text, sizeof text, "%.*f", std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9))),
                  value);
  }
  return text;
}

}  // namespace

Ticks RoundTicks(double lowest, double highest, int most) {
  Ticks ticks;
  if (!std::isfinite(lowest) || !std::isfinite(highest) || !(lowest < highest) || most < 2) return ticks;
  const double range = highest - lowest;
  // Ends that are round up to round-off count as inside.
  const double slack = 1e-9 * range;
  const auto first = [&](double step) { return std::ceil((lowest - slack) / step); };
  const auto last = [&](double step) { return std::floor((highest + slack) / step); };
  double power = std::pow(10, std::floor(std::log10(range / most)));
  double step = power;
  for (int i = 0; last(step) - first(step) + 1 > most; ++i) {
    constexpr double kFactors[3] = {2, 5, 10};
    step = kFactors[i % 3] * power;
    if (i % 3 == 2) power *= 10;
  }
  for (double k = first(step); k <= last(step); ++k) {
    const double place = k == 0 ? 0 : std::clamp(k * step, lowest, highest);
    ticks.places.push_back(place);
    ticks.labels.push_back(TickLabel(place, step));
  }
  return ticks;
}

}  // namespace fascicle::client
