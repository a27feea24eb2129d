#include "server/rpc/frame_stream.h"

#include <algorithm>
#include <utility>

#include "proto/rules/enum_names.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/names.h"

namespace fascicle::server {
namespace {

using Response = v1::StreamFramesResponse;

// Least time between frames of MODE_LATEST. gRPC's buffers hold hundreds of small frames; sent as fast as the transport
// accepts them, they would reach the viewer long after they were new.
constexpr std::chrono::milliseconds kLatestInterval(33);

// Largest stored frame that is derived from [byte]. Meanwhile it needs about four times its size.
constexpr std::int64_t kMostToDerive = std::int64_t{128} << 20;
static_assert(kMostToDerive <= kLargestDerived);

// The names that a request may select from the frames of a job.
std::vector<std::string> PartsOf(const v1::Scene& scene) {
  std::vector<std::string> parts = {kPositionsPart, kSeriesPart};
  for (const int field : scene.output().fields()) {
    if (const auto* value = v1::Field_descriptor()->FindValueByNumber(field)) parts.push_back(NameOf(*value));
  }
  return parts;
}

// `spec`: that of the job.
void CheckFields(const v1::StreamFramesRequest& request, const std::string& spec, Problems& problems) {
  v1::Job job;
  if (!job.ParseFromString(spec)) throw DamageError("the scene of " + request.name() + " can't be read");
  const std::vector<std::string> parts = PartsOf(job.scene());
  std::string known;
  for (const std::string& part : parts) known += (known.empty() ? "" : ", ") + part;
  for (int i = 0; i < request.fields_size(); ++i) {
    if (std::find(parts.begin(), parts.end(), request.fields(i)) != parts.end()) continue;
    problems.Add(IndexPath("fields", static_cast<std::size_t>(i)),
                 request.fields(i).substr(0, 64) + " is not in the frames of this job", "they have: " + known);
  }
}

void CheckRequest(const v1::StreamFramesRequest& request, Problems& problems) {
  constexpr int kMostFields = 100;
  if (!ParseJobName(request.name())) problems.Add("name", "must be jobs/{id}");
  if (request.start_index() < 0) problems.Add("start_index", "must not be negative");
  if (request.end_index() < 0) problems.Add("end_index", "must not be negative");
  if (request.stride() < 0 || request.stride() > 1'000'000) problems.Add("stride", "must be in [0, 1000000]");
  if (!v1::StreamFramesRequest::Mode_IsValid(request.mode())) problems.Add("mode", "is not known");
  if (request.fields_size() > kMostFields) problems.Add("fields", "must be at most 100");
  if (!v1::StreamFramesRequest::Encoding_IsValid(request.encoding())) problems.Add("encoding", "is not known");
  if (!v1::DerivedFrame::Compression_IsValid(request.compression())) problems.Add("compression", "is not known");
}

}  // namespace

void FrameStream::Fill() {
  if (!open_ && !Open()) return;
  while (HasRoom()) {
    if (!current_) {
      Advance();
      if (!current_) return;
    } else {
      PushChunk();
    }
  }
}

bool FrameStream::Open() {
  Problems problems;
  CheckRequest(request_, problems);
  if (const auto id = ParseJobName(request_.name()); id && request_.fields_size() > 0) {
    if (const std::optional<JobView> view = context_.jobs.Get(*id)) CheckFields(request_, view->record.spec, problems);
  }
  if (!problems.empty()) {
    Complete(InvalidArgument(problems));
    return false;
  }
  job_id_ = *ParseJobName(request_.name());
  frames_ = context_.jobs.Frames(job_id_);
  if (!frames_) {
    Complete(NotFound("job", request_.name()));
    return false;
  }
  Follow(job_id_);  // before the first check, so that no change is missed
  next_index_ = request_.start_index();
  stride_ = std::max<std::int64_t>(request_.stride(), 1);
  generation_ = request_.generation();
  if (!Refresh()) return false;
  generation_ = view_.record.generation;
  if (next_index_ < view_.record.first_frame) {
    Complete(FramesRemoved(request_.name(), view_.record.first_frame));
    return false;
  }
  // The next index of a stream with a stride may be beyond the last frame.
  if (IsFinal(view_.record.state) && next_index_ > known_count_ - 1 + stride_) {
    Complete(OutOfRange("START_INDEX", "start_index " + std::to_string(next_index_) + " is beyond the " +
                                           std::to_string(known_count_) + " frames of " + request_.name()));
    return false;
  }
  wanted_end_ = request_.end_index() > 0 ? request_.end_index() : INT64_MAX;
  // The frames stored now: a job may write faster than the reader reads.
  if (!request_.follow()) wanted_end_ = std::min(wanted_end_, known_count_);
  open_ = true;
  Response message;
  message.mutable_header()->set_generation(generation_);
  message.mutable_header()->set_next_index(next_index_);
  message.mutable_header()->set_frame_count(known_count_);
  message.mutable_header()->set_derived(derives_);
  Push(Serialize(message));
  last_message_ = Clock::now();
  return true;
}

bool FrameStream::Refresh() {
  // The state is read before the frames: a job in a final state has stored all of them.
  std::optional<JobView> view = context_.jobs.Get(job_id_);
  if (!view) {
    Complete(NotFound("job", request_.name()));
    return false;
  }
  view_ = std::move(*view);
  known_count_ = frames_->frame_count();
  if (view_.record.first_frame > 0) {
    known_count_ = view_.record.frame_count;
  } else if (IsFinal(view_.record.state) && known_count_ < view_.record.frame_count) {
    throw DamageError("of the " + std::to_string(view_.record.frame_count) + " frames of " + request_.name() +
                      " only " + std::to_string(known_count_) + " are there");
  }
  last_look_ = Clock::now();
  if (generation_ != 0 && view_.record.generation != generation_) {
    Complete(Aborted("GENERATION_CHANGED", "the frames of " + request_.name() + " were rewritten: start again"));
    return false;
  }
  return true;
}

void FrameStream::Advance() {
  const bool latest = request_.mode() == v1::StreamFramesRequest::MODE_LATEST;
  if (latest && !AllWritten()) return;  // the newest is chosen when the reader is ready
  if (const auto rest = kLatestInterval - (Clock::now() - last_frame_); latest && rest > rest.zero()) {
    WakeAfter(std::chrono::ceil<std::chrono::milliseconds>(rest));
    return;
  }
  const bool look =
      latest || next_index_ >= known_count_ || Clock::now() - last_look_ >= context_.settings.progress_interval;
  if (look && !Refresh()) return;
  Beat();
  if (latest) next_index_ = NewestIndex();
  if (next_index_ < std::min(known_count_, wanted_end_)) {
    BeginFrame(next_index_);
  } else if (next_index_ >= wanted_end_ || IsFinal(view_.record.state)) {
    PushEnd();
  } else {
    WakeAfter(std::min(context_.settings.progress_interval, context_.settings.heartbeat_interval));
  }
}

std::int64_t FrameStream::NewestIndex() const {
  const std::int64_t count = std::min(known_count_, wanted_end_);
  if (count <= next_index_) return next_index_;
  return next_index_ + (count - 1 - next_index_) / stride_ * stride_;
}

void FrameStream::BeginFrame(std::int64_t index) {
  constexpr int kReadAhead = 64;
  auto found = std::find_if(listed_.begin(), listed_.end(), [index](const FrameRecord& r) { return r.index == index; });
  if (found == listed_.end()) {
    listed_ = frames_->ListFrames(index, stride_ == 1 ? kReadAhead : 1);
    found = listed_.begin();
    if (listed_.empty() || found->index != index)
      throw DamageError("frame " + std::to_string(index) + " of " + request_.name() + " is missing");
  }
  current_ = *found;
  offset_ = 0;
  last_frame_ = Clock::now();
}

ChunkSource FrameStream::StoredChunk(std::int64_t offset) {
  std::optional<std::string> bytes = frames_->ReadChunk(current_->index, offset / FrameStore::kChunkSize);
  if (!bytes)
    throw DamageError("frame " + std::to_string(current_->index) + " of " + request_.name() + " is incomplete");
  ChunkSource source;
  source.size = bytes->size();
  source.last = offset + static_cast<std::int64_t>(source.size) >= current_->size;
  source.bytes = std::make_shared<const std::string>(std::move(*bytes));
  return source;
}

std::string FrameStream::Derive() {
  std::string bytes;
  while (static_cast<std::int64_t>(bytes.size()) < current_->size) {
    bytes += *StoredChunk(static_cast<std::int64_t>(bytes.size())).bytes;
  }
  return DeriveFrame(std::move(bytes), request_).SerializeAsString();
}

ChunkSource FrameStream::DerivedChunk(std::int64_t offset) {
  v1::StreamFramesRequest form;
  *form.mutable_fields() = request_.fields();
  form.set_encoding(request_.encoding());
  form.set_compression(request_.compression());
  const std::string key =
      job_id_ + ' ' + std::to_string(current_->index) + ' ' + current_->digest + form.SerializeAsString();
  const FrameDeriver::Bytes whole = deriver_.Get(key, [this] { return Derive(); });
  // A copy: what waits for a slow reader must not keep the whole frame.
  ChunkSource source;
  source.bytes = std::make_shared<const std::string>(
      whole->substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(FrameStore::kChunkSize)));
  source.size = source.bytes->size();
  source.last = static_cast<std::size_t>(offset) + source.size >= whole->size();
  return source;
}

