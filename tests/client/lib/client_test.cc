// The client library against real servers.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "client/lib/client.h"
#include "client/lib/message_assembler.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using client::Client;
using client::Error;
using client::ScenePackage;

// A tetrahedron of 10 mm with a tagged triangle.
constexpr const char* kTetrahedron = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 10 0 0
3 0 10 0
4 0 0 10
$EndNodes
$Elements
2
1 2 2 1 1 1 2 3
2 4 2 7 7 1 2 3 4
$EndElements
)";

// A scene whose mesh is an asset.
ScenePackage PackageWithMesh(const std::string& mesh) {
  ScenePackage package;
  package.scene = SwingingBox(0.05, 0.01);
  v1::Body& body = *package.scene.mutable_bodies(0);
  body.set_unit(v1::LENGTH_UNIT_MM);
  const std::string digest = Hex(Sha256Of(mesh));
  body.mutable_mesh()->mutable_file()->set_path("tetrahedron.msh");
  body.mutable_mesh()->mutable_file()->set_asset("assets/" + digest);
  body.mutable_regions(0)->set_physical_tag(1);
  package.assets.push_back({digest, "tetrahedron.msh", mesh});
  return package;
}

using ClientTest = ServiceTest;

TEST_F(ClientTest, SubmitsWithItsFilesAndWatches) {
  Client client(server_->address());
  const ScenePackage package = PackageWithMesh(kTetrahedron);
  EXPECT_FALSE(client.Validate(package, 1).has_value());
  const auto job = client.Submit(package, 1);
  ASSERT_TRUE(job.ok()) << job.error().message << job.error().problems.ToString();
  const auto geometry = client.GetGeometry(job.value().name());
  ASSERT_TRUE(geometry.ok()) << geometry.error().message;
  EXPECT_EQ(geometry.value().bodies(0).tetrahedra().size(), 16u);

  std::vector<std::int64_t> indices;
  client::WatchEvents events;
  events.frame = [&](const v1::Frame& frame) { indices.push_back(frame.index()); };
  const auto end = client.Watch(job.value().name(), {}, events);
  ASSERT_TRUE(end.ok()) << end.error().message;
  EXPECT_EQ(end.value().state(), v1::Job::STATE_SUCCEEDED);
  EXPECT_EQ(indices, (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5}));

  client::WatchOptions later;
  later.start_index = 4;
  indices.clear();
  ASSERT_TRUE(client.Watch(job.value().name(), later, events).ok());
  EXPECT_EQ(indices, (std::vector<std::int64_t>{4, 5}));

  const auto frames = client.ListFrames(job.value().name(), 2);
  ASSERT_TRUE(frames.ok());
  EXPECT_EQ(frames.value().size(), 4u);
  EXPECT_EQ(client.GetJob(job.value().name()).value().scene().name(), "swinging box");
  EXPECT_FALSE(client.DeleteJob(job.value().name()).has_value());
  EXPECT_EQ(client.GetJob(job.value().name()).error().kind, Error::Kind::kNotFound);
}

TEST_F(ClientTest, AFileOfManyChunks) {
  std::string mesh = kTetrahedron;
  mesh += "$Comments\n" + std::string(3'500'000, 'c') + "\n$EndComments\n";
  Client client(server_->address());
  const auto job = client.Submit(PackageWithMesh(mesh), 1);
  EXPECT_TRUE(job.ok()) << job.error().message << job.error().problems.ToString();
}

TEST_F(ClientTest, ProblemsHaveThePathsOfTheScene) {
  Client client(server_->address());
  ScenePackage package{SwingingBox(1, 0.1), {}};
  package.scene.set_duration(-1);
  package.scene.mutable_bodies(0)->set_density(-1);
  const auto error = client.Validate(package, 1);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind, Error::Kind::kInvalid);
  EXPECT_EQ(error->reason, "INVALID_ARGUMENT");
  std::set<std::string> paths;
  for (const Problem& problem : error->problems.kept()) {
    paths.insert(problem.path);
    EXPECT_EQ(problem.message.find('\n'), std::string::npos);
    EXPECT_FALSE(problem.message.empty());
  }
  EXPECT_TRUE(paths.contains("duration"));
  EXPECT_TRUE(paths.contains("bodies[0].density"));
  EXPECT_EQ(client.Submit(package, 1).error().kind, Error::Kind::kInvalid);
  EXPECT_TRUE(client.ListJobs(10, {}).value().empty());
}

