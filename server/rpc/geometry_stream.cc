#include "server/rpc/geometry_stream.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "fascicle/v1/simulation_service.pb.h"
#include "server/rpc/chunk_message.h"
#include "server/rpc/names.h"

namespace fascicle::server {

bool GeometryStream::Load() {
  if (!following_) {
    const std::optional<std::string> id = ParseJobName(job_name_);
    if (!id) {
      Complete(InvalidArgument("name", "must be jobs/{id}"));
      return false;
    }
    job_id_ = *id;
    Follow(job_id_);  // before the first check, so that no change is missed
    following_ = true;
  }
  // The state is read before the geometry: a job in a final state has stored it, if ever.
  const std::optional<JobView> view = context_.jobs.Get(job_id_);
  const std::shared_ptr<FrameStore> frames = view ? context_.jobs.Frames(job_id_) : nullptr;
  if (!frames) {
    Complete(NotFound("job", job_name_));
    return false;
  }
  size_ = frames->GeometrySize();
  if (size_) {
    frames_ = frames;
    return true;
  }
  if (view->record.first_frame > 0) {
    Complete(NotFound("geometry", job_name_));  // removed with the frames
  } else if (IsFinal(view->record.state)) {
    Complete(FailedPrecondition("NO_GEOMETRY", {job_name_}, "the job ended before it was started"));
  }
  return false;
}

void GeometryStream::Fill() {
  if (!frames_ && !Load()) return;
  while (HasRoom()) {
    std::optional<std::string> bytes = frames_->ReadGeometryChunk(sent_ / FrameStore::kChunkSize);
    if (!bytes) throw DamageError("the geometry of " + job_name_ + " is incomplete");
    ChunkSource source;
    source.offset = sent_;
    source.size = bytes->size();
    source.bytes = std::make_shared<const std::string>(std::move(*bytes));
    sent_ += static_cast<std::int64_t>(source.size);
    source.last = sent_ >= *size_;
    Push(ChunkMessage(v1::GetGeometryResponse::kChunkFieldNumber, source));
    if (source.last) Complete(grpc::Status::OK);
  }
}

}  // namespace fascicle::server
