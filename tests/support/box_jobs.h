#ifndef FASCICLE_TESTS_SUPPORT_BOX_JOBS_H_
#define FASCICLE_TESTS_SUPPORT_BOX_JOBS_H_

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "core/geometry/shapes.h"
#include "core/scene/scene.h"
#include "core/sim/simulation.h"
#include "server/jobs/job_manager.h"
#include "tests/support/eventually.h"

// Small jobs with real simulations: an elastic box under gravity, fixed at one end.
namespace fascicle::server {

// The specification of such a job; its bytes are JobRecord::spec.
struct BoxSpec {
  double duration = 0.4;               // [s]
  double frame_interval = 0.02;        // [s]
  double time_step = 1e-4;             // [s]
  double gravity = 1;                  // [m/s^2] at the end; increases from 0
  double crush = 0;                    // [m] of the other end towards the fixed one; fails beyond 0.2 m
  std::int64_t cannot_be_decoded = 0;  // a number of this size, so that the bytes hold no padding
};
static_assert(std::is_trivially_copyable_v<BoxSpec> && sizeof(BoxSpec) == 6 * 8);

inline BoxSpec Longest() { return {.duration = 1000, .frame_interval = 0.01}; }  // takes minutes: only to be stopped
inline BoxSpec Collapsing() { return {.crush = 0.4}; }                           // fails after some frames

inline std::string Serialize(const BoxSpec& spec) {
  std::string bytes(sizeof spec, '\0');
  std::memcpy(bytes.data(), &spec, sizeof spec);
  return bytes;
}

inline std::shared_ptr<const Scene> MakeScene(const BoxSpec& spec) {
  auto scene = std::make_shared<Scene>();
  Body body;
  body.name = "box";
  body.tet().mesh = MakeBox(Vec3::Zero(), Vec3(0.2, 0.1, 0.1), {2, 1, 1});
  const std::vector<Triangle> surface = BoundaryTriangles(body.tet().mesh);
  body.regions.push_back(SelectRegion(body.tet().mesh, surface, "wall", PlaneSelector{Vec3::Zero(), -Vec3::UnitX()}));
  body.constraints.push_back({.region = 0, .axes = {true, true, true}, .motion = {}});
  if (spec.crush > 0) {
    body.regions.push_back(
        SelectRegion(body.tet().mesh, surface, "end", PlaneSelector{Vec3(0.2, 0, 0), Vec3::UnitX()}));
    Motion motion;
    motion.translation[0] = Curve{{0, spec.duration}, {0, -spec.crush}, Curve::Interpolation::kLinear};
    body.constraints.push_back({.region = 1, .axes = {true, true, true}, .motion = motion});
  }
  scene->name = "box";
  scene->bodies.push_back(std::move(body));
  scene->gravity = {Vec3(0, 0, -1), {{0, spec.duration}, {0, spec.gravity}, Curve::Interpolation::kLinear}};
  scene->tet.time_step = spec.time_step;
  scene->duration = spec.duration;
  scene->output.frame_interval = spec.frame_interval;
  Problems problems;
  CheckScene(*scene, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  return scene;
}

inline std::string EncodeFrame(const Frame& frame) {
  const std::vector<Vec3>& positions = frame.bodies.front().positions;
  std::string bytes(positions.size() * sizeof(Vec3), '\0');
  std::memcpy(bytes.data(), positions.data(), bytes.size());
  return bytes;
}

// One line per stage: its name and calls, those of earlier runs first.
inline std::string EncodeProfile(const RunProfile& profile) {
  std::string text = profile.earlier;
  for (const Profile* thread : {&profile.working, &profile.storing}) {
    for (const ProfileStage& stage : thread->Stages()) text += stage.name + " " + std::to_string(stage.calls) + "\n";
  }
  return text;
}

// Plain bytes. A test that needs more wraps these functions.
inline JobCodec BoxCodec() {
  JobCodec codec;
  codec.decode_scene = [](const std::string& bytes, AssetStore&, Profile*, const std::stop_token&) {
    BoxSpec spec;
    std::memcpy(&spec, bytes.data(), sizeof spec);
    if (spec.cannot_be_decoded) throw std::runtime_error("an asset was lost");
    return MakeScene(spec);
  };
  codec.encode_geometry = [](const Scene& scene, const FrameLayout& layout) {
    return scene.name + " with " + std::to_string(layout.series.size()) + " series";
  };
  codec.encode_frame = EncodeFrame;
  codec.encode_failure = [](const Failure& failure) { return failure.reason + ": " + failure.message; };
  codec.encode_warnings = [](const std::vector<Warning>& warnings, const std::string&) {
    std::string text;
    for (const Warning& warning : warnings) text += warning.reason + ": " + warning.message + "\n";
    return text;
  };
  codec.encode_profile = EncodeProfile;
  codec.encode_line = [](const LogLine& line) {
    return std::to_string(static_cast<int>(line.kind)) + " step " + std::to_string(line.step) + " " + line.text;
  };
  codec.inputs_of_spec = [](const std::string&) { return std::vector<SteeringRecord>(); };
  // An input is the factor on gravity.
  codec.decode_inputs = [](const std::string&, const std::vector<SteeringRecord>& records) {
    std::vector<SteeringInput> inputs;
    for (const SteeringRecord& record : records) {
      inputs.push_back({record.sequence, {{ControlKind::kGravity, 0, std::stod(record.input)}}, 0});
    }
    return inputs;
  };
  return codec;
}

inline JobRecord BoxJob(const BoxSpec& spec, std::string request_id = {}) {
  JobRecord record;
  record.spec = Serialize(spec);
  record.scene_name = "box";
  record.request_id = std::move(request_id);
  return record;
}

inline JobManagerOptions Workers(int count) {
  return {.workers = count, .default_threads = 1, .checkpoint_interval = std::chrono::milliseconds(0)};
}

using testing::Eventually;

inline JobView WaitForEnd(JobManager& manager, const std::string& id) {
  EXPECT_TRUE(Eventually([&] { return IsFinal(manager.Get(id)->record.state); }));
  return *manager.Get(id);
}

// Waits until at least `count` frames are stored.
inline bool WaitForFrames(JobManager& manager, const std::string& id, std::int64_t count) {
  return Eventually([&] { return manager.Get(id)->frame_count >= count; });
}

// The digests of a run with the core alone.
inline std::vector<std::string> DigestsByCore(const BoxSpec& spec) {
  struct Sink final : FrameSink {
    std::vector<std::string> digests;
    bool PutFrame(Frame frame, std::string) override {
      digests.emplace_back(frame.digest.begin(), frame.digest.end());
      return true;
    }
    void PutProgress(const Progress&) override {}
  } sink;
  Simulation(MakeScene(spec), 1).Run(sink, {});
  return sink.digests;
}

inline std::vector<std::string> StoredDigests(FrameStore& frames) {
  std::vector<std::string> digests;
  for (const FrameRecord& frame : frames.ListFrames(0, 1 << 20)) digests.push_back(frame.digest);
  return digests;
}

}  // namespace fascicle::server

#endif  // FASCICLE_TESTS_SUPPORT_BOX_JOBS_H_
