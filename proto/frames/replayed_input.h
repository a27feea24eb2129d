#ifndef FASCICLE_PROTO_FRAMES_REPLAYED_INPUT_H_
#define FASCICLE_PROTO_FRAMES_REPLAYED_INPUT_H_

#include "fascicle/v1/steering.pb.h"

namespace fascicle {

// An accepted input as part of a job that repeats the run: for the step with which it took effect, if that is known.
inline v1::SteeringInput ReplayedInput(v1::SteeringInput accepted) {
  if (accepted.has_step()) {
    accepted.clear_at_time();
    accepted.set_at_step(accepted.step());
  }
  accepted.clear_step();
  accepted.clear_applied();
  accepted.clear_accept_time();
  return accepted;
}

}  // namespace fascicle

#endif  // FASCICLE_PROTO_FRAMES_REPLAYED_INPUT_H_
