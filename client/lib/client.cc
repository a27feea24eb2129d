#include "client/lib/client.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>
#include <span>
#include <utility>

#include "client/lib/connection.h"
#include "client/lib/status_error.h"
#include "client/lib/submit_all.h"
#include "client/lib/transfer.h"
#include "client/lib/upload.h"
#include "client/lib/watch.h"
#include "client/lib/watch_jobs.h"
#include "client/lib/watch_log.h"
#include "proto/frames/replayed_input.h"

namespace fascicle::client {
namespace {

constexpr std::chrono::seconds kTimeout(30);
// Before it answers, the server reads and checks all meshes of the scene and solves for fibres.
constexpr std::chrono::seconds kCreateTimeout(900);

// 128 random bits, unique for all practical purposes.
std::string RandomRequestId() {
  std::random_device random;
  std::string id;
  for (int i = 0; i < 4; ++i) {
    std::array<char, 9> hex;
    std::snprintf(hex.data(), hex.size(), "%08x", random());
    id += hex.data();
  }
  return id;
}

}  // namespace

struct Client::Impl {
  explicit Impl(const std::string& address) : connection(address) {}

  // A unary call; returns its response or error.
  template <class Response, class Call>
  Result<Response> Ask(std::chrono::seconds timeout, const Call& call, const std::stop_token& stop = {}) {
    Response response;
    const grpc::Status status = connection.Repeat(
        timeout, [&](grpc::ClientContext& context) { return call(context, response); }, stop);
    if (!status.ok()) return ErrorOf(status, connection.address());
    return response;
  }

  // Uploads missing files, then creates jobs by `call`; repeats both if an asset disappeared in between.
  template <class Response, class Call>
  Result<Response> Create(const std::vector<AssetFile>& assets, const Call& call, const std::stop_token& stop) {
    constexpr int kAttempts = 3;
    for (int attempt = 1;; ++attempt) {
      if (grpc::Status status = UploadMissing(connection, assets, stop); !status.ok()) {
        return ErrorOf(status, connection.address());
      }
      Result<Response> created = Ask<Response>(kCreateTimeout, call, stop);
      if (!created.ok() && stop.stop_requested()) {
        return Error{Error::Kind::kStopped, "stopped before the job was created", "", {}};
      }
      if (created.ok() || created.error().reason != "MISSING_ASSET" || attempt == kAttempts) return created;
    }
  }

  Result<v1::Job> CreateOne(const ScenePackage& package, const v1::CreateJobRequest& request,
                            const std::stop_token& stop) {
    const auto create = [&](grpc::ClientContext& context, v1::Job& response) {
      return connection.jobs().CreateJob(&context, request, &response);
    };
    return Create<v1::Job>(package.assets, create, stop);
  }

  Result<v1::BatchCreateJobsResponse> CreateBatch(const std::vector<AssetFile>& assets, std::span<const WantedJob> jobs,
                                                  const std::stop_token& stop) {
    v1::BatchCreateJobsRequest request;
    for (const WantedJob& job : jobs) {
      v1::CreateJobRequest& one = *request.add_requests();
      *one.mutable_job() = job.job;
      one.set_request_id(job.request_id);
    }
    const auto create = [&](grpc::ClientContext& context, v1::BatchCreateJobsResponse& response) {
      return connection.jobs().BatchCreateJobs(&context, request, &response);
    };
    return Create<v1::BatchCreateJobsResponse>(assets, create, stop);
  }

