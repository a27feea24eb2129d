#ifndef FASCICLE_CORE_SIM_CONTROL_SOURCE_H_
#define FASCICLE_CORE_SIM_CONTROL_SOURCE_H_

#include <optional>
#include <vector>

#include "core/base/archive.h"
#include "core/scene/controls.h"
#include "core/sim/bone_motions.h"
#include "core/sim/steering.h"

namespace fascicle {

// Evaluates the controls of a scene: its curves, its skeleton's motion, the dynamics of its muscles, which are
// integrated with the run, and what inputs change. The latter two are part of its checkpoints. Not thread-safe.
class ControlSource {
 public:
  // CheckScene must have accepted the scene, which must outlive the source.
  explicit ControlSource(const Scene& scene);

  // Sets all controls to their values at a time [s], which must not precede that of the last DiscardBefore. Does not
  // allocate if `controls` already has the scene's sizes and no muscle has dynamics.
  void Evaluate(double time, Controls& controls);
  Controls At(double time);

  // Changes controls from a time on [s], which must not precede that of the last step.
  void Steer(const SteeringInput& input, double time) { steering_.Add(input, time); }

  // Whether all controls are constant from a time on [s].
  bool RestsAt(double time);
  // Frees memory; earlier times [s] must not be evaluated any more.
  void DiscardBefore(double time);

  void Save(ArchiveWriter& archive) const;
  // Sets failed() of the archive if it belongs to another scene.
  void Load(ArchiveReader& archive);

 private:
  // Calls call(curve) for all activations and forces that are integrated.
  template <class Self, class Call>
  static void ForLazy(Self& self, const Call& call);
  void ApplySteering(double time, Controls& controls) const;

  const Scene* scene_;
  double curves_end_;
  std::vector<std::optional<IntegratedActivation>> activations_;  // of each body with an excitation
  std::vector<std::optional<SternForce>> pulls_;                  // of each load that is a muscle's force
  std::optional<BoneMotions> bones_;                              // if constraints follow any
  SteeringTable steering_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_CONTROL_SOURCE_H_
