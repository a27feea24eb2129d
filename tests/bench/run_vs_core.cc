// The same scene through the whole service (embedded server, store on disk, stream over loopback, a client that reads
// every frame) and through the core alone with a sink that drops the frames. Prints `ratio run_vs_core VALUE`: time of
// the core over time of the service.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "client/lib/client.h"
#include "client/lib/scene_file.h"
#include "core/sim/simulation.h"
#include "ratio.h"
#include "server/embedded_server.h"
#include "server/translate/translate.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

namespace fs = std::filesystem;

constexpr int kThreads = 1;
constexpr int kRounds = 9;

// The demonstration, shortened to 20 frames of some hundred steps each; a given bulk modulus fixes the step.
v1::Scene BenchScene() {
  Problems problems;
  auto package = client::LoadScene(testing::ProjectRoot() / "client/examples/fusiform_isometric.json", problems);
  if (!package) throw std::runtime_error(problems.ToString());
  v1::Scene scene = package->scene;
  scene.set_duration(0.04);
  scene.mutable_output()->set_frame_interval(0.002);
  scene.mutable_output()->clear_settle_speed();
  return scene;
}

class NullSink final : public FrameSink {
 public:
  bool PutFrame(Frame frame, std::string) override {
    ++frames;
    last_digest = frame.digest;
    return true;
  }
  void PutProgress(const Progress& progress) override { steps = progress.step; }

  int frames = 0;
  std::int64_t steps = 0;
  Digest last_digest = {};
};

// A run through the service includes translating the scene, so this does too.
NullSink RunCore(const v1::Scene& scene) {
  Problems problems;
  const auto translated = server::TranslateScene(scene, {}, problems);
  if (translated == nullptr) throw std::runtime_error(problems.ToString());
  NullSink sink;
  if (Simulation(translated, kThreads).Run(sink, {}).kind != Outcome::Kind::kSucceeded) {
    throw std::runtime_error("the core failed");
  }
  return sink;
}

std::string RunService(const v1::Scene& scene, client::Client& client) {
  const auto job = client.Submit({scene, {}}, kThreads);
  if (!job.ok()) throw std::runtime_error(job.error().message);
  std::string digest;
  client::WatchEvents events;
  events.frame = [&](const v1::Frame& frame) { digest = frame.digest(); };
  const auto end = client.Watch(job.value().name(), {}, events);
  if (!end.ok() || end.value().state() != v1::Job::STATE_SUCCEEDED) throw std::runtime_error("the job failed");
  return digest;
}

int Main() {
  const v1::Scene scene = BenchScene();
  std::string folder = (fs::temp_directory_path() / "fascicle-bench-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) throw std::runtime_error("can't make " + folder);
  server::ServerOptions options;
  options.data_directory = folder;
  options.workers = 1;
  const auto server = server::EmbeddedServer::Start(options);
  {
    client::Client client(server->address());
    const NullSink core = RunCore(scene);
    const std::string digest = RunService(scene, client);
    if (digest != std::string(core.last_digest.begin(), core.last_digest.end())) {
      throw std::runtime_error("the service and the core computed different things");
    }
    std::printf("%lld steps, %d frames\n", static_cast<long long>(core.steps), core.frames);
    bench::MedianRatio(
        "run_vs_core", kRounds, [&] { RunService(scene, client); }, [&] { RunCore(scene); });
  }
  server->Stop();
  fs::remove_all(folder);
  return 0;
}

}  // namespace
}  // namespace fascicle

int main() {
  try {
    return fascicle::Main();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "run_vs_core: %s\n", error.what());
    return 1;
  }
}
