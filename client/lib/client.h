#ifndef FASCICLE_CLIENT_LIB_CLIENT_H_
#define FASCICLE_CLIENT_LIB_CLIENT_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "fascicle/v1/frame.pb.h"
#include "fascicle/v1/job.pb.h"
#include "fascicle/v1/log.pb.h"
#include "fascicle/v1/scene.pb.h"
#include "fascicle/v1/simulation_service.pb.h"
#include "fascicle/v1/steering_service.pb.h"

namespace fascicle::client {

// An unsuccessful outcome of a call. `kind` determines the exit code of the command line.
struct Error {
  enum class Kind { kInvalid, kNoServer, kNotFound, kRefused, kInternal, kStopped };
  Kind kind = Kind::kInternal;
  std::string message;  // for users
  std::string reason;   // ErrorInfo.reason; may be empty
  Problems problems;    // for kInvalid: each with its field path
};

// A result or an error.
template <class T>
class Result {
 public:
  Result(T value) : value_(std::move(value)) {}      // NOLINT(google-explicit-constructor): reads like a return value
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  bool ok() const { return value_.has_value(); }
  T& value() { return *value_; }
  const T& value() const { return *value_; }
  const Error& error() const { return error_; }

 private:
  std::optional<T> value_;
  Error error_;
};

// A file of a scene, read into memory.
struct AssetFile {
  std::string sha256_hex;
  std::string path;  // its origin, for messages
  std::string bytes;
};

// A scene whose FileRef.asset are all set, with the files.
struct ScenePackage {
  v1::Scene scene;
  std::vector<AssetFile> assets;
};

// One of many jobs to be submitted together.
struct WantedJob {
  std::string origin;           // of its scene, for messages: the name of a file
  v1::Job job;                  // with its scene, whose FileRef.asset are all set
  std::string request_id = {};  // set by SubmitAll
};

struct WatchOptions {
  std::int64_t start_index = 0;
  bool follow = true;
  v1::StreamFramesRequest::Mode mode = v1::StreamFramesRequest::MODE_ALL;
  std::int64_t end_index = 0;  // one past the last frame; 0: no end
  std::int64_t stride = 1;
  // What to receive of each frame: `positions`, `series`, names of fields; all if empty. Poses and lines always come.
  // Older servers send everything.
  std::vector<std::string> fields = {};
  v1::StreamFramesRequest::Encoding encoding = v1::StreamFramesRequest::ENCODING_STORED;
  bool compress = false;
  // How long to retry after a lost connection; restarts after every frame.
  std::chrono::seconds patience = std::chrono::seconds(30);
};

// What WatchJobs watches, and its callbacks, all on the thread that called WatchJobs.
struct JobsWatch {
  std::string filter = {};                                   // as in ListJobsRequest
  std::int64_t revision = 0;                                 // only changes after it; 0: all jobs first
  std::chrono::seconds patience = std::chrono::seconds(30);  // how long to retry after a lost connection
  // Jobs as they are now, and names of jobs that were deleted or do not pass the filter any more.
  std::function<void(const v1::WatchJobsResponse& changes)> changes = {};
  std::function<void(const std::string& message)> reconnecting = {};
};

// Which jobs ListJobs lists.
struct JobsToList {
  int limit = 50;
  std::vector<v1::Job::State> states = {};  // empty: all
  std::string filter = {};                  // as in ListJobsRequest, here and below
  std::string order_by = {};
};

// Callbacks of Watch, all on the thread that called Watch. Any may be empty.
struct WatchEvents {
  // With correct checksums, and arrays of doubles whatever the encoding. Frames that are not as stored have a
  // `derivation`.
  std::function<void(const v1::Frame& frame)> frame;
  std::function<void(v1::Job::State state, const v1::Progress& progress)> progress;
  std::function<void(const std::string& message)> reconnecting;
};

struct LogOptions {
  int tail = 0;         // only so many of the stored lines; 0: all
  bool follow = false;  // until the job is final
};

// A connection to a server ("HOST:PORT"). Thread-safe. The first call fails with kNoServer after some seconds without a
// response. Calls are repeated on UNAVAILABLE with backoff; CreateJob only with its request id, so that a job is never
// created twice.
class Client {
 public:
  explicit Client(const std::string& address);
  ~Client();
  Client(Client&&) noexcept;

