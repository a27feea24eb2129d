#include "server/rpc/frame_stream.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "proto/rules/enum_names.h"
#include "server/rpc/chunk_message.h"
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

// The frame that is being sent was replaced by another one.
struct FrameReplaced : std::exception {};

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
  const std::optional<std::string> job_id = ParseJobName(request_.name());
  if (job_id && request_.fields_size() > 0) {
    if (const auto view = context_.jobs.Get(*job_id)) CheckFields(request_, view->record.spec, problems);
  }
  if (!problems.empty()) {
    Complete(InvalidArgument(problems));
    return false;
  }
  feed_ = shared_.feeds.Of(*job_id);
  if (!feed_) {
    Complete(NotFound("job", request_.name()));
    return false;
  }
  Join(feed_);  // before the first look, so that no change is missed
  next_index_ = request_.start_index();
  stride_ = std::max<std::int64_t>(request_.stride(), 1);
  generation_ = request_.generation();
  if (!Take(feed_->LookAgain())) return false;
  const JobRecord& record = state_->view.record;
  generation_ = record.generation;
  if (next_index_ < record.first_frame) {
    Complete(FramesRemoved(request_.name(), record.first_frame));
    return false;
  }
  // The next index of a stream with a stride may be beyond the last frame.
  if (IsFinal(record.state) && next_index_ > state_->frame_count - 1 + stride_) {
    Complete(OutOfRange("START_INDEX", "start_index " + std::to_string(next_index_) + " is beyond the " +
                                           std::to_string(state_->frame_count) + " frames of " + request_.name()));
    return false;
  }
  wanted_end_ = request_.end_index() > 0 ? request_.end_index() : INT64_MAX;
  // The frames stored now: a job may write faster than the reader reads.
  if (!request_.follow()) wanted_end_ = std::min(wanted_end_, state_->frame_count);
  open_ = true;
  Response message;
  message.mutable_header()->set_generation(generation_);
  message.mutable_header()->set_next_index(next_index_);
  message.mutable_header()->set_frame_count(state_->frame_count);
  message.mutable_header()->set_derived(derives_);
  Push(Serialize(message));
  last_message_ = Clock::now();
  return true;
}

bool FrameStream::Take(std::shared_ptr<const JobFeed::State> state) {
  state_ = std::move(state);
  if (!state_) {
    Complete(NotFound("job", request_.name()));
    return false;
  }
  if (generation_ != 0 && state_->view.record.generation != generation_) {
    Complete(Aborted("GENERATION_CHANGED", "the frames of " + request_.name() + " were rewritten: start again"));
    return false;
  }
  return true;
}

void FrameStream::Advance() {
  const bool latest = request_.mode() == v1::StreamFramesRequest::MODE_LATEST;
  if (latest && !AllWritten()) return;  // the newest is chosen when the reader is ready
  if (const auto rest = kLatestInterval - (Clock::now() - last_frame_); latest && rest > rest.zero()) {
    feed_->FillAfter(std::chrono::ceil<std::chrono::milliseconds>(rest));
    return;
  }
  if (!Take(feed_->Look())) return;
  Beat();
  if (latest) next_index_ = NewestIndex();
  if (next_index_ < std::min(state_->frame_count, wanted_end_)) {
    BeginFrame(next_index_);
  } else if (next_index_ >= wanted_end_ || IsFinal(state_->view.record.state)) {
    PushEnd();
  }
}

std::int64_t FrameStream::NewestIndex() const {
  const std::int64_t count = std::min(state_->frame_count, wanted_end_);
  if (count <= next_index_) return next_index_;
  return next_index_ + (count - 1 - next_index_) / stride_ * stride_;
}

void FrameStream::BeginFrame(std::int64_t index) {
  constexpr int kReadAhead = 64;
  current_ = feed_->Record(index, stride_ == 1 ? kReadAhead : 1);
  offset_ = 0;
  last_frame_ = Clock::now();
}