  Connection connection;
};

Client::Client(const std::string& address) : impl_(std::make_unique<Impl>(address)) {}

Client::~Client() = default;

Client::Client(Client&&) noexcept = default;

Result<v1::ServerInfo> Client::GetServerInfo() {
  return impl_->Ask<v1::ServerInfo>(kTimeout, [this](grpc::ClientContext& context, v1::ServerInfo& response) {
    return impl_->connection.server().GetServerInfo(&context, {}, &response);
  });
}

Result<v1::Job> Client::Submit(const ScenePackage& package, int threads, const std::stop_token& stop) {
  v1::Job wanted;
  wanted.set_threads(threads);
  return Submit(package, std::move(wanted), stop);
}

Result<v1::Job> Client::Submit(const ScenePackage& package, v1::Job wanted, const std::stop_token& stop) {
  v1::CreateJobRequest request;
  *request.mutable_job() = std::move(wanted);
  *request.mutable_job()->mutable_scene() = package.scene;
  request.set_request_id(RandomRequestId());
  return impl_->CreateOne(package, request, stop);
}

std::optional<Error> Client::SubmitAll(const std::vector<AssetFile>& assets, std::vector<WantedJob> jobs,
                                       const std::function<void(const v1::Job& job)>& created,
                                       const std::stop_token& stop) {
  // A job keeps its id if it is sent again in a smaller batch.
  for (WantedJob& job : jobs) job.request_id = RandomRequestId();
  return SendInBatches(jobs, [&](std::span<const WantedJob> batch) -> std::optional<Error> {
    const Result<v1::BatchCreateJobsResponse> answer = impl_->CreateBatch(assets, batch, stop);
    if (!answer.ok()) return ErrorOfBatch(answer.error(), batch);
    for (const v1::Job& job : answer.value().jobs()) created(job);
    return std::nullopt;
  });
}

std::optional<Error> Client::Validate(const ScenePackage& package, int threads) {
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = package.scene;
  request.mutable_job()->set_threads(threads);
  request.set_validate_only(true);
  const Result<v1::Job> job = impl_->CreateOne(package, request, {});
  if (job.ok()) return std::nullopt;
  return job.error();
}

Result<v1::Job> Client::GetJob(const std::string& name) {
  v1::GetJobRequest request;
  request.set_name(name);
  return impl_->Ask<v1::Job>(kTimeout, [&](grpc::ClientContext& context, v1::Job& response) {
    return impl_->connection.jobs().GetJob(&context, request, &response);
  });
}

Result<std::vector<v1::Job>> Client::ListJobs(int limit, const std::vector<v1::Job::State>& states) {
  return ListJobs({.limit = limit, .states = states});
}

Result<std::vector<v1::Job>> Client::ListJobs(const JobsToList& which) {
  constexpr int kLargestPage = 1000;
  std::vector<v1::Job> jobs;
  v1::ListJobsRequest request;
  for (const v1::Job::State state : which.states) request.add_states(state);
  request.set_filter(which.filter);
  request.set_order_by(which.order_by);
  while (static_cast<int>(jobs.size()) < which.limit) {
    request.set_page_size(std::min(which.limit - static_cast<int>(jobs.size()), kLargestPage));
    auto page = impl_->Ask<v1::ListJobsResponse>(kTimeout, [&](grpc::ClientContext& context, auto& response) {
      return impl_->connection.jobs().ListJobs(&context, request, &response);
    });
    if (!page.ok()) return page.error();
    for (v1::Job& job : *page.value().mutable_jobs()) jobs.push_back(std::move(job));
    if (page.value().next_page_token().empty()) break;
    request.set_page_token(page.value().next_page_token());
  }
  return jobs;
}

Error Client::WatchJobs(const JobsWatch& watch, const std::stop_token& stop) {
  return WatchAllJobs(impl_->connection, watch, stop);
}

Result<v1::Job> Client::UpdateJob(const v1::UpdateJobRequest& request) {
  return impl_->Ask<v1::Job>(kTimeout, [&](grpc::ClientContext& context, v1::Job& response) {
    return impl_->connection.jobs().UpdateJob(&context, request, &response);
  });
}

Result<v1::Job> Client::PauseJob(const std::string& name) {
  v1::PauseJobRequest request;
  request.set_name(name);
  return impl_->Ask<v1::Job>(kTimeout, [&](grpc::ClientContext& context, v1::Job& response) {
    return impl_->connection.jobs().PauseJob(&context, request, &response);
  });
}

Result<v1::Job> Client::ResumeJob(const std::string& name) {
  v1::ResumeJobRequest request;
  request.set_name(name);
  return impl_->Ask<v1::Job>(kTimeout, [&](grpc::ClientContext& context, v1::Job& response) {
    return impl_->connection.jobs().ResumeJob(&context, request, &response);
  });
}

Result<v1::Job> Client::CancelJob(const std::string& name) {
  v1::CancelJobRequest request;
  request.set_name(name);
  return impl_->Ask<v1::Job>(kTimeout, [&](grpc::ClientContext& context, v1::Job& response) {
    return impl_->connection.jobs().CancelJob(&context, request, &response);
  });
}

Result<v1::Job> Client::RestartJob(const std::string& name, bool from_start) {
  v1::RestartJobRequest request;
  request.set_name(name);
  request.set_from_start(from_start);
  return impl_->Ask<v1::Job>(kTimeout, [&](grpc::ClientContext& context, v1::Job& response) {
    return impl_->connection.jobs().RestartJob(&context, request, &response);
  });
}

Result<v1::VerifyJobResponse> Client::VerifyJob(const std::string& name) {
  constexpr std::chrono::hours kLongest(1);  // the server reads all frames
  v1::VerifyJobRequest request;
  request.set_name(name);
  return impl_->Ask<v1::VerifyJobResponse>(kLongest, [&](grpc::ClientContext& context, auto& response) {
    return impl_->connection.jobs().VerifyJob(&context, request, &response);
  });
}

std::optional<Error> Client::DeleteJob(const std::string& name) {
  v1::DeleteJobRequest request;
  request.set_name(name);
  const auto done = impl_->Ask<google::protobuf::Empty>(kTimeout, [&](grpc::ClientContext& context, auto& response) {
    return impl_->connection.jobs().DeleteJob(&context, request, &response);
  });
  if (done.ok()) return std::nullopt;
  return done.error();
}

std::optional<Error> Client::ExportJob(const std::string& name, const std::string& path, const std::stop_token& stop) {
  return DownloadJob(impl_->connection, name, path, stop);
}

Result<v1::Job> Client::ImportJob(const std::string& path, bool new_name, const std::stop_token& stop) {
  return UploadJob(impl_->connection, path, new_name, RandomRequestId(), stop);
}

Result<v1::SteeringInput> Client::ApplySteering(const std::string& name, const v1::SteeringInput& input) {
  v1::ApplySteeringRequest request;
  request.set_name(name);
  *request.mutable_input() = input;
  auto answer = impl_->Ask<v1::ApplySteeringResponse>(kTimeout, [&](grpc::ClientContext& context, auto& response) {
    return impl_->connection.steering().ApplySteering(&context, request, &response);
  });
  if (!answer.ok()) return answer.error();
  return std::move(*answer.value().mutable_input());
}

Result<v1::ListSteeringResponse> Client::ListSteering(const std::string& name) {
  v1::ListSteeringRequest request;
  request.set_name(name);
  request.set_start_sequence(1);
  google::protobuf::RepeatedPtrField<v1::SteeringInput> inputs;
  while (true) {
    auto page = impl_->Ask<v1::ListSteeringResponse>(kTimeout, [&](grpc::ClientContext& context, auto& response) {
      return impl_->connection.steering().ListSteering(&context, request, &response);
    });
    if (!page.ok()) return page.error();
    const bool is_last = page.value().inputs_size() == 0;
    if (!is_last) request.set_start_sequence(page.value().inputs().rbegin()->sequence() + 1);
    for (v1::SteeringInput& input : *page.value().mutable_inputs()) inputs.Add(std::move(input));
    if (!is_last) continue;
    page.value().mutable_inputs()->Swap(&inputs);
    return page;
  }
}

Result<v1::Job> Client::SubmitAgain(const std::string& name) {
  Result<v1::Job> job = GetJob(name);
  if (!job.ok()) return job.error();
  Result<v1::ListSteeringResponse> steering = ListSteering(name);
  if (!steering.ok()) return steering.error();
  v1::CreateJobRequest request;
  request.mutable_job()->mutable_scene()->Swap(job.value().mutable_scene());
  request.mutable_job()->set_threads(job.value().threads());
  request.mutable_job()->set_owner(job.value().owner());
  request.set_request_id(RandomRequestId());
  for (v1::SteeringInput& input : *steering.value().mutable_inputs()) {
    *request.mutable_job()->add_inputs() = ReplayedInput(std::move(input));
  }
  return impl_->CreateOne({}, request, {});
}

Result<v1::Job> Client::WatchLog(const std::string& name, const LogOptions& options,
                                 const std::function<void(const v1::LogLine&)>& on_line, const std::stop_token& stop) {
  return fascicle::client::WatchLog(impl_->connection, name, options, on_line, stop);
}

Result<v1::Geometry> Client::GetGeometry(const std::string& name, std::stop_token stop) {
  return FetchGeometry(impl_->connection, name, stop);
}

Result<std::vector<v1::FrameInfo>> Client::ListFrames(const std::string& name, std::int64_t start_index) {
  constexpr int kPage = 10'000;
  std::vector<v1::FrameInfo> frames;
  v1::ListFramesRequest request;
  request.set_name(name);
  request.set_start_index(start_index);
  request.set_page_size(kPage);
  while (true) {
    auto page = impl_->Ask<v1::ListFramesResponse>(kTimeout, [&](grpc::ClientContext& context, auto& response) {
      return impl_->connection.frames().ListFrames(&context, request, &response);
    });
    if (!page.ok()) return page.error();
    for (v1::FrameInfo& frame : *page.value().mutable_frames()) frames.push_back(std::move(frame));
    if (page.value().frames_size() < kPage) return frames;
    request.set_start_index(frames.back().index() + 1);
  }
}

Result<v1::Job> Client::Watch(const std::string& name, const WatchOptions& options, const WatchEvents& events,
                              std::stop_token stop) {
  return WatchJob(impl_->connection, name, options, events, stop);
}

}  // namespace fascicle::client
