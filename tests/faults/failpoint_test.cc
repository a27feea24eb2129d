// The server dies before, within and after named calls on its files (fail_at.cc): nothing acknowledged is lost.
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "killed_server.h"

namespace fascicle::service_test {
namespace {

int FailuresOfEach() {
  const char* number = std::getenv("FASCICLE_FAILURES_OF_EACH");
  return number != nullptr ? std::atoi(number) : 2;
}

constexpr int kMostTries = 20;  // lives until one reaches its failpoint

struct Failpoint {
  std::string call;
  std::string pattern;  // of the path
  unsigned most;        // the server dies at one of so many such calls
};

std::vector<Failpoint> Failpoints() {
  return {{"pwrite", "*/control.db-wal", 60},
          {"fdatasync", "*/control.db-wal", 10},
          {"pwrite", "*/control.copy.db-wal", 60},
          {"fdatasync", "*/control.copy.db-wal", 1},
          {"pwrite", "*/control.db", 8},
          {"fdatasync", "*/control.db", 1},
          {"pwrite", "*/control.copy.db", 8},
          {"fdatasync", "*/control.copy.db", 1},
          {"unlink", "*/control.db-wal", 1},
          {"unlink", "*/control.copy.db-wal", 1},
          {"pwrite", "*/jobs/*.db-wal", 60},
          {"fdatasync", "*/jobs/*.db-wal", 20},
          {"pwrite", "*/jobs/*.db", 10},
          {"fdatasync", "*/jobs/*.db", 3},
          {"unlink", "*/jobs/*.db-wal", 3},
          {"unlink", "*/jobs/*.db", 1},
          {"write", "*/assets/uploads/*", 5},
          {"fsync", "*/assets/uploads/*", 5},
          {"rename", "*/assets/*", 5},
          {"fsync", "*/assets/*", 5}};
}

// FASCICLE_FAIL_AT for one death at this point.
std::string SomeDeath(const Failpoint& point, std::mt19937& random) {
  std::vector<std::string> moments = {"before", "after"};
  if (point.call.ends_with("write")) moments.push_back("within");
  return moments[random() % moments.size()] + " " + point.call + " " + point.pattern + " " +
         std::to_string(1 + random() % point.most);
}

// One life of a server, which drains if it did not die within `life`. Whether it died.
bool DiesOf(const std::string& death, std::chrono::milliseconds life, const TemporaryFolder& data, int round,
            Ledger& ledger) {
  ServerProcess server({"--listen", "127.0.0.1:0", "--data", data.path(), "--checkpoint", "0.01"},
                       {{"LD_PRELOAD", FAIL_AT_LIBRARY}, {"FASCICLE_FAIL_AT", death}});
  const std::string address = server.AwaitAddress();
  if (!address.empty()) {
    Clients clients(address, round, false, ledger);
    if (!server.Wait(life)) server.Signal(SIGTERM);
    EXPECT_TRUE(server.Wait(30s)) << death;
    clients.Stop();
  }
  const std::optional<int> exit_code = server.Wait(30s);
  EXPECT_TRUE(exit_code == 0 || exit_code == -SIGKILL)
      << death << ": " << exit_code.value_or(-1) << " " << server.ErrorOutput();
  return exit_code == -SIGKILL;
}

TEST(FailpointTest, NothingAcknowledgedIsLostOrDoubled) {
  const Digests expected = UndisturbedDigests();
  TemporaryFolder data;
  std::mt19937 random(2027);
  Ledger ledger;
  int round = 0, deaths = 0;
  // In turn, because a job that sees twenty deaths without any progress is ended.
  for (int i = 0; i < FailuresOfEach(); ++i) {
    for (const Failpoint& point : Failpoints()) {
      bool has_died = false;
      for (int tries = 0; tries < kMostTries && !has_died && !HasFailure(); ++tries) {
        const std::chrono::milliseconds life = 400ms * (1 + tries);  // on a busy machine, little happens in a short one
        has_died = DiesOf(SomeDeath(point, random), life, data, round++, ledger);
      }
      ASSERT_TRUE(has_died) << "never reached: " << point.call << " " << point.pattern;
      ++deaths;
    }
  }
  ExpectNothingLost(data.path(), round, expected, ledger);
  std::cout << Failpoints().size() << " failpoints, " << deaths << " deaths in " << round << " lives, "
            << ledger.jobs().size() << " jobs, " << ledger.deleted().size() << " deletions, " << ledger.assets().size()
            << " uploads and " << ledger.frames().size() << " received frames: 0 lost, different or doubled\n";
}

}  // namespace
}  // namespace fascicle::service_test
