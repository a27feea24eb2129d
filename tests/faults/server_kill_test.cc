// The server under kill -9 at random times: what was acknowledged is there, done once, with the frames of an
// undisturbed run; what was received of a frame stays true.
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <random>
#include <thread>

#include "killed_server.h"

namespace fascicle::service_test {
namespace {

int Kills() {
  const char* number = std::getenv("FASCICLE_KILLS");
  return number != nullptr ? std::atoi(number) : 50;
}

TEST(ServerKillTest, NothingAcknowledgedIsLostOrDoubled) {
  const Digests expected = UndisturbedDigests();
  TemporaryFolder data;
  std::mt19937 random(2026);
  Ledger ledger;
  double slowest_start = 0;
  for (int round = 0; round < Kills() && !::testing::Test::HasFailure(); ++round) {
    const auto start = std::chrono::steady_clock::now();
    ServerProcess server({"--listen", "127.0.0.1:0", "--data", data.path(), "--checkpoint", "0.01"});
    const std::string address = server.AwaitAddress();
    ASSERT_FALSE(address.empty()) << "round " << round;
    slowest_start =
        std::max(slowest_start, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    Clients clients(address, round, true, ledger);  // connected before the kill
    std::this_thread::sleep_for(std::chrono::milliseconds(50 + random() % 400));
    server.Signal(SIGKILL);
    clients.Stop();
    server.Wait();
  }
  ExpectNothingLost(data.path(), Kills(), expected, ledger);
  EXPECT_GT(ledger.frames().size(), static_cast<std::size_t>(Kills())) << "hardly any frame was received";
  std::cout << Kills() << " kills, " << ledger.jobs().size() << " jobs, " << ledger.deleted().size() << " deletions, "
            << ledger.assets().size() << " uploads and " << ledger.frames().size()
            << " received frames: 0 lost, different or doubled; slowest start " << slowest_start << " s\n";
}

}  // namespace
}  // namespace fascicle::service_test