bool FrameStream::IsUnchanged() {
  const std::vector<FrameRecord> now = frames_->ListFrames(current_->index, 1);
  return !now.empty() && now.front().digest == current_->digest;
}

void FrameStream::PushChunk() {
  if (derives_ && current_->size > kMostToDerive) {
    Complete(ResourceExhausted("FRAME_TOO_LARGE", request_.name(),
                               "frame " + std::to_string(current_->index) + " has " + std::to_string(current_->size) +
                                   " bytes; selected, rounded or compressed are frames of at most " +
                                   std::to_string(kMostToDerive) + ": read it as it is stored"));
    return;
  }
  ChunkSource source = derives_ ? DerivedChunk(offset_) : StoredChunk(offset_);
  source.frame_index = current_->index;
  source.offset = offset_;
  offset_ += static_cast<std::int64_t>(source.size);
  // The frame may have been replaced between two of its chunks.
  if (source.last && (derives_ || offset_ > FrameStore::kChunkSize) && !IsUnchanged()) {
    Complete(Aborted("GENERATION_CHANGED", "the frames of " + request_.name() + " were rewritten: start again"));
    return;
  }
  if (source.last) {
    next_index_ = current_->index + stride_;
    current_.reset();
  }
  Push(ChunkMessage(Response::kChunkFieldNumber, source));
  last_message_ = Clock::now();
}

void FrameStream::Beat() {
  const Clock::time_point now = Clock::now();
  v1::Progress progress = ProgressOf(view_);
  const std::string told = std::to_string(StateOf(view_)) + progress.SerializeAsString();
  const bool news =
      told != last_progress_ && !IsFinal(view_.record.state) && now - last_beat_ >= context_.settings.progress_interval;
  if (!news && now - last_message_ < context_.settings.heartbeat_interval) return;
  Response message;
  message.mutable_heartbeat()->set_next_index(next_index_);
  message.mutable_heartbeat()->set_state(StateOf(view_));
  *message.mutable_heartbeat()->mutable_progress() = std::move(progress);
  Push(Serialize(message));
  last_progress_ = told;
  last_beat_ = last_message_ = now;
}

void FrameStream::PushEnd() {
  Response message;
  *message.mutable_end()->mutable_job() = ToMessage(view_);
  message.mutable_end()->set_next_index(next_index_);
  Push(Serialize(message));
  Complete(grpc::Status::OK);
}

}  // namespace fascicle::server