TEST_F(ClientTest, AFileThatNobodyHasIsNamed) {
  Client client(server_->address());
  ScenePackage package = PackageWithMesh(kTetrahedron);
  const std::string name = package.scene.bodies(0).mesh().file().asset();
  package.assets.clear();
  const auto job = client.Submit(package, 1);
  ASSERT_FALSE(job.ok());
  EXPECT_EQ(job.error().kind, Error::Kind::kRefused);
  EXPECT_EQ(job.error().reason, "MISSING_ASSET");
  EXPECT_NE(job.error().message.find(name), std::string::npos) << job.error().message;
}

TEST_F(ClientTest, ListsUpToALimit) {
  Client client(server_->address());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(client.Submit({SwingingBox(0.01, 0.01), {}}, 1).ok());
  EXPECT_EQ(client.ListJobs(3, {}).value().size(), 3u);
  EXPECT_EQ(client.ListJobs(100, {}).value().size(), 5u);
}

TEST_F(ClientTest, AStopRequestEndsAWatch) {
  Client client(server_->address());
  const std::string name = client.Submit({LongScene(), {}}, 1).value().name();
  std::stop_source stop;
  client::WatchEvents events;
  events.frame = [&](const v1::Frame& frame) {
    if (frame.index() == 3) stop.request_stop();
  };
  const auto job = client.Watch(name, {}, events, stop.get_token());
  ASSERT_FALSE(job.ok());
  EXPECT_EQ(job.error().kind, Error::Kind::kStopped);
  EXPECT_EQ(client.GetJob(name).value().state(), v1::Job::STATE_RUNNING) << "the job goes on";
  EXPECT_TRUE(client.CancelJob(name).ok());
}

TEST_F(ClientTest, AStopRequestEndsTheWaitForGeometry) {
  Client client(server_->address());
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(client.Submit({LongScene(), {}}, 1).ok());
  const std::string waiting = client.Submit({LongScene(), {}}, 1).value().name();
  std::stop_source stop;
  std::thread stopper([&] {
    std::this_thread::sleep_for(100ms);
    stop.request_stop();
  });
  const auto geometry = client.GetGeometry(waiting, stop.get_token());
  stopper.join();
  ASSERT_FALSE(geometry.ok());
  EXPECT_EQ(geometry.error().kind, Error::Kind::kStopped);
}

TEST_F(ClientTest, ProgressIsTold) {
  Client client(server_->address());
  const std::string name = client.Submit({LongScene(), {}}, 1).value().name();
  std::stop_source stop;
  int told = 0;
  double fraction = -1;
  client::WatchEvents events;
  events.progress = [&](v1::Job::State state, const v1::Progress& progress) {
    EXPECT_NE(state, v1::Job::STATE_UNSPECIFIED);
    EXPECT_GE(progress.fraction(), fraction);
    fraction = progress.fraction();
    if (++told == 3) stop.request_stop();
  };
  EXPECT_EQ(client.Watch(name, {}, events, stop.get_token()).error().kind, Error::Kind::kStopped);
  EXPECT_EQ(told, 3);
  EXPECT_GT(fraction, 0);
}

TEST_F(ClientTest, ASlowReaderGetsEveryFrame) {
  Client client(server_->address());
  const std::string name = client.Submit({SwingingBox(0.5, 0.01), {}}, 1).value().name();
  std::int64_t next = 0;
  client::WatchEvents events;
  events.frame = [&](const v1::Frame& frame) {
    EXPECT_EQ(frame.index(), next++);
    if (frame.index() % 10 == 0) std::this_thread::sleep_for(100ms);
  };
  EXPECT_TRUE(client.Watch(name, {}, events).ok());
  EXPECT_EQ(next, 51);
}

