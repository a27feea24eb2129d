#include "server/rpc/transfer_service.h"

#include <memory>
#include <utility>

#include "server/rpc/export_stream.h"
#include "server/rpc/job_upload.h"

namespace fascicle::server {

grpc::ServerWriteReactor<grpc::ByteBuffer>* TransferServiceImpl::ExportJob(grpc::CallbackServerContext* call,
                                                                           const grpc::ByteBuffer* request) {
  grpc::ByteBuffer copy(*request);  // shares the bytes; parsing consumes it
  v1::ExportJobRequest parsed;
  if (!grpc::SerializationTraits<v1::ExportJobRequest>::Deserialize(&copy, &parsed).ok()) parsed.clear_name();
  return OutStream::Launch(*call, std::make_shared<ExportStream>(context_, transfers_, parsed.name()));
}

grpc::ServerReadReactor<v1::ImportJobRequest>* TransferServiceImpl::ImportJob(grpc::CallbackServerContext* call,
                                                                              v1::Job* response) {
  return JobUpload::Launch(*call, std::make_shared<JobUpload>(context_, transfers_, *response));
}

}  // namespace fascicle::server
