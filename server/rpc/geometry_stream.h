#ifndef FASCICLE_SERVER_RPC_GEOMETRY_STREAM_H_
#define FASCICLE_SERVER_RPC_GEOMETRY_STREAM_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/rpc/out_stream.h"

namespace fascicle::server {

// One call of GetGeometry: waits until the geometry is stored, then sends it chunk by chunk.
class GeometryStream : public OutStream {
 public:
  GeometryStream(RpcContext& context, std::string job_name)
      : OutStream(context, "GetGeometry"), job_name_(std::move(job_name)) {}

 protected:
  void Fill() override;

 private:
  // False if the geometry is not stored yet, or if the stream was completed with an error.
  bool Load();

  const std::string job_name_;
  std::string job_id_;
  bool following_ = false;
  std::shared_ptr<FrameStore> frames_;  // once the geometry is stored
  std::optional<std::int64_t> size_;
  std::int64_t sent_ = 0;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_GEOMETRY_STREAM_H_
