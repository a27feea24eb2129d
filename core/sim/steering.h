#ifndef FASCICLE_CORE_SIM_STEERING_H_
#define FASCICLE_CORE_SIM_STEERING_H_

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/base/archive.h"

namespace fascicle {

// The numbers of Controls that can be changed while a scene runs.
enum class ControlKind { kActivation, kLoad, kMotion, kGravity, kForceField };

// A new value of one of them: of an activation, its value; of the others, a factor on what the scene gives.
struct SteeredControl {
  ControlKind kind = ControlKind::kActivation;
  std::int32_t index = 0;  // in the array of Controls; 0 for gravity
  double value = 0;
};

// Changes that take effect together.
struct SteeringInput {
  std::int64_t sequence = 0;  // its number, from 1
  std::vector<SteeredControl> controls;
  double ramp = 0;  // time in which controls go from their present values to the new ones [s]
};

// Where a run gets its inputs from.
class SteeringSource {
 public:
  virtual ~SteeringSource() = default;
  // Called before each step, with its number, from 1, and the time at which it begins [s]. Returns the inputs that take
  // effect with it, each once. A run that is repeated must get the same inputs for the same steps.
  virtual std::vector<SteeringInput> Take(std::int64_t step, double time) = 0;
  // Called when the run could end early, because nothing moves any more. False if inputs for later steps are waiting;
  // otherwise there will be none.
  virtual bool TryClose() = 0;
};

// The changes of a run that have taken effect. They belong to its checkpoints. Not thread-safe.
class SteeringTable {
 public:
  bool empty() const { return changes_.empty(); }

  // An input that takes effect at `time` [s], which must not precede that of earlier ones.
  void Add(const SteeringInput& input, double time);

  struct Value {
    double value = 0, rate = 0;  // rate in 1/s
  };
  // The value of a control at a time [s], where the scene gives `own`: for factors 1 without a rate.
  Value At(ControlKind kind, std::size_t index, double time, const Value& own) const;

  // Whether all controls have reached their new values at a time [s].
  bool RestsAt(double time) const;
  // Forgets what has no effect from a time on [s].
  void DiscardBefore(double time);

  void Save(ArchiveWriter& archive) const;
  void Load(ArchiveReader& archive);

 private:
  struct Change {
    double start = 0, ramp = 0;  // [s]
    double value = 0;

    bool IsCompleteAt(double time) const { return time >= start + ramp; }
  };
  using Key = std::pair<int, std::int32_t>;  // kind and index

  // The number of changes, from the first one, that are overridden by a later one at a time.
  static std::size_t OverriddenAt(const std::vector<Change>& changes, double time);

  std::map<Key, std::vector<Change>> changes_;  // in the order of their starts
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_STEERING_H_
