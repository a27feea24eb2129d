#include "server/rpc/start_state.h"

#include <optional>
#include <string>

#include "core/base/digest.h"
#include "fascicle/v1/frame.pb.h"
#include "server/rpc/names.h"

namespace fascicle::server {
namespace {

constexpr const char* kJob = "start.frame.job";

// All chunks, one after another. `read`: the chunk of a number, or nothing.
template <class Read>
std::string Join(const Read& read) {
  std::string bytes;
  for (std::int64_t chunk = 0; const std::optional<std::string> part = read(chunk); ++chunk) bytes += *part;
  return bytes;
}

// The serialized FrameState; nothing, with a problem, if there is no such frame.
std::optional<std::string> StateOf(Store& store, const v1::FrameStart& start, Problems& problems) {
  const std::optional<std::string> id = ParseJobName(start.job());
  if (!id || !store.GetJob(*id)) {
    problems.Add(kJob, "there is no job " + start.job() + " on this server", "`fascicle list` prints all jobs");
    return std::nullopt;
  }
  const std::shared_ptr<FrameStore> frames = store.OpenFrames(*id);
  const std::int64_t count = frames == nullptr ? 0 : frames->frame_count();
  const std::int64_t index = start.has_frame() ? start.frame() : count - 1;
  if (count == 0 || index < 0 || index >= count) {
    problems.Add(count == 0 ? kJob : "start.frame.frame",
                 start.job() + " has " + (count == 0 ? "no frames yet" : std::to_string(count) + " frames, from 0 on"));
    return std::nullopt;
  }
  v1::FrameState state;
  const std::string geometry = Join([&](std::int64_t chunk) { return frames->ReadGeometryChunk(chunk); });
  const std::string frame = Join([&](std::int64_t chunk) { return frames->ReadChunk(index, chunk); });
  if (!state.mutable_geometry()->ParseFromString(geometry) || !state.mutable_frame()->ParseFromString(frame)) {
    throw StoreError("the frames of job " + *id + " can't be read");
  }
  return state.SerializeAsString();
}

}  // namespace

void StoreStartState(Store& store, v1::Scene& scene, Problems& problems) {
  if (scene.start().frame().job().empty() || scene.start().frame().has_state()) return;
  v1::FrameStart& start = *scene.mutable_start()->mutable_frame();
  const std::optional<std::string> bytes = StateOf(store, start, problems);
  if (!bytes) return;
  const std::string digest = Hex(Sha256Of(*bytes));
  if (!store.HasAsset(digest)) {
    const auto upload = store.BeginUpload(digest, static_cast<std::int64_t>(bytes->size()));
    upload->Write(*bytes);
    if (!upload->Commit()) throw StoreError("the state of " + start.job() + " can't be stored");
  }
  start.mutable_state()->set_asset(AssetName(digest));
}

}  // namespace fascicle::server
