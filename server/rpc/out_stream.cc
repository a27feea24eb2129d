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

void OutStream::Wake() {
  {
    std::lock_guard lock(mutex_);
    if (stopped_) return;
    if (filling_) {
      fill_again_ = true;
      return;
    }
    filling_ = true;
  }
  executor().Post([stream = shared_from_this()] { stream->RunFill(); });
}

void OutStream::RunFill() {
  bool again = true;
  while (again) {
    {
      std::lock_guard lock(mutex_);
      fill_again_ = false;
      if (stopped_) {  // cancelled before its turn: there is nothing to do
        filling_ = false;
        return;
      }
    }
    const grpc::Status status = Guarded(context_.log, method_, [this] {
      Fill();
      return grpc::Status::OK;
    });
    if (!status.ok()) Abort(status);
    std::lock_guard lock(mutex_);
    again = fill_again_ && !stopped_;
    if (!again) filling_ = false;
  }
}

bool OutStream::HasRoom() const {
  std::lock_guard lock(mutex_);
  return !stopped_ && ready_.size() < kAhead;
}

bool OutStream::AllWritten() const {
  std::lock_guard lock(mutex_);
  return ready_.empty() && !writing_;
}

void OutStream::Push(grpc::ByteBuffer message) {
  std::unique_lock lock(mutex_);
  if (stopped_) return;
  ready_.push_back(std::move(message));
  Pump(lock);
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
  ready_.clear();
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
    writing_ = true;
    lock.unlock();
    if (in_flight_.Length() < kLarge) {
      StartWrite(&in_flight_);
    } else {
      context_.turnstile.Enter(this, [stream = shared_from_this()] { stream->StartWrite(&stream->in_flight_); });
    }
  } else if (last_) {
    finished_ = true;
    const grpc::Status status = *last_;
    lock.unlock();
    Finish(status);
  }
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
      ready_.clear();
      if (!last_) last_ = grpc::Status::CANCELLED;
    }
    // Refill when all prepared messages are on their way: half as many thread switches as for each message.
    low = ready_.size() <= 1;
    Pump(lock);
  }
  if (low) Wake();
}

void OutStream::OnCancel() { Abort(grpc::Status::CANCELLED); }

void OutStream::OnDone() {
  context_.streams.Remove(this);
  JobManager::Subscription subscription;
  {
    std::lock_guard lock(mutex_);
    subscription.swap(subscription_);
  }
  // Destroying the subscription may wait for a call of its listener, so not on this thread.
  if (subscription) context_.streaming.Post([subscription = std::move(subscription)] {});
  self_.reset();
}

}  // namespace fascicle::server
