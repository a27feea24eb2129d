#ifndef FASCICLE_SERVER_RPC_OPEN_STREAMS_H_
#define FASCICLE_SERVER_RPC_OPEN_STREAMS_H_

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>

#include <grpcpp/support/status.h>

namespace fascicle::server {

// The streams that are open, so that a server that shuts down can end each of them with a status before gRPC is shut
// down: gRPC alone would wait for them for ever. Thread-safe.
class OpenStreams {
 public:
  // `abort` ends the stream at once; it is called at most once, from Drain. False while draining: refuse the stream.
  bool Add(const void* stream, std::function<void(const grpc::Status&)> abort);
  void Remove(const void* stream);

  // From now on no stream is added, and those that are open end with UNAVAILABLE.
  void Drain();
  bool draining() const;
  bool WaitUntilEmpty(std::chrono::milliseconds timeout);

 private:
  mutable std::mutex mutex_;
  std::condition_variable empty_;
  bool draining_ = false;
  std::map<const void*, std::function<void(const grpc::Status&)>> streams_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_OPEN_STREAMS_H_
