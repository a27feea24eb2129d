#include "client/lib/upload.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>

namespace fascicle::client {
namespace {

constexpr std::size_t kChunk = 1 << 20;  // [byte]
constexpr std::size_t kNamesPerCall = 1000;
constexpr std::chrono::seconds kFindTimeout(30);
constexpr std::chrono::seconds kUploadTimeout(3600);

std::string NameOf(const AssetFile& asset) { return "assets/" + asset.sha256_hex; }

grpc::Status FindMissing(Connection& connection, const std::vector<AssetFile>& assets, const std::stop_token& stop,
                         std::set<std::string>& missing) {
  for (std::size_t begin = 0; begin < assets.size(); begin += kNamesPerCall) {
    v1::FindMissingAssetsRequest request;
    const std::size_t end = std::min(assets.size(), begin + kNamesPerCall);
    for (std::size_t i = begin; i < end; ++i) request.add_names(NameOf(assets[i]));
    v1::FindMissingAssetsResponse response;
    const auto find = [&](grpc::ClientContext& context) {
      return connection.assets().FindMissingAssets(&context, request, &response);
    };
    const grpc::Status status = connection.Repeat(kFindTimeout, find, stop);
    if (!status.ok()) return status;
    missing.insert(response.missing().begin(), response.missing().end());
  }
  return grpc::Status::OK;
}

// The server may respond before it has read everything: if it refuses the asset, or has received it from another
// client.
grpc::Status UploadOnce(Connection& connection, const AssetFile& asset, grpc::ClientContext& context) {
  v1::UploadAssetResponse response;
  const auto writer = connection.assets().UploadAsset(&context, &response);
  v1::UploadAssetRequest request;
  request.set_name(NameOf(asset));
  request.set_size(static_cast<std::int64_t>(asset.bytes.size()));
  std::size_t sent = 0;
  bool open = true;
  do {
    const std::size_t size = std::min(kChunk, asset.bytes.size() - sent);
    request.set_data(asset.bytes.data() + sent, size);
    open = writer->Write(request);
    sent += size;
    request.clear_name();
    request.clear_size();
  } while (open && sent < asset.bytes.size());
  if (open) writer->WritesDone();
  return writer->Finish();
}

}  // namespace

grpc::Status UploadMissing(Connection& connection, const std::vector<AssetFile>& assets, const std::stop_token& stop) {
  if (assets.empty()) return grpc::Status::OK;
  std::set<std::string> missing;
  if (grpc::Status status = FindMissing(connection, assets, stop, missing); !status.ok()) return status;
  for (const AssetFile& asset : assets) {
    if (missing.erase(NameOf(asset)) == 0) continue;
    const auto upload = [&](grpc::ClientContext& context) { return UploadOnce(connection, asset, context); };
    const grpc::Status status = connection.Repeat(kUploadTimeout, upload, stop);
    if (!status.ok()) return status;
  }
  return grpc::Status::OK;
}

}  // namespace fascicle::client
