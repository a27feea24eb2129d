#ifndef FASCICLE_SERVER_RPC_JOB_UPLOAD_H_
#define FASCICLE_SERVER_RPC_JOB_UPLOAD_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>

#include "fascicle/v1/transfer_service.pb.h"
#include "server/rpc/open_transfers.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

class FileWriter;

// One call of ImportJob: writes what comes to a file, then takes the job over. Uploads that are idle or too slow end.
class JobUpload : public grpc::ServerReadReactor<v1::ImportJobRequest>, public std::enable_shared_from_this<JobUpload> {
 public:
  JobUpload(RpcContext& context, OpenTransfers& transfers, v1::Job& response);
  ~JobUpload() override;

  // Starts reading. Returns the reactor for gRPC, which lives until the call is done.
  static grpc::ServerReadReactor<v1::ImportJobRequest>* Launch(const grpc::CallbackServerContext& call,
                                                               std::shared_ptr<JobUpload> upload);

  void OnReadDone(bool ok) override;
  void OnCancel() override { FinishOnce(grpc::Status::CANCELLED); }
  void OnDone() override;

 private:
  using Clock = std::chrono::steady_clock;

  // Each processes the message just read, on the executor.
  grpc::Status Take();
  grpc::Status Begin();
  grpc::Status TakeOverFile();
  // Ends the call if nothing came for long, or too little; looks again later.
  void WatchPace();
  bool IsFinished();
  void FinishOnce(const grpc::Status& status);

  RpcContext& context_;
  OpenTransfers& transfers_;
  v1::Job& response_;
  std::shared_ptr<JobUpload> self_;  // until OnDone

  v1::ImportJobRequest message_;
  std::shared_ptr<void> place_;       // among the transfers
  std::shared_ptr<void> call_place_;  // among the calls
  std::unique_ptr<TransferFile> file_;
  std::unique_ptr<FileWriter> writer_;
  v1::ImportJobRequest begin_;  // the first message, without data
  v1::Job imported_;
  const Clock::time_point start_ = Clock::now();

  std::mutex mutex_;  // guards the members below
  bool finished_ = false;
  bool complete_ = false;  // everything was received
  std::int64_t received_ = 0;
  Clock::time_point last_message_ = Clock::now();
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_JOB_UPLOAD_H_
