#ifndef FASCICLE_SERVER_RPC_SHARED_FRAMES_H_
#define FASCICLE_SERVER_RPC_SHARED_FRAMES_H_

#include <cstddef>
#include <string>

#include <grpcpp/support/byte_buffer.h>

#include "server/rpc/executor.h"
#include "server/rpc/job_feed.h"
#include "server/rpc/rpc_context.h"
#include "server/rpc/shared_cache.h"

namespace fascicle::server {

// A chunk of a frame as a message, ready to be sent to any number of readers.
struct FrameChunk {
  grpc::ByteBuffer message;
  std::size_t bytes = 0;  // of the frame
  bool last = false;

  std::size_t size() const { return bytes; }
};

// What all streams of frames share. Readers keep nothing but their place in a frame.
struct SharedFrames {
  explicit SharedFrames(RpcContext& context)
      : feeds(context),
        deriving(2, [&context](const std::string& what) { context.log.error("derived frames: {}", what); }) {}

  JobFeeds feeds;
  SharedCache<FrameChunk> chunks{std::size_t{32} << 20};
  SharedCache<std::string> derived{std::size_t{64} << 20};  // whole frames
  Executor deriving;  // where streams of derived frames are filled, so that nothing else waits; destroyed first
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_SHARED_FRAMES_H_
