#ifndef FASCICLE_TESTS_CLIENT_CLI_WITH_SERVER_H_
#define FASCICLE_TESTS_CLIENT_CLI_WITH_SERVER_H_

#include <memory>
#include <string>
#include <vector>

#include "fascicle_fixture.h"
#include "tests/support/server_process.h"

namespace fascicle::testing {

// A FascicleTest whose commands call a server, in a process of its own.
template <class Base>
class WithServer : public Base {
 protected:
  void SetUp() override {
    server_ = std::make_unique<ServerProcess>(
        std::vector<std::string>{"--listen", "127.0.0.1:0", "--data", this->folder_ / "server"});
    address_ = server_->AwaitAddress();
    ASSERT_NE(address_, "") << server_->ErrorOutput();
  }
  Finished Call(const std::vector<std::string>& arguments) { return this->Fascicle(arguments, address_); }
  // The name of the new job.
  std::string SubmitText(const std::string& scene) {
    const Finished finished = Call({"submit", this->File("scene.json", scene)});
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return finished.out.substr(0, finished.out.find('\n'));
  }

  std::unique_ptr<ServerProcess> server_;
  std::string address_;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CLIENT_CLI_WITH_SERVER_H_
