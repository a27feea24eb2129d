#include "core/sim/steering.h"

#include <algorithm>

namespace fascicle {

void SteeringTable::Add(const SteeringInput& input, double time) {
  for (const SteeredControl& control : input.controls) {
    changes_[{static_cast<int>(control.kind), control.index}].push_back({time, input.ramp, control.value});
  }
}

std::size_t SteeringTable::OverriddenAt(const std::vector<Change>& changes, double time) {
  std::size_t last = changes.size();
  while (last > 0 && !changes[last - 1].IsCompleteAt(time)) --last;
  return last > 0 ? last - 1 : 0;
}

SteeringTable::Value SteeringTable::At(ControlKind kind, std::size_t index, double time, const Value& own) const {
  const auto found = changes_.find({static_cast<int>(kind), static_cast<std::int32_t>(index)});
  if (found == changes_.end()) return own;
  Value at = own;
  const std::vector<Change>& changes = found->second;
  for (std::size_t k = OverriddenAt(changes, time); k < changes.size(); ++k) {
    const Change& change = changes[k];
    if (change.IsCompleteAt(time)) {
      at = {change.value, 0};
    } else {
      const double part = std::max(0.0, (time - change.start) / change.ramp);
      at = {at.value + part * (change.value - at.value),
            at.rate + (change.value - at.value) / change.ramp - part * at.rate};
    }
  }
  return at;
}

bool SteeringTable::RestsAt(double time) const {
  return std::all_of(changes_.begin(), changes_.end(),
                     [time](const auto& entry) { return entry.second.back().IsCompleteAt(time); });
}

void SteeringTable::DiscardBefore(double time) {
  for (auto& [key, changes] : changes_) {
    changes.erase(changes.begin(), changes.begin() + static_cast<std::ptrdiff_t>(OverriddenAt(changes, time)));
  }
}

void SteeringTable::Save(ArchiveWriter& archive) const {
  std::vector<std::int32_t> keys;
  std::vector<double> numbers;
  for (const auto& [key, changes] : changes_) {
    for (const Change& change : changes) {
      keys.insert(keys.end(), {key.first, key.second});
      numbers.insert(numbers.end(), {change.start, change.ramp, change.value});
    }
  }
  archive.PutInts("steered controls", keys);
  archive.PutDoubles("steered values", numbers);
}

void SteeringTable::Load(ArchiveReader& archive) {
  std::vector<std::int32_t> keys;
  std::vector<double> numbers;
  archive.GetInts("steered controls", keys);
  archive.GetDoubles("steered values", numbers);
  if (numbers.size() / 3 != keys.size() / 2) return archive.Fail();
  changes_.clear();
  for (std::size_t k = 0; 2 * k + 1 < keys.size(); ++k) {
    changes_[{keys[2 * k], keys[2 * k + 1]}].push_back({numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]});
  }
}

}  // namespace fascicle
