#include "core/tet/state.h"

#include <span>

namespace fascicle {

void TetState::Save(ArchiveWriter& archive) const {
  archive.PutDouble("time", time);
  archive.PutInt("step", step);
  archive.PutVectors("positions", positions);
  archive.PutVectors("velocities", velocities);
  archive.PutVectors("force", force);
  archive.PutVectors("accelerations", accelerations);
  archive.PutVectors("previous_positions", previous_positions);
  archive.PutVectors("previous_velocities", previous_velocities);
  archive.PutDoubles("pressures", pressures);
  if (!branches.empty()) archive.PutDoubles("branches", branches);
  archive.PutDouble("next_step", next_step);
  if (contact_firmness > 0) {
    archive.PutDouble("contact_firmness", contact_firmness);
    archive.PutDouble("contact_excess", contact_excess);
  }
  archive.PutDouble("smallest_ratio", smallest_ratio);
  archive.PutDouble("peak_kinetic", peak_kinetic);
  archive.PutDouble("time_step", time_step);
  archive.PutDouble("load_work", load_work);
  archive.PutDouble("external_work", external_work);
  archive.PutDouble("activation_work", activation_work);
  archive.PutDouble("dissipated", dissipated);
  archive.PutDouble("stable.limit", stable.limit);
  archive.PutInt("stable.found_at", stable.found_at);
  archive.PutInt("stable.interval", stable.interval);
  archive.PutDouble("stable.smallest_ratio", stable.smallest_ratio);
  archive.PutDoubles("stable.activation", stable.activation);
  archive.PutInt("cuts", cuts);
  archive.PutInt("last_cut", last_cut);
  archive.PutInt("iterations", iterations);
}

void TetState::Load(ArchiveReader& archive) {
  time = archive.GetDouble("time");
  step = archive.GetInt("step");
  archive.GetVectors("positions", std::span(positions));
  archive.GetVectors("velocities", std::span(velocities));
  archive.GetVectors("force", std::span(force));
  archive.GetVectors("accelerations", std::span(accelerations));
  archive.GetVectors("previous_positions", std::span(previous_positions));
  archive.GetVectors("previous_velocities", std::span(previous_velocities));
  archive.GetDoubles("pressures", std::span(pressures));
  if (!branches.empty()) archive.GetDoubles("branches", std::span(branches));
  next_step = archive.GetDouble("next_step");
  if (contact_firmness > 0) {
    contact_firmness = archive.GetDouble("contact_firmness");
    contact_excess = archive.GetDouble("contact_excess");
  }
  smallest_ratio = archive.GetDouble("smallest_ratio");
  peak_kinetic = archive.GetDouble("peak_kinetic");
  time_step = archive.GetDouble("time_step");
  load_work = archive.GetDouble("load_work");
  external_work = archive.GetDouble("external_work");
  activation_work = archive.GetDouble("activation_work");
  dissipated = archive.GetDouble("dissipated");
  stable.limit = archive.GetDouble("stable.limit");
  stable.found_at = archive.GetInt("stable.found_at");
  stable.interval = archive.GetInt("stable.interval");
  stable.smallest_ratio = archive.GetDouble("stable.smallest_ratio");
  archive.GetDoubles("stable.activation", std::span(stable.activation));
  cuts = static_cast<std::int32_t>(archive.GetInt("cuts"));
  last_cut = archive.GetInt("last_cut");
  iterations = archive.GetInt("iterations");
}

}  // namespace fascicle
