#include "server/rpc/out_stream.h"

#include <utility>

namespace fascicle::server {
namespace {

constexpr std::size_t kLarge = 64 << 10;  // messages that wait for their turn [byte]

}  // namespace

grpc::ServerWriteReactor<grpc::ByteBuffer>* OutStream::Launch(const grpc::CallbackServerContext& call,
                                                              std::shared_ptr<OutStream> stream) {
  OutStream* reactor = stream.get();
  reactor->self_ = stream;
  Connections::Entry entry = reactor->context_.connections.Enter(call.peer(), CallKind::kStream);
  if (!entry.status.ok()) {
    reactor->Abort(entry.status);
    return reactor;
  }
  reactor->place_ = std::move(entry.place);
  const std::weak_ptr<OutStream> weak = stream;
  const bool added = reactor->context_.streams.Add(reactor, [weak](const grpc::Status& status) {
    if (const auto open = weak.lock()) open->Abort(status);
  });
  if (added) {
    reactor->Wake();
  } else {
    reactor->Abort(ShuttingDown());
  }
  return reactor;
}

bool OutStream::BeginFill() {
  std::lock_guard lock(mutex_);
  if (stopped_) return false;
  if (filling_) {
    fill_again_ = true;
    return false;
  }
  filling_ = true;
  return true;
}

void OutStream::Wake() {
  if (BeginFill()) executor().Post([stream = shared_from_this()] { stream->RunFill(); });
}

void OutStream::WakeHere(const Executor& here) {
  if (&here != &executor()) return Wake();
  if (BeginFill()) RunFill();
}

void OutStream::RunFill() {
  {
    std::lock_guard lock(mutex_);
    fill_again_ = false;
    waits_for_write_ = false;
    if (stopped_) {  // cancelled before its turn: there is nothing to do
      filling_ = false;
      return;
    }
  }
  const grpc::Status status = Guarded(context_.log, method_, [this] {
    Fill();
    return grpc::Status::OK;
  });
  if (!status.ok()) Complete(status);  // after the messages that are ready: what was read before the fault is whole
  {
    std::unique_lock lock(mutex_);
    Pump(lock);
  }
  {
    std::lock_guard lock(mutex_);
    filling_ = fill_again_ && !stopped_;
    if (!filling_) return;
  }
  executor().Post([stream = shared_from_this()] { stream->RunFill(); });  // after those that wait
}

bool OutStream::IsFull() const {
  return ready_.size() >= kAhead && (ready_.size() >= kSmallAhead || ready_bytes_ >= kSmallBytes);
}

bool OutStream::HasRoom() {
  std::lock_guard lock(mutex_);
  if (IsFull()) waits_for_write_ = true;
  return !stopped_ && !IsFull();
}

bool OutStream::AllWritten() {
  std::lock_guard lock(mutex_);
  const bool all = ready_.empty() && !writing_;
  if (!all) waits_for_write_ = true;
  return all;
}

void OutStream::Push(grpc::ByteBuffer message) {
  std::unique_lock lock(mutex_);
  if (stopped_) return;
  const std::size_t size = message.Length();
  ready_bytes_ += size;
  ready_.push_back(std::move(message));
  if (size >= kLarge) Pump(lock);  // small ones leave together, after Fill
}

void OutStream::Complete(grpc::Status status) {
  std::unique_lock lock(mutex_);
  if (stopped_) return;
  stopped_ = true;
  last_ = std::move(status);
  Pump(lock);
}

void OutStream::Abort(const grpc::Status& status) {
  std::unique_lock lock(mutex_);
  if (!finished_) last_ = status;
  stopped_ = true;
  Clear();
  Pump(lock);
}

void OutStream::Follow(const std::string& job_id) {
  const std::weak_ptr<OutStream> weak = weak_from_this();
  JobManager::Subscription subscription = context_.jobs.Subscribe(job_id, [weak] {
    if (const auto stream = weak.lock()) stream->Wake();
  });
  std::lock_guard lock(mutex_);
  if (!finished_) subscription_.swap(subscription);
}

void OutStream::Join(std::shared_ptr<JobFeed> feed) {
  feed->Join(weak_from_this());
  {
    std::lock_guard lock(mutex_);
    if (!finished_) {
      feed_ = std::move(feed);
      return;
    }
  }
  feed->Leave();
}

void OutStream::WakeAfter(std::chrono::milliseconds delay) {
  const auto time = std::chrono::steady_clock::now() + delay;
  {
    std::lock_guard lock(mutex_);
    if (stopped_ || next_timer_ <= time) return;  // an earlier wake-up is scheduled
    next_timer_ = time;
  }
  context_.streaming.PostAfter(delay, [weak = weak_from_this(), time] {
    const auto stream = weak.lock();
    if (!stream) return;
    {
      std::lock_guard lock(stream->mutex_);
      if (stream->next_timer_ == time) stream->next_timer_ = std::chrono::steady_clock::time_point::max();
    }
    stream->Wake();
  });
}

void OutStream::Pump(std::unique_lock<std::mutex>& lock) {
  if (writing_ || finished_) return;
  if (!ready_.empty()) {
    in_flight_ = std::move(ready_.front());
    ready_.pop_front();
    ready_bytes_ -= in_flight_.Length();
    writing_ = true;
    // The first one is not held back: gRPC would not report it as written, because the call's metadata go with it.
    const bool more_follow = std::exchange(begun_, true) && !ready_.empty();
    lock.unlock();
    if (in_flight_.Length() < kLarge) {
      Write(more_follow);
    } else {
      context_.turnstile.Enter(this, [stream = shared_from_this()] { stream->Write(false); });
    }
  } else if (last_) {
    finished_ = true;
    const grpc::Status status = *last_;
    lock.unlock();
    Finish(status);
  }
}

void OutStream::Clear() {
  ready_.clear();
  ready_bytes_ = 0;
}

void OutStream::Write(bool more_follow) {
  grpc::WriteOptions options;
  if (more_follow) options.set_buffer_hint();  // they leave together
  StartWrite(&in_flight_, options);
}

void OutStream::OnWriteDone(bool ok) {
  context_.turnstile.Leave(this);
  bool low = false;
  {
    std::unique_lock lock(mutex_);
    writing_ = false;
    in_flight_.Clear();
    if (!ok) {  // the client has disconnected
      stopped_ = true;
      Clear();
      if (!last_) last_ = grpc::Status::CANCELLED;
    }
    // Refill when nearly all prepared messages are on their way: half as many thread switches as for each message.
    low = waits_for_write_ && ready_.size() <= 1;
    Pump(lock);
  }
  if (low) Wake();
}

void OutStream::OnCancel() { Abort(grpc::Status::CANCELLED); }

void OutStream::OnDone() {
  context_.streams.Remove(this);
  JobManager::Subscription subscription;
  std::shared_ptr<JobFeed> feed;
  {
    std::lock_guard lock(mutex_);
    subscription.swap(subscription_);
    feed.swap(feed_);
  }
  if (!subscription && !feed) return self_.reset();
  // Ending a subscription may wait for a call of its listener, and closing frames for the disk: not on this thread.
  context_.streaming.Post([self = std::move(self_), subscription = std::move(subscription), feed = std::move(feed)] {
    if (feed) feed->Leave();
  });
}

}  // namespace fascicle::server
