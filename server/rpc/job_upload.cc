#include "server/rpc/job_upload.h"

#include <algorithm>
#include <utility>

#include "server/rpc/take_over.h"
#include "server/store/file_system.h"
#include "server/store/job_file.h"

namespace fascicle::server {
namespace {

constexpr std::int64_t kMostSize = std::int64_t{1} << 40;  // [byte]
constexpr double kSlowest = 64 * 1024;                     // [byte/s]

}  // namespace

JobUpload::JobUpload(RpcContext& context, OpenTransfers& transfers, v1::Job& response)
    : context_(context), transfers_(transfers), response_(response) {}

JobUpload::~JobUpload() = default;

grpc::ServerReadReactor<v1::ImportJobRequest>* JobUpload::Launch(const grpc::CallbackServerContext& call,
                                                                 std::shared_ptr<JobUpload> upload) {
  JobUpload* reactor = upload.get();
  reactor->self_ = upload;
  Connections::Entry entry = reactor->context_.connections.Enter(call.peer(), CallKind::kUpload);
  if (!entry.status.ok()) {
    reactor->FinishOnce(entry.status);
    return reactor;
  }
  reactor->call_place_ = std::move(entry.place);
  const std::weak_ptr<JobUpload> weak = upload;
  const bool added = reactor->context_.streams.Add(reactor, [weak](const grpc::Status& status) {
    if (const auto open = weak.lock()) open->FinishOnce(status);
  });
  if (added) {
    reactor->StartRead(&reactor->message_);
    reactor->WatchPace();
  } else {
    reactor->FinishOnce(ShuttingDown());
  }
  return reactor;
}

void JobUpload::OnReadDone(bool ok) {
  transfers_.executor().Post([upload = shared_from_this(), ok] {
    if (upload->IsFinished()) return;
    const grpc::Status status =
        Guarded(upload->context_.log, "ImportJob", [&] { return ok ? upload->Take() : upload->TakeOverFile(); });
    if (!ok || !status.ok()) {
      upload->FinishOnce(status);
      return;
    }
    const std::lock_guard lock(upload->mutex_);
    if (!upload->finished_) upload->StartRead(&upload->message_);
  });
}

grpc::Status JobUpload::Begin() {
  Problems problems;
  if (message_.size() < 1 || message_.size() > kMostSize) problems.Add("size", "must be in [1, 1099511627776]");
  if (message_.request_id().size() > 64) problems.Add("request_id", "is longer than 64 characters");
  if (!problems.empty()) return InvalidArgument(problems);
  place_ = transfers_.Enter();
  if (!place_) {
    return Unavailable("OVERLOADED", "too many jobs are being exported and imported", std::chrono::seconds(5));
  }
  if (const std::string problem = context_.store.Problem(); !problem.empty()) throw NoSpaceError(problem);
  if (message_.size() > context_.store.Room() / 2) {  // the file, and the job that is made of it
    throw NoSpaceError("a job of " + std::to_string(message_.size()) + " bytes does not fit the disk");
  }
  file_ = std::make_unique<TransferFile>(context_.store.NewTransferPath());
  writer_ = std::make_unique<FileWriter>(file_->path());
  begin_ = message_;
  begin_.clear_data();
  return grpc::Status::OK;
}

grpc::Status JobUpload::Take() {
  constexpr std::size_t kLargestChunk = 1 << 20;
  if (!file_) {
    if (grpc::Status status = Begin(); !status.ok()) return status;
  }
  const std::string& data = message_.data();
  if (data.size() > kLargestChunk) return InvalidArgument("data", "must have at most 1 MiB in each message");
  {
    const std::lock_guard lock(mutex_);
    received_ += static_cast<std::int64_t>(data.size());
    last_message_ = Clock::now();
    if (received_ > begin_.size()) return InvalidArgument("SIZE_MISMATCH", "data", "is more than the announced size");
  }
  writer_->Write(data.data(), data.size());
  return grpc::Status::OK;
}

grpc::Status JobUpload::TakeOverFile() {
  if (!file_) return InvalidArgument("size", "no message was sent");
  {
    const std::lock_guard lock(mutex_);
    if (received_ != begin_.size()) {
      return InvalidArgument("SIZE_MISMATCH", "data", "is less than the announced size");
    }
    complete_ = true;
  }
  writer_->Finish();
  try {
    JobFileReader reader(file_->path());
    return TakeOver(
        context_, reader, begin_, [this] { return !IsFinished(); }, imported_);
  } catch (const JobFileError& error) {
    return InvalidArgument("NOT_A_JOB", "data", error.what());
  }
}

void JobUpload::WatchPace() {
  {
    const std::lock_guard lock(mutex_);
    if (finished_ || complete_) return;
  }
  const auto idle = context_.settings.transfer_idle;
  bool slow = false;
  {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    const double allowed = std::chrono::duration<double>(idle).count() + static_cast<double>(received_) / kSlowest;
    slow = now - last_message_ >= idle || std::chrono::duration<double>(now - start_).count() > allowed;
  }
  if (slow) {
    FinishOnce(Aborted("IDLE", "the upload was idle for too long, or too slow"));
    return;
  }
  const auto pause = std::min<std::chrono::milliseconds>(idle, std::chrono::seconds(5));
  transfers_.executor().PostAfter(pause, [weak = weak_from_this()] {
    if (const auto upload = weak.lock()) upload->WatchPace();
  });
}

bool JobUpload::IsFinished() {
  const std::lock_guard lock(mutex_);
  return finished_;
}

void JobUpload::FinishOnce(const grpc::Status& status) {
  {
    const std::lock_guard lock(mutex_);
    if (finished_) return;
    finished_ = true;
  }
  if (status.ok()) response_ = imported_;  // not earlier: after Finish the response may be destroyed at any time
  Finish(status);
}

void JobUpload::OnDone() {
  context_.streams.Remove(this);
  // Its file is removed with it, on the executor, because a message may still be in progress.
  transfers_.executor().Post([upload = std::move(self_)] {});
}

}  // namespace fascicle::server
