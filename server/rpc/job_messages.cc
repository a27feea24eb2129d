#include "server/rpc/job_messages.h"

#include <cmath>
#include <cstdint>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "core/base/digest.h"
#include "server/rpc/names.h"

namespace fascicle::server {

google::protobuf::Timestamp TimestampOf(std::int64_t microseconds) {
  google::protobuf::Timestamp timestamp;
  timestamp.set_seconds(microseconds / 1'000'000);
  timestamp.set_nanos(static_cast<int>(microseconds % 1'000'000) * 1'000);
  return timestamp;
}

namespace {

// The same bytes for the same message.
std::string SerializeAlways(const v1::Job& job) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream out(&stream);
    out.SetSerializationDeterministic(true);
    job.SerializeToCodedStream(&out);
  }
  return bytes;
}

}  // namespace

std::string SpecOf(const v1::Job& requested) {
  v1::Job spec;
  *spec.mutable_scene() = requested.scene();
  spec.set_threads(requested.threads());
  *spec.mutable_inputs() = requested.inputs();
  return SerializeAlways(spec);
}

std::string DigestOf(const v1::Job& requested) {
  v1::Job wanted;
  *wanted.mutable_scene() = requested.scene();
  wanted.set_threads(requested.threads());
  *wanted.mutable_inputs() = requested.inputs();
  wanted.set_owner(requested.owner());
  wanted.set_priority(requested.priority());
  *wanted.mutable_labels() = requested.labels();
  if (requested.has_ttl()) *wanted.mutable_ttl() = requested.ttl();
  wanted.set_pinned(requested.pinned());
  return Hex(Sha256Of(SerializeAlways(wanted)));
}

v1::Job::State StateOf(const JobView& view) { return static_cast<v1::Job::State>(view.record.state); }

v1::Progress ProgressOf(const JobView& view) {
  v1::Progress progress;
  progress.set_fraction(view.progress.fraction);
  progress.set_time(view.progress.time);
  progress.set_step(view.progress.step);
  progress.set_time_step(view.progress.time_step);
  progress.set_waiting(view.waiting);
  if (view.eta_seconds >= 0) {
    const double seconds = std::floor(view.eta_seconds);
    progress.mutable_eta()->set_seconds(static_cast<std::int64_t>(seconds));
    progress.mutable_eta()->set_nanos(static_cast<int>((view.eta_seconds - seconds) * 1e9));
  }
  return progress;
}

v1::Job ToMessage(const JobView& view) {
  const JobRecord& record = view.record;
  v1::Job job;
  job.set_name(JobName(record.id));
  job.set_threads(record.threads);
  job.set_scene_name(record.scene_name);
  job.set_state(StateOf(view));
  if (record.state == JobState::kFailed) job.mutable_failure()->ParseFromString(record.failure);
  if (!record.profile.empty()) job.mutable_profile()->ParseFromString(record.profile);
  v1::Warnings warnings;
  if (warnings.ParseFromString(record.warnings)) {
    job.mutable_warnings()->Swap(warnings.mutable_warnings());
    if (warnings.has_imported()) job.mutable_imported()->Swap(warnings.mutable_imported());
  }
  *job.mutable_progress() = ProgressOf(view);
  job.set_queue_position(view.queue_position);
  job.set_attempt(static_cast<int>(record.attempt));
  if (record.create_time_us != 0) *job.mutable_create_time() = TimestampOf(record.create_time_us);
  if (record.start_time_us != 0) *job.mutable_start_time() = TimestampOf(record.start_time_us);
  if (record.end_time_us != 0) *job.mutable_end_time() = TimestampOf(record.end_time_us);
  job.set_generation(record.generation);
  job.set_frame_count(view.frame_count);
  job.set_stored_bytes(view.stored_bytes);
  job.set_owner(record.owner);
  job.set_priority(record.priority);
  job.mutable_labels()->insert(record.labels.begin(), record.labels.end());
  if (record.ttl_s > 0) job.mutable_ttl()->set_seconds(record.ttl_s);
  job.set_pinned(record.is_pinned);
  job.set_revision(record.revision);
  job.set_first_frame(record.first_frame);
  job.set_threads_in_use(view.threads);
  return job;
}

v1::Job ToListedMessage(const JobView& view) {
  v1::Job job = ToMessage(view);
  job.clear_profile();
  job.clear_warnings();
  return job;
}

v1::Job ToMessageWithScene(const JobView& view) {
  v1::Job job = ToMessage(view);
  v1::Job spec;
  if (spec.ParseFromString(view.record.spec)) job.mutable_scene()->Swap(spec.mutable_scene());
  return job;
}

}  // namespace fascicle::server
