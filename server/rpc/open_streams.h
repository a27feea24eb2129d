#ifndef FASCICLE_SERVER_RPC_OPEN_STREAMS_H_
#define FASCICLE_SERVER_RPC_OPEN_STREAMS_H_

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>

#include <grpcpp/support/status.h>

namespace fascicle::server {

// The open streams. A server that shuts down ends each of them with a status before it shuts gRPC down, which would
// wait for them indefinitely. Thread-safe.
class OpenStreams {
 public:
  // `abort` ends the stream at once; it is called at most once, from Drain. Returns false while draining: refuse the
  // stream.
  bool Add(const void* stream, std::function<void(const grpc::Status&)> abort);
  void Remove(const void* stream);

  // From now on no stream is added; open ones end with UNAVAILABLE.
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
