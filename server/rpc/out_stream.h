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

#include "server/rpc/rpc_context.h"

namespace fascicle::server {

// A server stream that is filled by an executor: one message in flight and at most kAhead prepared ones, so that a slow
// reader costs a few MiB and no thread. Derived classes create the messages in Fill.
class OutStream : public grpc::ServerWriteReactor<grpc::ByteBuffer>, public std::enable_shared_from_this<OutStream> {
 public:
  static constexpr std::size_t kAhead = 2;

  OutStream(RpcContext& context, const char* method) : context_(context), method_(method) {}

  // Starts filling. Returns the reactor for gRPC, which lives until the call is done.
  static grpc::ServerWriteReactor<grpc::ByteBuffer>* Launch(const grpc::CallbackServerContext& call,
                                                            std::shared_ptr<OutStream> stream);

  // Call when there may be more to send: runs Fill on the executor. Any thread.
  void Wake();

  void OnWriteDone(bool ok) final;
  void OnCancel() final;
  void OnDone() final;

 protected:
  // Creates messages while HasRoom(), until Complete or until there is nothing to send at present. Runs on an executor,
  // never concurrently with itself; called again after Wake, after each write, and by `subscription`.
  virtual void Fill() = 0;
  // Where Fill runs.
  virtual Executor& executor() { return context_.streaming; }

  // The functions below are called from Fill only.
  bool HasRoom() const;
  bool AllWritten() const;
  void Push(grpc::ByteBuffer message);
  // Ends the stream once everything is written.
  void Complete(grpc::Status status);
  // Wakes this stream whenever the job changes, until the end.
  void Follow(const std::string& job_id);
  // Wakes this stream after `delay`, or earlier.
  void WakeAfter(std::chrono::milliseconds delay);

  RpcContext& context_;

 private:
  void RunFill();
  void Abort(const grpc::Status& status);
  // Starts the next operation of the call, if any; releases the lock.
  void Pump(std::unique_lock<std::mutex>& lock);

  const char* const method_;
  std::shared_ptr<OutStream> self_;  // until OnDone
  Connections::Place place_;

  mutable std::mutex mutex_;
  std::deque<grpc::ByteBuffer> ready_;
  grpc::ByteBuffer in_flight_;
  bool writing_ = false;
  bool filling_ = false;
  bool fill_again_ = false;
  std::chrono::steady_clock::time_point next_timer_ = std::chrono::steady_clock::time_point::max();
  bool stopped_ = false;              // no more messages are wanted
  bool finished_ = false;             // Finish was called
  std::optional<grpc::Status> last_;  // sent after `ready_`
  JobManager::Subscription subscription_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_OUT_STREAM_H_
