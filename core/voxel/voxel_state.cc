#include "core/voxel/voxel_state.h"

#include <span>

namespace fascicle {

void VoxelState::Save(ArchiveWriter& archive) const {
  archive.PutDouble("time", time);
  archive.PutInt("step", step);
  archive.PutDoubles("displacement", std::span(displacement.data(), displacement.size()));
  archive.PutDoubles("previous", std::span(previous.data(), previous.size()));
  archive.PutInt("iterations", iterations);
}

void VoxelState::Load(ArchiveReader& archive) {
  time = archive.GetDouble("time");
  step = archive.GetInt("step");
  archive.GetDoubles("displacement", std::span(displacement.data(), displacement.size()));
  archive.GetDoubles("previous", std::span(previous.data(), previous.size()));
  iterations = archive.GetInt("iterations");
}

}  // namespace fascicle
