#include "client/cli/digests.h"

#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/lib/decode.h"

namespace fascicle::client {
namespace {

std::string HexOf(const std::string& bytes) {
  std::string text;
  for (const unsigned char byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    text += digits;
  }
  return text;
}

}  // namespace

void PrintDigest(const v1::Frame& frame, bool json) {
  CheckDigest(frame);
  if (json) {
    PrintJson(
        {{"frame", frame.index()}, {"time", frame.time()}, {"step", frame.step()}, {"digest", HexOf(frame.digest())}});
  } else {
    std::printf("frame %lld  t = %.9g s  %s\n", static_cast<long long>(frame.index()), frame.time(),
                HexOf(frame.digest()).c_str());
    std::fflush(stdout);  // for a reader at the other end of a pipe
  }
}

}  // namespace fascicle::client
