// Any bytes as a scene file: read, then translated. Start it with the scenes of tests/bad_input and client/examples as
// its corpus.
#include <cstddef>
#include <cstdint>
#include <string>

#include "client/lib/scene_file.h"
#include "core/base/check.h"
#include "server/translate/translate.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fascicle::Problems problems;
  const auto scene = fascicle::client::ParseScene(std::string(reinterpret_cast<const char*>(data), size), problems);
  FASCICLE_CHECK(scene.has_value() == problems.empty(), "a scene or problems");
  if (!scene) return 0;
  // Small enough for thousands of runs per second, large enough for every shape.
  fascicle::server::TranslateLimits limits;
  limits.max_elements = 2000;
  limits.max_frame_bytes = 1'000'000;
  const auto no_assets = [](const std::string&) { return std::nullopt; };
  const auto translated = fascicle::server::TranslateScene(*scene, no_assets, problems, limits);
  FASCICLE_CHECK((translated != nullptr) == problems.empty(), "a scene or problems");
  return 0;
}
