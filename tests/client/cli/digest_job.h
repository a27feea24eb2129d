#ifndef FASCICLE_TESTS_CLIENT_CLI_DIGEST_JOB_H_
#define FASCICLE_TESTS_CLIENT_CLI_DIGEST_JOB_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/files.h"
#include "tests/support/paths.h"
#include "tests/support/server_process.h"

namespace fascicle::testing {

// The lines of `--digests`: `frame K TIME DIGEST`.
inline std::vector<std::string> FrameLines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("frame ")) lines.push_back(line);
  }
  return lines;
}

// A job of a scene file through a server that may be killed meanwhile. These promises hold for every method.
class DigestJob {
 public:
  void StartServer() {
    server_.reset();
    server_ = std::make_unique<ServerProcess>(
        std::vector<std::string>{"--listen", "127.0.0.1:0", "--data", folder_ / "server"});
    address_ = server_->AwaitAddress();
    ASSERT_NE(address_, "") << server_->ErrorOutput();
  }
  Finished Call(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {Program("fascicle"), "--server", address_});
    return RunProgram(arguments);
  }
  std::string Submit(const std::string& scene) const {
    const Finished submitted = Call({"submit", folder_.Write("scene.json", scene)});
    EXPECT_EQ(submitted.exit_code, 0) << submitted.err;
    return submitted.out.substr(0, submitted.out.find('\n'));
  }

  // A scene of `frames` frames. A client's frames, those of a server that was killed meanwhile, and those of `run` on
  // two threads are identical.
  void ExpectSameDigestsAsRunAlsoWhenKilled(const std::string& scene, std::size_t frames) {
    StartServer();
    const std::string job = Submit(scene);
    std::vector<std::string> seen;
    {
      ChildProcess watch({Program("fascicle"), "--server", address_, "watch", job, "--digests"});
      for (int i = 0; i < 4; ++i) seen.push_back(watch.ReadLine());
      server_->Signal(SIGKILL);
      server_->Wait();
    }
    StartServer();
    const std::vector<std::string> streamed = FrameLines(Call({"watch", job, "--digests"}).out);
    const Finished run =
        RunProgram({Program("fascicle"), "run", folder_ / "scene.json", "--threads", "2", "--digests"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    ASSERT_EQ(streamed.size(), frames + 1);
    EXPECT_EQ(streamed, FrameLines(run.out));
    EXPECT_EQ(seen, std::vector<std::string>(streamed.begin(), streamed.begin() + 4));
  }

  // A scene with a long run time.
  void ExpectCanBeCancelled(const std::string& scene) {
    StartServer();
    const std::string job = Submit(scene);
    ChildProcess watch({Program("fascicle"), "--server", address_, "watch", job, "--digests"});
    for (int i = 0; i < 3; ++i) EXPECT_THAT(watch.ReadLine(), ::testing::StartsWith("frame "));
    EXPECT_EQ(Call({"cancel", job}).exit_code, 0);
    const Finished watched = watch.Wait();
    EXPECT_EQ(watched.exit_code, 4) << watched.err;
    EXPECT_THAT(watched.out, ::testing::HasSubstr("cancelled"));
  }

  const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
  std::unique_ptr<ServerProcess> server_;
  std::string address_;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CLIENT_CLI_DIGEST_JOB_H_
