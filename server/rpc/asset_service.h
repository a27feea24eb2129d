#ifndef FASCICLE_SERVER_RPC_ASSET_SERVICE_H_
#define FASCICLE_SERVER_RPC_ASSET_SERVICE_H_

#include "fascicle/v1/simulation_service.grpc.pb.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

// Files that scenes need, identified by digest.
class AssetServiceImpl : public v1::AssetService::CallbackService {
 public:
  explicit AssetServiceImpl(RpcContext& context) : context_(context) {}

  grpc::ServerUnaryReactor* FindMissingAssets(grpc::CallbackServerContext* call,
                                              const v1::FindMissingAssetsRequest* request,
                                              v1::FindMissingAssetsResponse* response) override;
  grpc::ServerReadReactor<v1::UploadAssetRequest>* UploadAsset(grpc::CallbackServerContext* call,
                                                               v1::UploadAssetResponse* response) override;

 private:
  grpc::Status Find(const v1::FindMissingAssetsRequest& request, v1::FindMissingAssetsResponse& response);

  RpcContext& context_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_ASSET_SERVICE_H_
