#include "server/rpc/export_stream.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/stop.h"
#include "fascicle/v1/transfer_service.pb.h"
#include "server/rpc/chunk_message.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/names.h"
#include "server/store/job_file.h"
#include "server/translate/steering.h"

namespace fascicle::server {

void ExportStream::Fill() {
  if (!file_ && !Open()) return;
  while (HasRoom()) {
    auto bytes =
        std::make_shared<std::string>(static_cast<std::size_t>(std::min(size_ - sent_, FrameStore::kChunkSize)), '\0');
    if (!in_.read(bytes->data(), static_cast<std::streamsize>(bytes->size()))) {
      throw StoreError(file_->path() + ": cannot be read");
    }
    ChunkSource source;
    source.offset = sent_;
    source.size = bytes->size();
    source.bytes = std::move(bytes);
    sent_ += static_cast<std::int64_t>(source.size);
    source.last = sent_ == size_;
    Push(ChunkMessage(v1::ExportJobResponse::kChunkFieldNumber, source));
    last_chunk_ = std::chrono::steady_clock::now();
    if (source.last) End(grpc::Status::OK);
  }
  const auto idle = std::chrono::steady_clock::now() - last_chunk_;
  if (idle >= context_.settings.transfer_idle) {
    End(Aborted("IDLE", "the export was not read for too long"));
  } else if (file_) {
    WakeAfter(std::chrono::ceil<std::chrono::milliseconds>(context_.settings.transfer_idle - idle));
  }
}

bool ExportStream::Open() {
  const std::optional<std::string> id = ParseJobName(job_name_);
  if (!id) {
    Complete(InvalidArgument("name", "must be jobs/{id}"));
    return false;
  }
  place_ = transfers_.Enter();
  if (!place_) {
    Complete(Unavailable("OVERLOADED", "too many jobs are being exported and imported", std::chrono::seconds(5)));
    return false;
  }
  const std::optional<JobView> view = context_.jobs.Get(*id);
  const std::shared_ptr<FrameStore> frames = view ? context_.jobs.Frames(*id) : nullptr;
  if (!frames) {
    Complete(NotFound("job", job_name_));
    return false;
  }
  if (frames->stored_bytes() > context_.store.Room()) {
    Complete(ResourceExhausted("DISK_FULL", job_name_, "the server's disk has no room for a file of this job"));
    return false;
  }
  auto file = std::make_unique<TransferFile>(context_.store.NewTransferPath());
  // Counted before the inputs are listed: no frame is exported without the inputs that it shows.
  const std::int64_t frame_count = frames->frame_count();
  v1::Job job = ToMessageWithScene(*view);
  const auto steering = context_.jobs.ListSteering(*id, 1, std::numeric_limits<int>::max());
  for (const SteeringRecord& input : steering ? steering->inputs : std::vector<SteeringRecord>()) {
    *job.add_inputs() = InputForSpec(input);
  }
  WriteJobFile(file->path(), job.SerializeAsString(), *frames, frame_count, [this] { return HasRoom(); });
  size_ = static_cast<std::int64_t>(std::filesystem::file_size(file->path()));
  in_.open(file->path(), std::ios::binary);
  file_ = std::move(file);
  last_chunk_ = std::chrono::steady_clock::now();
  return true;
}

void ExportStream::End(const grpc::Status& status) {
  in_.close();
  file_.reset();
  place_.reset();
  Complete(status);
}

}  // namespace fascicle::server
