// Runs the small scene NAME as a job of a data folder, or goes on with it: killed_run FOLDER NAME. At its end it prints
// the job's state and generation, then the digest of each frame.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "core/base/digest.h"
#include "killed_scenes.h"
#include "server/jobs/job_manager.h"
#include "server/store/store.h"
#include "tests/support/box_jobs.h"

namespace fascicle::server {
namespace {

JobCodec CodecOfScenes() {
  JobCodec codec = BoxCodec();
  codec.decode_scene = [](const std::string& name, AssetStore&, Profile*, const std::stop_token&) {
    return std::make_shared<const Scene>(testing::KilledScene(name));
  };
  return codec;
}

int Run(const std::string& folder, const std::string& name) {
  const std::unique_ptr<Store> store = OpenSqliteStore(folder);
  JobManagerOptions options;
  options.workers = 1;
  options.default_threads = 2;
  options.checkpoint_interval = std::chrono::milliseconds(0);
  JobManager jobs(*store, CodecOfScenes(), options);
  JobRecord record;
  record.spec = record.scene_name = record.request_id = record.request_digest = name;
  bool repeated = false;
  const std::string id = jobs.Submit(record, &repeated).record.id;
  std::puts("submitted");
  std::fflush(stdout);
  while (!IsFinal(jobs.Get(id)->record.state)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const JobRecord end = jobs.Get(id)->record;
  std::printf("state %d generation %lld\n", static_cast<int>(end.state), static_cast<long long>(end.generation));
  for (const FrameRecord& frame : jobs.Frames(id)->ListFrames(0, 1000)) {
    Digest digest;
    std::copy_n(frame.digest.begin(), digest.size(), digest.begin());
    std::printf("%lld %lld %s\n", static_cast<long long>(frame.index), static_cast<long long>(frame.step),
                Hex(digest).c_str());
  }
  return 0;
}

}  // namespace
}  // namespace fascicle::server

int main(int argc, char** argv) { return argc == 3 ? fascicle::server::Run(argv[1], argv[2]) : 2; }
