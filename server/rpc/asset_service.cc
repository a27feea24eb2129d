#include "server/rpc/asset_service.h"

#include <optional>
#include <string>

#include "server/rpc/asset_upload.h"
#include "server/rpc/names.h"

namespace fascicle::server {

grpc::ServerUnaryReactor* AssetServiceImpl::FindMissingAssets(grpc::CallbackServerContext* call,
                                                              const v1::FindMissingAssetsRequest* request,
                                                              v1::FindMissingAssetsResponse* response) {
  return RunUnary(context_, context_.quick, call, "FindMissingAssets",
                  [this, request, response] { return Find(*request, *response); });
}

grpc::Status AssetServiceImpl::Find(const v1::FindMissingAssetsRequest& request,
                                    v1::FindMissingAssetsResponse& response) {
  constexpr int kMost = 1000;
  if (request.names_size() > kMost) return InvalidArgument("names", "must be at most 1000");
  Problems problems;
  for (int i = 0; i < request.names_size(); ++i) {
    const std::optional<std::string> sha256_hex = ParseAssetName(request.names(i));
    if (!sha256_hex) {
      problems.Add(IndexPath("names", static_cast<std::size_t>(i)),
                   "must be assets/{sha256} in 64 lower-case hexadecimal digits");
    } else if (!context_.store.HasAsset(*sha256_hex)) {
      response.add_missing(request.names(i));
    }
  }
  return problems.empty() ? grpc::Status::OK : InvalidArgument(problems);
}

grpc::ServerReadReactor<v1::UploadAssetRequest>* AssetServiceImpl::UploadAsset(grpc::CallbackServerContext* call,
                                                                               v1::UploadAssetResponse* response) {
  return AssetUpload::Launch(*call, std::make_shared<AssetUpload>(context_, *response));
}

}  // namespace fascicle::server
