#ifndef FASCICLE_SERVER_RPC_OUT_STREAM_H_
#define FASCICLE_SERVER_RPC_OUT_STREAM_H_

#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>
#include <grpcpp/support/status.h>

#include "server/rpc/job_feed.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

// A server stream that is filled by an executor: one message in flight and at most kAhead prepared ones, or more small
// ones, which are sent together. So a slow reader costs a few MiB and no thread. Derived classes create the messages in
// Fill.
class OutStream : public grpc::ServerWriteReactor<grpc::ByteBuffer>, public std::enable_shared_from_this<OutStream> {
 public:
  static constexpr std::size_t kAhead = 2;
  static constexpr std::size_t kSmallAhead = 32;
  static constexpr std::size_t kSmallBytes = 64 << 10;  // of all prepared ones [byte]

  OutStream(RpcContext& context, const char* method) : context_(context), method_(method) {}

  // Starts filling. Returns the reactor for gRPC, which lives until the call is done.
  static grpc::ServerWriteReactor<grpc::ByteBuffer>* Launch(const grpc::CallbackServerContext& call,
                                                            std::shared_ptr<OutStream> stream);

  // Call when there may be more to send: runs Fill on the executor. Any thread.
  void Wake();
  // The same, at once on this thread if it is one of `here`.
  void WakeHere(const Executor& here);

  void OnWriteDone(bool ok) final;
  void OnCancel() final;
  void OnDone() final;

 protected:
  // Creates messages while HasRoom(), until Complete or until there is nothing to send at present. Runs on an executor,
  // never concurrently with itself. Called again after Wake, and after a write if there was no room, or if not all was
  // written.
  virtual void Fill() = 0;
  // Where Fill runs.
  virtual Executor& executor() { return context_.streaming; }

  // The functions below are called from Fill only.
  bool HasRoom();
  bool AllWritten();
  void Push(grpc::ByteBuffer message);
  // Ends the stream once everything is written.
  void Complete(grpc::Status status);
  // Wakes this stream whenever the job changes, until the end.
  void Follow(const std::string& job_id);
  // The same with what all streams of the job share.
  void Join(std::shared_ptr<JobFeed> feed);
  // Wakes this stream after `delay`, or earlier.
  void WakeAfter(std::chrono::milliseconds delay);

  RpcContext& context_;

 private:
  // Whether the caller has to call RunFill.
  bool BeginFill();
  void RunFill();
  void Abort(const grpc::Status& status);
  // Starts the next operation of the call, if any; releases the lock.
  void Pump(std::unique_lock<std::mutex>& lock);
  void Write(bool more_follow);
  // The functions below need mutex_.
  bool IsFull() const;
  void Clear();

  const char* const method_;
  std::shared_ptr<OutStream> self_;  // until OnDone
  Connections::Place place_;

  std::mutex mutex_;
  std::deque<grpc::ByteBuffer> ready_;
  std::size_t ready_bytes_ = 0;
  grpc::ByteBuffer in_flight_;
  bool begun_ = false;  // a message was written
  bool writing_ = false;
  bool filling_ = false;
  bool fill_again_ = false;
  bool waits_for_write_ = false;  // the last Fill would have gone on
  std::chrono::steady_clock::time_point next_timer_ = std::chrono::steady_clock::time_point::max();
  bool stopped_ = false;              // no more messages are wanted
  bool finished_ = false;             // Finish was called
  std::optional<grpc::Status> last_;  // sent after `ready_`
  JobManager::Subscription subscription_;
  std::shared_ptr<JobFeed> feed_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_OUT_STREAM_H_
