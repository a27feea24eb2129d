#ifndef FASCICLE_SERVER_RPC_JOB_SERVICE_H_
#define FASCICLE_SERVER_RPC_JOB_SERVICE_H_

#include <grpcpp/support/byte_buffer.h>

#include "fascicle/v1/simulation_service.grpc.pb.h"
#include "server/rpc/rpc_context.h"

namespace fascicle::server {

using JobServiceBase = v1::JobService::WithRawCallbackMethod_WatchJobs<v1::JobService::CallbackService>;

// Submits, shows, changes, cancels, restarts, verifies and deletes jobs.
class JobServiceImpl : public JobServiceBase {
 public:
  explicit JobServiceImpl(RpcContext& context) : context_(context) {}

  grpc::ServerUnaryReactor* CreateJob(grpc::CallbackServerContext* call, const v1::CreateJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerUnaryReactor* BatchCreateJobs(grpc::CallbackServerContext* call,
                                            const v1::BatchCreateJobsRequest* request,
                                            v1::BatchCreateJobsResponse* response) override;
  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext* call, const v1::GetJobRequest* request,
                                   v1::Job* response) override;
  grpc::ServerUnaryReactor* ListJobs(grpc::CallbackServerContext* call, const v1::ListJobsRequest* request,
                                     v1::ListJobsResponse* response) override;
  grpc::ServerWriteReactor<grpc::ByteBuffer>* WatchJobs(grpc::CallbackServerContext* call,
                                                        const grpc::ByteBuffer* request) override;
  grpc::ServerUnaryReactor* UpdateJob(grpc::CallbackServerContext* call, const v1::UpdateJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerUnaryReactor* PauseJob(grpc::CallbackServerContext* call, const v1::PauseJobRequest* request,
                                     v1::Job* response) override;
  grpc::ServerUnaryReactor* ResumeJob(grpc::CallbackServerContext* call, const v1::ResumeJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerUnaryReactor* CancelJob(grpc::CallbackServerContext* call, const v1::CancelJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerUnaryReactor* DeleteJob(grpc::CallbackServerContext* call, const v1::DeleteJobRequest* request,
                                      google::protobuf::Empty* response) override;
  grpc::ServerUnaryReactor* RestartJob(grpc::CallbackServerContext* call, const v1::RestartJobRequest* request,
                                       v1::Job* response) override;
  grpc::ServerUnaryReactor* VerifyJob(grpc::CallbackServerContext* call, const v1::VerifyJobRequest* request,
                                      v1::VerifyJobResponse* response) override;

 private:
  grpc::Status List(const v1::ListJobsRequest& request, v1::ListJobsResponse& response);
  grpc::Status Update(const v1::UpdateJobRequest& request, v1::Job& response);

  RpcContext& context_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_JOB_SERVICE_H_
