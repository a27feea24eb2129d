#include "client/cli/start_frame.h"

#include <CLI/App.hpp>

#include <charconv>
#include <utility>

#include "client/cli/follow.h"
#include "client/cli/job_source.h"
#include "client/lib/decode.h"
#include "core/base/digest.h"

namespace fascicle::client {
namespace {

// JOB[:FRAME]
v1::FrameStart Parse(const std::string& text) {
  v1::FrameStart start;
  const std::size_t colon = text.rfind(':');
  std::int64_t frame = -1;
  if (colon != std::string::npos) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, frame);
    if (error != std::errc() || stop != end || frame < 0) {
      throw CommandError::Invalid("--start: expects JOB or JOB:FRAME, with the number of a frame, not " + text);
    }
    start.set_frame(frame);
  }
  start.set_job(text.substr(0, colon));
  return start;
}

v1::FrameState Fetch(Client& client, const std::string& job, const v1::FrameStart& start) {
  const std::int64_t count = Take(client.GetJob(job)).frame_count();
  const std::int64_t index = start.has_frame() ? start.frame() : count - 1;
  if (index >= count) {
    throw CommandError::Invalid("start: " + job + " has " +
                                (count == 0 ? "no frames yet" : std::to_string(count) + " frames, from 0 on"));
  }
  v1::FrameState state;
  ReadStored(client, job, FramesFrom(index), [&](const v1::Geometry& geometry, const v1::Frame& frame) {
    CheckDigest(frame);
    *state.mutable_geometry() = geometry;
    *state.mutable_frame() = frame;
    return false;
  });
  return state;
}

}  // namespace

void AddStartOption(CLI::App& command, SceneArgument& scene) {
  command
      .add_option("--start", scene.start, "Begin as a frame of another job, by default its last: positions, velocities")
      ->type_name("JOB[:FRAME]");
}

void PackStart(const Context& context, const std::string& given, ScenePackage& package) {
  if (!given.empty()) *package.scene.mutable_start()->mutable_frame() = Parse(given);
  const v1::FrameStart& wanted = package.scene.start().frame();
  if (wanted.job().empty() || wanted.has_state()) return;
  v1::FrameStart& start = *package.scene.mutable_start()->mutable_frame();
  JobSource source = OpenJob(context, start.job());
  std::string bytes = Fetch(source.client, source.job, start).SerializeAsString();
  const std::string digest = Hex(Sha256Of(bytes));
  package.assets.push_back({digest, start.job(), std::move(bytes)});
  start.set_job(source.job);
  start.mutable_state()->set_asset("assets/" + digest);
}

}  // namespace fascicle::client
