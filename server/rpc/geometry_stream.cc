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
  std::optional<std::string> geometry = frames->GetGeometry();
  if (geometry) {
    bytes_ = std::make_shared<const std::string>(std::move(*geometry));
    return true;
  }
  if (IsFinal(view->record.state)) {
    Complete(FailedPrecondition("NO_GEOMETRY", {job_name_}, "the job ended before it was started"));
  }
  return false;
}

void GeometryStream::Fill() {
  if (!bytes_ && !Load()) return;
  while (HasRoom()) {
    ChunkSource source{.offset = static_cast<std::int64_t>(sent_), .bytes = bytes_, .begin = sent_};
    source.size = std::min<std::size_t>(FrameStore::kChunkSize, bytes_->size() - sent_);
    sent_ += source.size;
    source.last = sent_ == bytes_->size();
    Push(ChunkMessage(v1::GetGeometryResponse::kChunkFieldNumber, source));
    if (source.last) Complete(grpc::Status::OK);
  }
}

}  // namespace fascicle::server