TEST_F(ClientTest, ManyThreadsShareOneClient) {
  Client client(server_->address());
  std::vector<std::thread> threads;
  std::atomic<int> succeeded = 0;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      const auto job = client.Submit({SwingingBox(0.05, 0.01), {}}, 1);
      if (job.ok() && client.Watch(job.value().name(), {}, {}).ok()) ++succeeded;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(succeeded, 8);
  EXPECT_EQ(client.ListJobs(100, {}).value().size(), 8u);
}

// A port of this machine that does not answer: with `listening` false it refuses connections, with true it stays
// silent.
class DeadPort {
 public:
  explicit DeadPort(bool listening) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    bind(socket_, reinterpret_cast<sockaddr*>(&address), size);
    getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    if (listening) listen(socket_, 16);
  }
  ~DeadPort() { close(socket_); }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

 private:
  int socket_;
  int port_ = 0;
};

TEST(NoServer, IsFoundOutWithinSeconds) {
  for (const bool listening : {false, true}) {
    const DeadPort port(listening);
    const auto begin = std::chrono::steady_clock::now();
    Client client(port.address());
    const auto info = client.GetServerInfo();
    ASSERT_FALSE(info.ok());
    EXPECT_EQ(info.error().kind, Error::Kind::kNoServer);
    EXPECT_NE(info.error().message.find(port.address()), std::string::npos) << info.error().message;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, listening ? 7s : 3s);
    if (listening) continue;
    EXPECT_EQ(Client(port.address()).Watch("jobs/1", {}, {}).error().kind, Error::Kind::kNoServer);
  }
}

TEST(NoServer, AServerThatComesASecondLaterIsFound) {
  server::ServerOptions options;
  {
    const DeadPort port(false);
    options.listen = port.address();
  }
  std::unique_ptr<server::EmbeddedServer> server;
  std::thread starter([&] {
    std::this_thread::sleep_for(500ms);
    server = server::EmbeddedServer::Start(options);
  });
  EXPECT_TRUE(Client(options.listen).GetServerInfo().ok());
  starter.join();
}

TEST(NoServer, AWatchGivesUpAfterItsPatience) {
  auto server = server::EmbeddedServer::Start({});
  Client client(server->address());
  const std::string name = client.Submit({LongScene(), {}}, 1).value().name();
  client::WatchOptions options;
  options.patience = 1s;
  client::WatchEvents events;
  std::atomic<bool> seen = false;
  int reconnections = 0;
  events.frame = [&](const v1::Frame&) { seen = true; };
  events.reconnecting = [&](const std::string& message) {
    ++reconnections;
    EXPECT_FALSE(message.empty());
  };
  std::thread stopper([&] {
    Eventually([&] { return seen.load(); });
    server.reset();
  });
  const auto job = client.Watch(name, options, events);
  stopper.join();
  ASSERT_FALSE(job.ok());
  EXPECT_EQ(job.error().kind, Error::Kind::kNoServer);
  EXPECT_EQ(reconnections, 1);
}

TEST(MessageAssembler, DamageIsFound) {
  using State = client::MessageAssembler::State;
  const auto chunk = [](std::int64_t index, std::int64_t offset, const std::string& data, bool last) {
    v1::Chunk made;
    made.set_frame_index(index);
    made.set_offset(offset);
    made.set_data(data);
    made.set_crc32c(Crc32c(data));
    made.set_last(last);
    return made;
  };
  const auto add_after_first = [&](v1::Chunk second) {
    client::MessageAssembler assembler;
    v1::Chunk first = chunk(5, 0, "abc", false);
    EXPECT_EQ(assembler.Add(first), State::kMore);
    return assembler.Add(second);
  };
  EXPECT_EQ(add_after_first(chunk(5, 3, "def", true)), State::kComplete);
  EXPECT_EQ(add_after_first(chunk(5, 4, "def", true)), State::kBroken) << "a gap";
  EXPECT_EQ(add_after_first(chunk(5, 0, "abc", false)), State::kBroken) << "a repetition";
  EXPECT_EQ(add_after_first(chunk(6, 3, "def", true)), State::kBroken) << "another frame";
  v1::Chunk damaged = chunk(5, 3, "def", true);
  (*damaged.mutable_data())[1] ^= 1;
  EXPECT_EQ(add_after_first(damaged), State::kBroken) << "a flipped bit";
}

}  // namespace
}  // namespace fascicle::service_test
