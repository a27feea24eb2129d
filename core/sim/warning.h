#ifndef FASCICLE_CORE_SIM_WARNING_H_
#define FASCICLE_CORE_SIM_WARNING_H_

#include <cstdint>
#include <string>
#include <vector>

namespace fascicle {

// What makes a result doubtful although the run went on. Reasons: VOLUME_RATIO FIBRE_STRETCH STRAIN ENERGY LARGE_STEP.
struct Warning {
  std::string reason;
  std::string message;
  std::string advice;
  double time = 0;                     // when it was worst [s]
  std::string body;                    // its name; empty when none in particular
  std::vector<std::int64_t> elements;  // of the body; may be empty
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_WARNING_H_