  Result<v1::ServerInfo> GetServerInfo();
  // Uploads the files that the server lacks and creates the job. A stop request ends it with kStopped, and also ends
  // the server's work on the scene.
  Result<v1::Job> Submit(const ScenePackage& package, int threads, const std::stop_token& stop = {});
  // The same with threads, owner, labels, priority, ttl and pin of `wanted`.
  Result<v1::Job> Submit(const ScenePackage& package, v1::Job wanted, const std::stop_token& stop = {});
  // Uploads the files that the server lacks and creates the jobs, some hundreds in one commit. Tells each of them once
  // it is created, in their order. After an error, those that were not told are not there, unless the server was lost.
  std::optional<Error> SubmitAll(const std::vector<AssetFile>& assets, std::vector<WantedJob> jobs,
                                 const std::function<void(const v1::Job& job)>& created,
                                 const std::stop_token& stop = {});
  // Checks a scene without creating a job.
  std::optional<Error> Validate(const ScenePackage& package, int threads);
  Result<v1::Job> GetJob(const std::string& name);
  Result<std::vector<v1::Job>> ListJobs(int limit, const std::vector<v1::Job::State>& states);
  Result<std::vector<v1::Job>> ListJobs(const JobsToList& which);
  // Tells all jobs, then all changes of jobs, each once and none missed, over lost connections too. Returns when it is
  // over: kStopped after a stop request.
  Error WatchJobs(const JobsWatch& watch, const std::stop_token& stop = {});
  // Changes what the mask of the request names.
  Result<v1::Job> UpdateJob(const v1::UpdateJobRequest& request);
  Result<v1::Job> PauseJob(const std::string& name);
  Result<v1::Job> ResumeJob(const std::string& name);
  Result<v1::Job> CancelJob(const std::string& name);
  std::optional<Error> DeleteJob(const std::string& name);
  // Queues a job in a final state again, from its last checkpoint or from time 0.
  Result<v1::Job> RestartJob(const std::string& name, bool from_start);
  // Lets the server compare everything that it has of a job with its checksums.
  Result<v1::VerifyJobResponse> VerifyJob(const std::string& name);
  // Saves a job as one file that ImportJob takes: scene, geometry and frames. The file is complete or absent.
  std::optional<Error> ExportJob(const std::string& name, const std::string& path, const std::stop_token& stop = {});
  // Gives the server a job in such a file. It keeps its name if that is free there, unless `new_name` is set.
  Result<v1::Job> ImportJob(const std::string& path, bool new_name, const std::stop_token& stop = {});
  // Adds an input to a job; the answer has the step with which it takes effect.
  Result<v1::SteeringInput> ApplySteering(const std::string& name, const v1::SteeringInput& input);
  // All inputs of a job, and what can be changed.
  Result<v1::ListSteeringResponse> ListSteering(const std::string& name);
  // Creates a job with the scene and the inputs of another one.
  Result<v1::Job> SubmitAgain(const std::string& name);
  // Delivers the lines of a job's log, each once and in order, and resumes after lost connections. Returns the job when
  // the log is complete; kStopped after a stop request.
  Result<v1::Job> WatchLog(const std::string& name, const LogOptions& options,
                           const std::function<void(const v1::LogLine&)>& on_line, const std::stop_token& stop = {});
  // Waits until the job has been started; kStopped after a stop request.
  Result<v1::Geometry> GetGeometry(const std::string& name, std::stop_token stop = {});
  Result<std::vector<v1::FrameInfo>> ListFrames(const std::string& name, std::int64_t start_index);
  // Delivers frames from start_index on, each once and in order, and resumes after lost connections. Returns the job
  // when the stream is complete; kStopped after a stop request.
  Result<v1::Job> Watch(const std::string& name, const WatchOptions& options, const WatchEvents& events,
                        std::stop_token stop = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_CLIENT_H_