std::string FrameStream::StoredChunk(std::int64_t offset) {
  FrameStore& frames = feed_->frames();
  std::optional<std::string> bytes = frames.ReadChunk(current_->index, offset / FrameStore::kChunkSize);
  // Another frame may have taken its place since its record was read, or between two of its chunks.
  const std::vector<FrameRecord> now = frames.ListFrames(current_->index, 1);
  if (now.empty() || now.front().digest != current_->digest) throw FrameReplaced();
  if (!bytes) {
    throw DamageError("frame " + std::to_string(current_->index) + " of " + request_.name() + " is incomplete");
  }
  return *std::move(bytes);
}

std::string FrameStream::Derive() {
  std::string bytes;
  while (static_cast<std::int64_t>(bytes.size()) < current_->size) {
    bytes += StoredChunk(static_cast<std::int64_t>(bytes.size()));
  }
  return DeriveFrame(std::move(bytes), request_).SerializeAsString();
}

std::string FrameStream::KeyOfFrame() const {
  v1::StreamFramesRequest form;
  *form.mutable_fields() = request_.fields();
  form.set_encoding(request_.encoding());
  form.set_compression(request_.compression());
  return request_.name() + ' ' + std::to_string(current_->index) + ' ' + current_->digest + form.SerializeAsString();
}

FrameChunk FrameStream::MakeChunk() {
  ChunkSource source;
  if (derives_) {
    const std::shared_ptr<const std::string> whole = shared_.derived.Get(KeyOfFrame(), [this] { return Derive(); });
    // A copy: what waits for a slow reader must not keep the whole frame.
    source.bytes = std::make_shared<const std::string>(
        whole->substr(static_cast<std::size_t>(offset_), static_cast<std::size_t>(FrameStore::kChunkSize)));
    source.last = static_cast<std::size_t>(offset_) + source.bytes->size() >= whole->size();
  } else {
    source.bytes = std::make_shared<const std::string>(StoredChunk(offset_));
    source.last = offset_ + static_cast<std::int64_t>(source.bytes->size()) >= current_->size;
  }
  source.size = source.bytes->size();
  source.frame_index = current_->index;
  source.offset = offset_;
  return {ChunkMessage(Response::kChunkFieldNumber, source), source.size, source.last};
}

void FrameStream::PushChunk() {
  if (derives_ && current_->size > kMostToDerive) {
    Complete(ResourceExhausted("FRAME_TOO_LARGE", request_.name(),
                               "frame " + std::to_string(current_->index) + " has " + std::to_string(current_->size) +
                                   " bytes; selected, rounded or compressed are frames of at most " +
                                   std::to_string(kMostToDerive) + ": read it as it is stored"));
    return;
  }
  std::shared_ptr<const FrameChunk> chunk;
  try {
    chunk = shared_.chunks.Get(KeyOfFrame() + ' ' + std::to_string(offset_), [this] { return MakeChunk(); });
  } catch (const FrameReplaced&) {
    Complete(Aborted("GENERATION_CHANGED", "the frames of " + request_.name() + " were rewritten: start again"));
    return;
  }
  offset_ += static_cast<std::int64_t>(chunk->bytes);
  if (chunk->last) {
    next_index_ = current_->index + stride_;
    current_.reset();
  }
  Push(chunk->message);
  last_message_ = Clock::now();
}

void FrameStream::Beat() {
  const Clock::time_point now = Clock::now();
  const bool news = state_->beat != told_beat_ && !IsFinal(state_->view.record.state);
  // The next filling may be too late.
  if (!news && now - last_message_ + feed_->Interval() < context_.settings.heartbeat_interval) return;
  Response message;
  message.mutable_heartbeat()->set_next_index(next_index_);
  message.mutable_heartbeat()->set_state(StateOf(state_->view));
  *message.mutable_heartbeat()->mutable_progress() = state_->progress;
  Push(Serialize(message));
  told_beat_ = state_->beat;
  last_message_ = now;
}

void FrameStream::PushEnd() {
  Response message;
  *message.mutable_end()->mutable_job() = ToMessage(state_->view);
  message.mutable_end()->set_next_index(next_index_);
  Push(Serialize(message));
  Complete(grpc::Status::OK);
}

}  // namespace fascicle::server
