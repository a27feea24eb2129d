// Moving rigid bodies and lines through the whole system: from the frames of a simulation through the store, a server
// and the client library to every file that the program writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "client/lib/client.h"
#include "client/lib/decode.h"
#include "core/sim/simulation.h"
#include "server/embedded_server.h"
#include "server/jobs/frame_writer.h"
#include "server/store/store.h"
#include "server/translate/job_codec.h"
#include "tests/support/child_process.h"
#include "tests/support/paths.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using ::fascicle::testing::Finished;
using ::fascicle::testing::ReadFile;
using ::fascicle::testing::RunProgram;
using ::fascicle::testing::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kFrames = 6;

// A box of 10 x 10 x 100 mm that extends downwards along z from the origin of its frame.
TriangleMesh BoneShape() {
  TriangleMesh box;
  for (int n = 0; n < 8; ++n) box.nodes.emplace_back(0.01 * (n & 1), 0.01 * (n >> 1 & 1), -0.1 * (1 - (n >> 2)));
  box.triangles = {{0, 3, 1}, {0, 2, 3}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 7, 3}, {2, 6, 7}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return box;
}

void AddObjects(FrameLayout& layout) {
  layout.rigid_bodies.push_back({"forearm", BoneShape(), {Vec3(-0.03, 0.02, 0.08), {1, 0, 0, 0}}, true, false});
  layout.lines.push_back({"flexor", {{"activation", "1", "how active it is"}, {"length", "m", "of its path"}}});
}

// The bone swings about y, and a muscle wraps around an increasing number of points.
void AddObjects(Frame& frame) {
  const double angle = 0.15 * static_cast<double>(frame.index);
  frame.poses = {{Vec3(-0.03, 0.02, 0.08), {std::cos(angle / 2), 0, std::sin(angle / 2), 0}}};
  LineFrame& line = frame.lines.emplace_back();
  double length = 0;
  for (std::int64_t i = 0; i < 3 + frame.index; ++i) {
    const double s = static_cast<double>(i) / static_cast<double>(2 + frame.index);
    line.points.emplace_back(-0.03 + 0.09 * s, -0.01, 0.09 - 0.05 * s * s);
    if (i > 0) length += (line.points.back() - line.points[line.points.size() - 2]).norm();
  }
  line.values = {0.2 * static_cast<double>(frame.index), length};
  frame.digest = DigestOf(frame);
}

// Adds objects to the frames of a simulation and forwards them.
class WithObjects final : public FrameSink {
 public:
  explicit WithObjects(FrameSink& next) : next_(next) {}
  bool PutFrame(Frame frame, std::string checkpoint) override {
    AddObjects(frame);
    frames.push_back(frame);
    return next_.PutFrame(std::move(frame), std::move(checkpoint));
  }
  void PutProgress(const Progress& progress) override { next_.PutProgress(progress); }

  std::vector<Frame> frames;

 private:
  FrameSink& next_;
};

v1::Scene BoxOverGround() {
  v1::Scene scene = SwingingBox(0.02 * (kFrames - 1), 0.02);
  v1::Floor& floor = *scene.add_floors();
  floor.set_name("ground");
  for (const double x : {0.0, 0.0, -0.03}) floor.add_point(x);
  for (const double x : {0.0, 0.0, 1.0}) floor.add_normal(x);
  return scene;
}

server::JobRecord RecordOf(int number, const v1::Scene& scene) {
  server::JobRecord record;
  record.id = "0000000000000000000000000" + std::to_string(number);
  record.scene_name = scene.name();
  v1::Job job;
  *job.mutable_scene() = scene;
  record.spec = job.SerializeAsString();
  record.create_time_us = 1'700'000'000'000'000;
  return record;
}

void End(server::ActiveJob& job, server::JobState state, const std::string& failure) {
  job.Update([&](server::JobRecord& record) {
    record.state = state;
    record.failure = failure;
    return true;
  });
}

