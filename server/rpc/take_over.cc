#include "server/rpc/take_over.h"

#include <cmath>
#include <string>
#include <utility>

#include <google/protobuf/util/time_util.h>

#include "core/base/digest.h"
#include "core/base/stop.h"
#include "proto/frames/frame_digest.h"
#include "proto/frames/frame_fits.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/job_settings.h"
#include "server/rpc/names.h"
#include "server/translate/steering.h"

namespace fascicle::server {
namespace {

using google::protobuf::util::TimeUtil;

// Of what lists of jobs contain, and of other parts [byte].
constexpr std::size_t kMostName = 1000, kMostFailure = std::size_t{16} << 10, kMostProfile = std::size_t{1} << 20;

v1::Job ReadJobMessage(JobFileReader& file) {
  v1::Job job;
  if (!job.ParseFromString(file.ReadJob()) || !job.has_scene())
    throw JobFileError("the file has no scene that can be read");
  const bool short_enough = job.scene_name().size() <= kMostName && job.failure().ByteSizeLong() <= kMostFailure &&
                            job.profile().ByteSizeLong() <= kMostProfile;
  if (!short_enough || !v1::Job::State_IsValid(job.state()) || job.threads() < 0 || job.threads() > 256) {
    throw JobFileError("the file describes a job that is not possible");
  }
  Problems problems;
  CheckSettings(job, problems);
  CheckInputs(job, "job.inputs", problems);
  // There may be hundreds, and the text is sent as metadata.
  if (!problems.empty()) {
    const Problem& first = problems.kept().front();
    throw JobFileError("the file describes a job that is not possible: " + first.path + ": " + first.message +
                       (problems.count() > 1 ? ", and " + std::to_string(problems.count() - 1) + " more" : ""));
  }
  return job;
}

bool IsFinalState(v1::Job::State state) {
  return state == v1::Job::STATE_SUCCEEDED || state == v1::Job::STATE_FAILED || state == v1::Job::STATE_CANCELLED;
}

std::int64_t MicrosecondsOf(const google::protobuf::Timestamp& time) {
  constexpr std::int64_t kYear10000 = 253'402'300'800;  // [s]
  const bool is_possible = time.seconds() >= 0 && time.seconds() < kYear10000 && time.nanos() >= 0;
  return is_possible ? time.seconds() * 1'000'000 + time.nanos() / 1'000 : 0;
}

// The job as this server will keep it, without its frames.
JobRecord RecordOf(const v1::Job& job, const v1::ImportJobRequest& request) {
  JobRecord record;
  record.request_id = request.request_id();
  record.scene_name = job.scene_name();
  record.spec = SpecOf(job);
  CopySettings(job, record);
  // Its end may be longer ago than jobs are kept here.
  record.ttl_s = 0;
  record.is_pinned = true;
  record.threads = job.threads();
  record.state = IsFinalState(job.state()) ? static_cast<JobState>(job.state()) : JobState::kCancelled;
  if (job.has_failure()) record.failure = job.failure().SerializeAsString();
  if (job.has_profile()) record.profile = job.profile().SerializeAsString();
  v1::Warnings warnings;
  *warnings.mutable_warnings() = job.warnings();
  warnings.mutable_imported()->set_original_name(job.name());
  warnings.mutable_imported()->set_original_state(job.state());
  *warnings.mutable_imported()->mutable_time() = TimeUtil::GetCurrentTime();
  record.warnings = warnings.SerializeAsString();
  record.attempt = job.attempt();
  record.create_time_us = MicrosecondsOf(job.create_time());
  record.start_time_us = MicrosecondsOf(job.start_time());
  record.end_time_us = MicrosecondsOf(job.end_time());
  record.fraction = std::isfinite(job.progress().fraction()) ? job.progress().fraction() : 0;
  record.time = std::isfinite(job.progress().time()) ? job.progress().time() : 0;
  record.step = job.progress().step();
  return record;
}

void CheckFrame(const JobFileReader::StoredFrame& stored, const v1::Geometry& geometry) {
  const FrameRecord& record = stored.record;
  v1::Frame frame;
  if (!frame.ParseFromString(stored.bytes) || frame.index() != record.index || frame.time() != record.time ||
      frame.step() != record.step || frame.digest() != record.digest || frame.digest() != DigestOfNumbers(frame) ||
      frame.has_derivation() || !FrameFits(frame, geometry)) {
    throw JobFileError("frame " + std::to_string(record.index) +
                       " is damaged: its digest is not that of its numbers, or it does not fit the job");
  }
}

// Copies geometry and frames. Returns the digest of everything.
std::string Copy(JobFileReader& file, FrameStore& frames, const std::function<bool()>& go_on) {
  const std::string bytes = file.ReadGeometry();
  v1::Geometry geometry;
  if (!geometry.ParseFromString(bytes)) throw JobFileError("the file has no geometry that can be read");
  Sha256 sha;
  sha.Update(bytes);
  if (!bytes.empty()) frames.PutGeometry(bytes);
  for (std::int64_t index = 0; index < file.frame_count(); ++index) {
    if (!go_on()) throw Stopped();
    const JobFileReader::StoredFrame stored = file.ReadNextFrame();
    CheckFrame(stored, geometry);
    frames.PutFrame(stored.record, stored.bytes, "");
    sha.Update(stored.record.digest);
  }
  return Hex(sha.Finish());
}

}  // namespace

grpc::Status TakeOver(RpcContext& context, JobFileReader& file, const v1::ImportJobRequest& request,
                      const std::function<bool()>& go_on, v1::Job& imported) {
  const v1::Job job = ReadJobMessage(file);
  JobRecord record = RecordOf(job, request);
  const std::string original = request.new_name() ? "" : ParseJobName(job.name()).value_or("");
  const JobManager::Staged staged = context.jobs.Stage(original, record);
  record.id = staged.id;
  record.request_digest = Hex(Sha256Of(record.spec + Copy(file, *staged.frames, go_on)));
  record.frame_count = staged.frames->frame_count();
  record.stored_bytes = staged.frames->stored_bytes();
  imported = ToMessage(context.jobs.AddFinished(record));
  return grpc::Status::OK;
}

}  // namespace fascicle::server
