#ifndef FASCICLE_SERVER_RPC_ASSET_UPLOAD_H_
#define FASCICLE_SERVER_RPC_ASSET_UPLOAD_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "fascicle/v1/simulation_service.pb.h"
#include "server/rpc/rpc_context.h"
#include "server/store/store.h"

namespace fascicle::server {

// One call of UploadAsset: reads a chunk, writes it to the store on an executor, then reads the next one.
class AssetUpload : public grpc::ServerReadReactor<v1::UploadAssetRequest>,
                    public std::enable_shared_from_this<AssetUpload> {
 public:
  AssetUpload(RpcContext& context, v1::UploadAssetResponse& response) : context_(context), response_(response) {}

  // Starts reading. Returns the reactor for gRPC, which lives until the call is done.
  static grpc::ServerReadReactor<v1::UploadAssetRequest>* Launch(const grpc::CallbackServerContext& call,
                                                                 std::shared_ptr<AssetUpload> upload);

  void OnReadDone(bool ok) override;
  void OnCancel() override { FinishOnce(grpc::Status::CANCELLED); }
  void OnDone() override;

 private:
  // Each processes the message just read, on the executor. The call is over if the status is not OK or `complete_` is
  // set.
  grpc::Status Take();
  grpc::Status Begin();
  grpc::Status Commit();
  void FinishOnce(const grpc::Status& status);
  // Ends the call when no message has come for the longest time allowed; looks again at that time.
  void WatchIdle();

  RpcContext& context_;
  v1::UploadAssetResponse& response_;
  std::shared_ptr<AssetUpload> self_;  // until OnDone

  v1::UploadAssetRequest message_;
  bool begun_ = false;
  bool complete_ = false;  // answered early: the asset is already stored
  std::string name_;
  std::int64_t size_ = 0;
  std::int64_t received_ = 0;
  std::unique_ptr<AssetStore::Upload> upload_;

  std::mutex mutex_;
  bool finished_ = false;
  std::chrono::steady_clock::time_point last_message_ = std::chrono::steady_clock::now();
  Connections::Place place_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_ASSET_UPLOAD_H_
