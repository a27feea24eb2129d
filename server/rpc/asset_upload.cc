#include "server/rpc/asset_upload.h"

#include <optional>
#include <utility>

#include "server/rpc/names.h"

namespace fascicle::server {

grpc::ServerReadReactor<v1::UploadAssetRequest>* AssetUpload::Launch(const grpc::CallbackServerContext& call,
                                                                     std::shared_ptr<AssetUpload> upload) {
  AssetUpload* reactor = upload.get();
  reactor->self_ = upload;
  Connections::Entry entry = reactor->context_.connections.Enter(call.peer(), CallKind::kUpload);
  if (!entry.status.ok()) {
    reactor->FinishOnce(entry.status);
    return reactor;
  }
  reactor->place_ = std::move(entry.place);
  const std::weak_ptr<AssetUpload> weak = upload;
  const bool added = reactor->context_.streams.Add(reactor, [weak](const grpc::Status& status) {
    if (const auto open = weak.lock()) open->FinishOnce(status);
  });
  if (added) {
    reactor->StartRead(&reactor->message_);
    reactor->WatchIdle();
  } else {
    reactor->FinishOnce(ShuttingDown());
  }
  return reactor;
}

void AssetUpload::OnReadDone(bool ok) {
  context_.uploads.Post([upload = shared_from_this(), ok] {
    {
      std::lock_guard lock(upload->mutex_);
      if (upload->finished_) return;
      upload->last_message_ = std::chrono::steady_clock::now();
    }
    const grpc::Status status =
        Guarded(upload->context_.log, "UploadAsset", [&] { return ok ? upload->Take() : upload->Commit(); });
    if (!ok || !status.ok() || upload->complete_) {
      upload->FinishOnce(status);
      return;
    }
    std::lock_guard lock(upload->mutex_);
    if (!upload->finished_) upload->StartRead(&upload->message_);
  });
}

grpc::Status AssetUpload::Begin() {
  const std::optional<std::string> sha256_hex = ParseAssetName(message_.name());
  if (!sha256_hex) return InvalidArgument("name", "must be assets/{sha256} in 64 lower-case hexadecimal digits");
  if (message_.size() < 0) return InvalidArgument("size", "must not be negative");
  if (message_.size() > context_.settings.max_asset_size) {
    return ResourceExhausted(
        "ASSET_TOO_LARGE", message_.name(),
        "an asset may have at most " + std::to_string(context_.settings.max_asset_size) + " bytes");
  }
  name_ = message_.name();
  size_ = message_.size();
  begun_ = true;
  if (context_.store.HasAsset(*sha256_hex)) {
    complete_ = true;
    return grpc::Status::OK;
  }
  upload_ = context_.store.BeginUpload(*sha256_hex, size_);
  return grpc::Status::OK;
}

grpc::Status AssetUpload::Take() {
  constexpr std::size_t kLargestChunk = 1 << 20;
  if (!begun_) {
    if (grpc::Status status = Begin(); !status.ok() || complete_) return status;
  }
  const std::string& data = message_.data();
  if (data.size() > kLargestChunk) return InvalidArgument("data", "must have at most 1 MiB in each message");
  received_ += static_cast<std::int64_t>(data.size());
  if (received_ > size_) return InvalidArgument("SIZE_MISMATCH", "data", "is more than the announced size");
  upload_->Write(data);
  return grpc::Status::OK;
}

grpc::Status AssetUpload::Commit() {
  if (!begun_) return InvalidArgument("name", "no message was sent");
  if (received_ != size_) return InvalidArgument("SIZE_MISMATCH", "data", "is less than the announced size");
  if (!upload_->Commit()) {
    return InvalidArgument("DIGEST_MISMATCH", "data", "does not have the digest given by the name");
  }
  return grpc::Status::OK;
}

void AssetUpload::FinishOnce(const grpc::Status& status) {
  {
    std::lock_guard lock(mutex_);
    if (finished_) return;
    finished_ = true;
  }
  if (status.ok()) {  // not earlier: after Finish the response may be destroyed at any time
    response_.set_name(name_);
    response_.set_size(size_);
  }
  Finish(status);
}

void AssetUpload::OnDone() {
  context_.streams.Remove(this);
  // A broken upload leaves nothing. Removing its file is left to the executor and to the last owner of the upload,
  // because a message may still be in progress.
  context_.uploads.Post([upload = std::move(self_)] {});
}

void AssetUpload::WatchIdle() {
  using std::chrono::milliseconds;
  const milliseconds longest = context_.settings.limits.idle_upload;
  milliseconds rest = longest;
  {
    std::lock_guard lock(mutex_);
    if (finished_) return;
    rest -= std::chrono::floor<milliseconds>(std::chrono::steady_clock::now() - last_message_);
  }
  if (rest <= milliseconds(0)) {
    FinishOnce(DeadlineExceeded("IDLE_UPLOAD",
                                "no part of the file has come for " + std::to_string(longest.count() / 1000) + " s"));
    return;
  }
  context_.uploads.PostAfter(rest, [weak = weak_from_this()] {
    if (const auto upload = weak.lock()) upload->WatchIdle();
  });
}

}  // namespace fascicle::server
