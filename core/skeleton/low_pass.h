#ifndef FASCICLE_CORE_SKELETON_LOW_PASS_H_
#define FASCICLE_CORE_SKELETON_LOW_PASS_H_

#include <vector>

namespace fascicle {

// Samples at equal intervals without what is faster than `cutoff`: a Butterworth filter of third order, once forward
// and once backward, so that nothing is delayed and the response at `cutoff` is 1/2. Both ends are continued by their
// point reflections. interval [s] > 0; 0 < cutoff [Hz] < 1 / (2 interval).
std::vector<double> LowPass(const std::vector<double>& samples, double interval, double cutoff);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_LOW_PASS_H_
