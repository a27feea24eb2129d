#ifndef FASCICLE_CLIENT_LIB_MESSAGE_STREAM_H_
#define FASCICLE_CLIENT_LIB_MESSAGE_STREAM_H_

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <utility>

#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>
#include <grpcpp/support/status.h>

namespace fascicle::client {

// A live stream of the server has a message at least every ten seconds.
inline constexpr std::chrono::seconds kLongestSilence(30);

// The messages of one call of a server-streaming method. gRPC's threads receive them, so that the connection responds
// to the server's keepalive however long the reader takes for a message. A few messages are buffered; then the server
// waits.
template <class Response>
class MessageStream : private grpc::ClientReadReactor<Response> {
 public:
  enum class Outcome { kMessage, kEnd, kSilence, kStopped };

  // `begin(context, reactor)` makes the call, such as stub.async()->GetGeometry(context, &request, reactor). Its
  // references must stay valid as long as the stream.
  using Begin = std::function<void(grpc::ClientContext*, grpc::ClientReadReactor<Response>*)>;

  explicit MessageStream(const Begin& begin) {
    begin(&call_, this);
    this->AddHold();  // the reader's thread starts reads, too
    this->StartRead(&incoming_);
    this->StartCall();
  }

  // Cancels the call if it is still active.
  ~MessageStream() {
    call_.TryCancel();
    std::unique_lock lock(mutex_);
    reading_is_over_ = true;
    if (std::exchange(paused_, false)) {
      lock.unlock();
      this->RemoveHold();
      lock.lock();
    }
    changed_.wait(lock, [this] { return done_; });
  }

  // Waits for the next message, the end of the call, `silence` without a message, or a stop request.
  Outcome Next(Response& message, std::chrono::milliseconds silence, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, stop, silence, [this] { return !ready_.empty() || done_; });
    if (stop.stop_requested()) return Outcome::kStopped;
    if (ready_.empty()) return done_ ? Outcome::kEnd : Outcome::kSilence;
    message = std::move(ready_.front());
    ready_.pop_front();
    if (std::exchange(paused_, false)) {
      lock.unlock();
      this->StartRead(&incoming_);
    }
    return Outcome::kMessage;
  }

  // Valid after kEnd.
  grpc::Status status() {
    std::lock_guard lock(mutex_);
    return status_;
  }

 private:
  static constexpr std::size_t kAhead = 4;

  void OnReadDone(bool ok) override {
    std::unique_lock lock(mutex_);
    if (!ok || reading_is_over_) {
      lock.unlock();
      this->RemoveHold();
      return;
    }
    ready_.push_back(std::move(incoming_));
    changed_.notify_all();
    paused_ = ready_.size() >= kAhead;
    if (!paused_) {
      lock.unlock();
      this->StartRead(&incoming_);
    }
  }

  void OnDone(const grpc::Status& status) override {
    std::lock_guard lock(mutex_);  // held while notifying: the reader may destroy this object as soon as it wakes
    status_ = status;
    done_ = true;
    changed_.notify_all();
  }

  grpc::ClientContext call_;
  Response incoming_;

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Response> ready_;
  bool paused_ = false;           // no read is started until there is space
  bool reading_is_over_ = false;  // the reader has been destroyed
  bool done_ = false;
  grpc::Status status_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_MESSAGE_STREAM_H_
