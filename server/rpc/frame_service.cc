#include "server/rpc/frame_service.h"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "server/rpc/frame_stream.h"
#include "server/rpc/geometry_stream.h"
#include "server/rpc/names.h"
#include "server/rpc/raw_request.h"

namespace fascicle::server {

grpc::ServerWriteReactor<grpc::ByteBuffer>* FrameServiceImpl::GetGeometry(grpc::CallbackServerContext* call,
                                                                          const grpc::ByteBuffer* request) {
  const auto parsed = ParseRequest<v1::GetGeometryRequest>(*request);
  if (!parsed) return new EndedStream(NotAMessage());
  return OutStream::Launch(*call, std::make_shared<GeometryStream>(context_, parsed->name()));
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* FrameServiceImpl::StreamFrames(grpc::CallbackServerContext* call,
                                                                           const grpc::ByteBuffer* request) {
  auto parsed = ParseRequest<v1::StreamFramesRequest>(*request);
  if (!parsed) return new EndedStream(NotAMessage());
  return OutStream::Launch(*call, std::make_shared<FrameStream>(context_, shared_, std::move(*parsed)));
}

grpc::ServerUnaryReactor* FrameServiceImpl::ListFrames(grpc::CallbackServerContext* call,
                                                       const v1::ListFramesRequest* request,
                                                       v1::ListFramesResponse* response) {
  return RunUnary(context_, context_.quick, call, "ListFrames",
                  [this, request, response] { return List(*request, *response); });
}

void FrameServiceImpl::DropUnused() {
  constexpr std::chrono::seconds kUnused(5);
  shared_.chunks.DropUnused(kUnused);
  shared_.derived.DropUnused(kUnused);
}

grpc::Status FrameServiceImpl::List(const v1::ListFramesRequest& request, v1::ListFramesResponse& response) {
  Problems problems;
  const std::optional<std::string> id = ParseJobName(request.name());
  if (!id) problems.Add("name", "must be jobs/{id}");
  if (request.start_index() < 0) problems.Add("start_index", "must not be negative");
  if (request.page_size() < 0 || request.page_size() > 10'000) problems.Add("page_size", "must be in [0, 10000]");
  if (!problems.empty()) return InvalidArgument(problems);
  const std::optional<JobView> view = context_.jobs.Get(*id);
  const std::shared_ptr<FrameStore> frames = view ? context_.jobs.Frames(*id) : nullptr;
  if (!frames) return NotFound("job", request.name());
  if (request.start_index() < view->record.first_frame) {
    return FramesRemoved(request.name(), view->record.first_frame);
  }
  const int page_size = request.page_size() == 0 ? 1000 : request.page_size();
  for (const FrameRecord& record : frames->ListFrames(request.start_index(), page_size)) {
    v1::FrameInfo* info = response.add_frames();
    info->set_index(record.index);
    info->set_time(record.time);
    info->set_step(record.step);
    info->set_size(record.size);
    info->set_digest(record.digest);
  }
  return grpc::Status::OK;
}

}  // namespace fascicle::server
