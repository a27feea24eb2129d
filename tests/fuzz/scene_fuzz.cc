// Any bytes as a scene file: read, then translated. Files of the scene are small images. Start it with the scenes of
// tests/bad_input and client/examples as its corpus.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "client/lib/scene_file.h"
#include "core/base/check.h"
#include "server/translate/translate.h"

namespace {

constexpr int kImageEdge = 12;

// Every asset is an image of a ball.
std::optional<std::string> BallImage(const std::string& /*sha256_hex*/) {
  std::string bytes;
  for (int k = 0; k < kImageEdge; ++k) {
    for (int j = 0; j < kImageEdge; ++j) {
      for (int i = 0; i < kImageEdge; ++i) {
        const int x = 2 * i + 1 - kImageEdge, y = 2 * j + 1 - kImageEdge, z = 2 * k + 1 - kImageEdge;
        bytes += static_cast<char>(x * x + y * y + z * z < kImageEdge * kImageEdge / 2 ? 200 : 20);
      }
    }
  }
  return bytes;
}

// The arm phantom has millions of voxels, whose filters take seconds under sanitizers.
void ReplacePhantoms(fascicle::v1::Scene& scene) {
  for (fascicle::v1::Body& body : *scene.mutable_bodies()) {
    if (!body.mesh().image().has_phantom()) continue;
    fascicle::v1::ImageShape& image = *body.mutable_mesh()->mutable_image();
    image.mutable_file()->set_asset("assets/" + std::string(64, '0'));
    image.mutable_file()->set_path("ball.raw");
    fascicle::v1::RawLayout& raw = *image.mutable_raw();
    raw.set_type("uint8");
    raw.clear_size();
    raw.clear_spacing();
    for (int axis = 0; axis < 3; ++axis) {
      raw.add_size(kImageEdge);
      raw.add_spacing(1);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fascicle::Problems problems;
  auto scene = fascicle::client::ParseScene(std::string(reinterpret_cast<const char*>(data), size), problems);
  FASCICLE_CHECK(scene.has_value() == problems.empty(), "a scene or problems");
  if (!scene) return 0;
  ReplacePhantoms(*scene);
  // Small enough for a thousand runs per second, large enough for every shape.
  fascicle::server::TranslateLimits limits;
  limits.max_elements = 300;
  limits.max_frame_bytes = 1'000'000;
  const auto translated = fascicle::server::TranslateScene(*scene, BallImage, problems, limits);
  FASCICLE_CHECK((translated != nullptr) == problems.empty(), "a scene or problems");
  return 0;
}