// Runs the scene as a worker does, with added objects; returns its frames.
std::vector<Frame> StoreRun(server::Store& store) {
  const server::JobRecord record = RecordOf(1, BoxOverGround());
  server::JobRecord existing;
  EXPECT_TRUE(store.CreateJob(record, &existing));
  const server::JobCodec codec = server::MakeJobCodec(nullptr);
  const auto scene = codec.decode_scene(record.spec, store, nullptr, {});
  server::ActiveJob job(store, record);
  job.SetFrames(store.OpenFrames(record.id));
  Simulation simulation(scene, 1);
  FrameLayout layout = simulation.layout();
  AddObjects(layout);
  job.frames()->PutGeometry(codec.encode_geometry(*scene, layout));
  server::RunProfile profile;
  server::FrameWriter writer(store, job, codec, profile, [] {});
  WithObjects sink(writer);
  EXPECT_EQ(simulation.Run(sink, {}).kind, Outcome::Kind::kSucceeded);
  writer.Finish();
  End(job, server::JobState::kSucceeded, {});
  return sink.frames;
}

void StoreFailure(int number, const std::string& failure, server::Store& store) {
  const server::JobRecord record = RecordOf(number, BoxOverGround());
  server::JobRecord existing;
  EXPECT_TRUE(store.CreateJob(record, &existing));
  server::ActiveJob job(store, record);
  job.SetFrames(store.OpenFrames(record.id));
  End(job, server::JobState::kFailed, failure);
}

// A server with one job that has all kinds of objects, and two failed jobs.
class ObjectsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    {
      const auto store = server::OpenSqliteStore(*folder_ / "data");
      frames_ = new std::vector<Frame>(StoreRun(*store));
      Failure failure;
      failure.reason = "NOT_CONVERGED";
      failure.object_kind = ObjectKind::kJoint;
      failure.object = "elbow";
      StoreFailure(2, server::MakeJobCodec(nullptr).encode_failure(failure), *store);
      v1::Failure of_older_server;
      of_older_server.set_reason("INVERTED_ELEMENT");
      of_older_server.set_body("belly");
      of_older_server.add_element_ids(17);
      StoreFailure(3, of_older_server.SerializeAsString(), *store);
    }
    server::ServerOptions options;
    options.data_directory = *folder_ / "data";
    server_ = server::EmbeddedServer::Start(options).release();
  }
  static void TearDownTestSuite() {
    delete server_;
    delete frames_;
    delete folder_;
  }

  static std::string Name(int number) { return "jobs/0000000000000000000000000" + std::to_string(number); }

  static Finished Fascicle(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {testing::Program("fascicle"), "--server", server_->address()});
    return RunProgram(arguments);
  }

  static TemporaryFolder* folder_;
  static std::vector<Frame>* frames_;
  static server::EmbeddedServer* server_;
};

TemporaryFolder* ObjectsTest::folder_ = nullptr;
std::vector<Frame>* ObjectsTest::frames_ = nullptr;
server::EmbeddedServer* ObjectsTest::server_ = nullptr;

