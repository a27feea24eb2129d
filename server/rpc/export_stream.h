#ifndef FASCICLE_SERVER_RPC_EXPORT_STREAM_H_
#define FASCICLE_SERVER_RPC_EXPORT_STREAM_H_

#include <chrono>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>

#include "server/rpc/open_transfers.h"
#include "server/rpc/out_stream.h"

namespace fascicle::server {

// One call of ExportJob: writes the job to a file, then sends that. A reader that takes nothing for a minute loses the
// file.
class ExportStream : public OutStream {
 public:
  ExportStream(RpcContext& context, OpenTransfers& transfers, std::string job_name)
      : OutStream(context, "ExportJob"), transfers_(transfers), job_name_(std::move(job_name)) {}

 protected:
  void Fill() override;
  Executor& executor() override { return transfers_.executor(); }

 private:
  // Writes the file. False if the stream was completed with an error.
  bool Open();
  // Ends the stream and removes the file.
  void End(const grpc::Status& status);

  OpenTransfers& transfers_;
  const std::string job_name_;
  std::shared_ptr<void> place_;
  std::unique_ptr<TransferFile> file_;
  std::ifstream in_;
  std::int64_t size_ = 0, sent_ = 0;
  std::chrono::steady_clock::time_point last_chunk_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_EXPORT_STREAM_H_
