#include "server/rpc/log_service.h"

#include <memory>
#include <utility>

#include "server/rpc/log_stream.h"
#include "server/rpc/raw_request.h"

namespace fascicle::server {

grpc::ServerWriteReactor<grpc::ByteBuffer>* LogServiceImpl::StreamLog(grpc::CallbackServerContext* call,
                                                                      const grpc::ByteBuffer* request) {
  auto parsed = ParseRequest<v1::StreamLogRequest>(*request);
  if (!parsed) return new EndedStream(NotAMessage());
  return OutStream::Launch(*call, std::make_shared<LogStream>(context_, std::move(*parsed)));
}

}  // namespace fascicle::server