TEST_F(ObjectsTest, ComeToTheClientBitByBit) {
  client::Client client(server_->address());
  const auto geometry = client.GetGeometry(Name(1));
  ASSERT_TRUE(geometry.ok()) << geometry.error().message;
  const auto rigid_bodies = client::DecodeRigidBodies(geometry.value());
  ASSERT_EQ(rigid_bodies.size(), 2u);
  EXPECT_EQ(rigid_bodies[0].name, "ground");
  EXPECT_FALSE(rigid_bodies[0].moves);
  EXPECT_TRUE(rigid_bodies[0].unbounded);
  EXPECT_EQ(rigid_bodies[1].name, "forearm");
  EXPECT_EQ(rigid_bodies[1].positions, BoneShape().nodes);
  const auto lines = client::DecodeLineInfos(geometry.value());
  ASSERT_EQ(lines.size(), 1u);
  std::vector<v1::Frame> received;
  client::WatchEvents events;
  events.frame = [&](const v1::Frame& frame) { received.push_back(frame); };
  ASSERT_TRUE(client.Watch(Name(1), {}, events).ok());
  ASSERT_EQ(received.size(), static_cast<std::size_t>(kFrames));
  ASSERT_EQ(frames_->size(), received.size());
  for (std::size_t f = 0; f < received.size(); ++f) {
    const Frame& sent = (*frames_)[f];
    EXPECT_NO_THROW(client::CheckFits(received[f], geometry.value()));
    EXPECT_NO_THROW(client::CheckDigest(received[f]));
    const std::vector<Pose> poses = client::PosesOf(received[f], rigid_bodies);
    EXPECT_EQ(poses[1].position, sent.poses[0].position);
    EXPECT_EQ(poses[1].quaternion, sent.poses[0].quaternion);
    const auto paths = client::DecodeLines(received[f], lines);
    EXPECT_EQ(paths[0].points, sent.lines[0].points);
    EXPECT_EQ(paths[0].points.size(), 3 + f);
    EXPECT_EQ(paths[0].values, sent.lines[0].values);
  }
}

TEST_F(ObjectsTest, ADigestTellsAnyOtherNumber) {
  client::Client client(server_->address());
  v1::Frame frame;
  client::WatchEvents events;
  events.frame = [&](const v1::Frame& last) { frame = last; };
  ASSERT_TRUE(client.Watch(Name(1), {}, events).ok());
  const auto flip = [](std::string& bytes) {
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  };
  using Change = std::function<void(v1::Frame&)>;
  for (const Change& change :
       {Change([](auto& f) { f.set_index(f.index() + 1); }), Change([](auto& f) { f.set_time(f.time() + 1); }),
        Change([](auto& f) { f.set_step(f.step() + 1); }),
        Change([&](auto& f) { flip(*f.mutable_bodies(0)->mutable_positions()); }),
        Change([](auto& f) { f.set_series(0, f.series(0) + 1); }), Change([&](auto& f) { flip(*f.mutable_poses()); }),
        Change([](auto& f) { f.clear_poses(); }), Change([&](auto& f) { flip(*f.mutable_lines(0)->mutable_points()); }),
        Change([](auto& f) { f.mutable_lines(0)->set_values(1, 0); }), Change([](auto& f) { f.clear_lines(); }),
        Change([&](auto& f) { flip(*f.mutable_digest()); })}) {
    v1::Frame changed = frame;
    change(changed);
    EXPECT_THROW(client::CheckDigest(changed), std::runtime_error);
  }
}

TEST_F(ObjectsTest, SummaryNamesThem) {
  const Finished watch = Fascicle({"watch", Name(1), "--digests"});
  EXPECT_EQ(watch.exit_code, 0) << watch.err;
  EXPECT_THAT(watch.out, HasSubstr("rigid bodies that move  forearm\n"));
  EXPECT_THAT(watch.out, HasSubstr("rigid bodies that stay  ground\n"));
  EXPECT_THAT(watch.out, HasSubstr("lines  flexor\n"));
  EXPECT_THAT(watch.out, HasSubstr("flexor/activation"));
  EXPECT_THAT(watch.out, Not(HasSubstr("forearm/pose")));
  const std::string last = Hex(frames_->back().digest);
  EXPECT_THAT(watch.out, HasSubstr(last));
  const Finished json = Fascicle({"watch", Name(1), "--json"});
  const auto summary = nlohmann::json::parse(json.out);
  EXPECT_EQ(summary["rigid_bodies"][1]["name"], "forearm");
  EXPECT_EQ(summary["rigid_bodies"][1]["moves"], true);
  EXPECT_EQ(summary["lines"][0], "flexor");
  EXPECT_EQ(summary["series"]["flexor/activation"]["final"], 0.2 * (kFrames - 1));
  EXPECT_FALSE(summary["series"].contains("forearm/pose/x"));
}

