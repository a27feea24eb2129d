#ifndef FASCICLE_CLIENT_RENDER_TICKS_H_
#define FASCICLE_CLIENT_RENDER_TICKS_H_

#include <string>
#include <vector>

namespace fascicle::client {

// Places of an axis or a scale with round numbers: multiples of 1, 2 or 5 times a power of ten.
struct Ticks {
  std::vector<double> places;       // ascending
  std::vector<std::string> labels;  // with the decimals that the step needs
};

// The ticks within [lowest, highest], as many as possible but at most `most` (2 or more). None if the ends are not
// finite, or not in this order.
Ticks RoundTicks(double lowest, double highest, int most);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_TICKS_H_
