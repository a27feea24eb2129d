#ifndef FASCICLE_CORE_SIM_RUN_WARNINGS_H_
#define FASCICLE_CORE_SIM_RUN_WARNINGS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/archive.h"
#include "core/scene/scene.h"
#include "core/sim/frame.h"
#include "core/sim/method_run.h"
#include "core/sim/warning.h"

namespace fascicle {

// Looks at every frame for what laws and methods are not made for, and keeps the worst of each kind and body. Its state
// belongs to checkpoints, so that a restarted run warns of the same. Not thread-safe.
class RunWarnings {
 public:
  // The scene must outlive the object.
  RunWarnings(const Scene& scene, const std::vector<SeriesInfo>& series);

  // After each frame, with the controls as for MethodRun::MeasureBodies.
  void ObserveFrame(const Frame& frame, const MethodRun& method, const Controls& now, const Controls& later);
  // After each step that ends at `time` [s].
  void ObserveStep(const StepOutcome& step, double time);

  std::vector<Warning> List() const;

  void Save(ArchiveWriter& archive) const;
  void Load(ArchiveReader& archive);

 private:
  // What is watched of the elements of each body.
  enum class Quantity { kVolumeRatio, kFibreStretch, kStrain };
  struct Extreme {
    double value = 0, time = 0;
    std::int64_t element = -1;  // none in particular
    bool seen = false;
  };
  struct Watch {
    std::size_t body = 0;
    Quantity quantity = Quantity::kVolumeRatio;
    Extreme lowest, highest;
  };
  // A contact: the column of its relative depth.
  struct ContactWatch {
    std::string name;
    std::size_t column = 0;
    Extreme deepest;
  };
  // Columns of Frame::series whose sum must not change, with their signs.
  struct Term {
    std::size_t column = 0;
    double sign = 1;
  };

  void ObserveElements(Watch& watch, const std::vector<double>& values, double time);
  void ObserveEnergy(const Frame& frame);
  void AddRange(const Watch& watch, std::vector<Warning>& warnings) const;
  std::optional<Warning> EnergyWarning() const;
  std::optional<Warning> StepWarning() const;
  void ObserveContact(const Frame& frame);
  template <class Self, class Visit>
  static void VisitNumbers(Self& self, const Visit& visit);

  const Scene* scene_;
  std::vector<Watch> watches_;
  std::vector<ContactWatch> contacts_;
  std::vector<Term> balance_;                                            // empty: not judged
  double energy_at_start_ = 0, gap_ = 0, gap_time_ = 0, exchanged_ = 0;  // [J], [s]
  bool has_start_ = false;
  Extreme step_;  // the largest logarithmic strain of a step
  std::size_t step_body_ = 0;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_RUN_WARNINGS_H_