TEST_F(ObjectsTest, ExportsHaveThem) {
  const std::string out = *folder_ / "export";
  const Finished done = Fascicle({"export", Name(1), "--out", out});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  for (const char* file : {"frames/box_000005.vtu", "frames/rigid_forearm_000005.vtp", "frames/fixed_ground.vtp",
                           "frames/line_flexor_000005.vtp"}) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out) / file)) << file;
  }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(out) / "frames/rigid_ground_000005.vtp"));
  std::istringstream csv(ReadFile(std::filesystem::path(out) / "series.csv"));
  std::string heading, row, last;
  std::getline(csv, heading);
  EXPECT_THAT(heading, HasSubstr(",flexor/activation [1],flexor/length [m],forearm/pose/x [m],forearm/pose/y [m],"
                                 "forearm/pose/z [m],forearm/pose/qw [1],forearm/pose/qx [1],forearm/pose/qy [1],"
                                 "forearm/pose/qz [1]"));
  while (std::getline(csv, row)) last = row;
  // Numbers read back with the same bits.
  const std::string quaternion = last.substr(last.rfind(",0.02,0.08,") + 11);
  const Pose& pose = frames_->back().poses[0];
  EXPECT_EQ(std::stod(quaternion), pose.quaternion[0]);
  EXPECT_EQ(std::stod(quaternion.substr(quaternion.find(",0,") + 3)), pose.quaternion[2]);
}

TEST_F(ObjectsTest, PlotsDrawThemWhenAsked) {
  const Finished poses = Fascicle({"plot", Name(1), "--series", "forearm/pose/q*", "--json"});
  ASSERT_EQ(poses.exit_code, 0) << poses.err;
  EXPECT_THAT(poses.out, HasSubstr("forearm/pose/qy"));
  const Finished all = Fascicle({"plot", Name(1), "--json"});
  EXPECT_THAT(all.out, HasSubstr("flexor/activation"));
  EXPECT_THAT(all.out, Not(HasSubstr("pose")));
}

TEST_F(ObjectsTest, PicturesAreDrawn) {
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--out", *folder_ / "last.png"},
        {"--out", *folder_ / "panels.png", "--frames", "0,2,5", "--colour", "activation"},
        {"--out", *folder_ / "run.gif", "--frames", "all", "--size", "320x240"},
        {"--out", *folder_ / "bare.png", "--no-lines", "--no-rigid-bodies"}}) {
    std::vector<std::string> arguments = {"render", Name(1)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Finished done = Fascicle(arguments);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_GT(std::filesystem::file_size(options[1]), 3000u);
  }
  const Finished unknown = Fascicle({"render", Name(1), "--out", *folder_ / "no.png", "--colour", "tension"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("of lines: activation, length"));
}

TEST_F(ObjectsTest, FailuresNameTheirObject) {
  const Finished joint = Fascicle({"show", Name(2)});
  EXPECT_THAT(joint.out, HasSubstr("\n  joint: elbow\n"));
  EXPECT_THAT(joint.out, Not(HasSubstr("body:")));
  const auto json = nlohmann::json::parse(Fascicle({"show", Name(2), "--json"}).out);
  EXPECT_EQ(json["failure"]["object"]["kind"], "joint");
  EXPECT_EQ(json["failure"]["object"]["name"], "elbow");
  EXPECT_FALSE(json["failure"].contains("body"));
}

TEST_F(ObjectsTest, FailuresOfOlderServersNameTheirBody) {
  EXPECT_THAT(Fascicle({"show", Name(3)}).out, HasSubstr("\n  body: belly\n  elements: 17\n"));
  const auto json = nlohmann::json::parse(Fascicle({"show", Name(3), "--json"}).out);
  EXPECT_EQ(json["failure"]["object"]["name"], "belly");
  EXPECT_EQ(json["failure"]["body"], "belly");
}

}  // namespace
}  // namespace fascicle::service_test
