#include "server/translate/job_codec.h"

#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/translate/steering.h"

namespace fascicle::server {
namespace {

template <class M>
std::string Serialize(const M& message) {
  std::string bytes;
  if (!message.SerializeToString(&bytes))
    throw std::runtime_error(message.GetTypeName() + " is too large to be stored");
  return bytes;
}

std::shared_ptr<const Scene> DecodeScene(const std::string& spec, AssetStore& assets, const TranslateTools& tools) {
  v1::Job job;
  if (!job.ParseFromString(spec)) throw std::runtime_error("the stored job can't be read");
  Problems problems;
  auto scene = TranslateScene(job.scene(), ReaderOf(assets), problems, {}, tools);
  if (scene == nullptr) throw std::runtime_error("the stored scene can't be built any more:\n" + problems.ToString());
  return scene;
}

std::set<std::string> AssetsOfSpec(const std::string& spec) {
  v1::Job job;
  if (!job.ParseFromString(spec)) throw std::runtime_error("a stored job can't be read");
  const std::vector<std::string> assets = AssetsOf(job.scene());
  return {assets.begin(), assets.end()};
}

}  // namespace

AssetReader ReaderOf(AssetStore& assets) {
  return [&assets](const std::string& sha256_hex) { return assets.ReadAsset(sha256_hex); };
}

JobCodec MakeJobCodec(ResultCache* results) {
  return {.decode_scene =
              [results](const std::string& spec, AssetStore& assets, Profile* profile, const std::stop_token& stop) {
                return DecodeScene(spec, assets, {profile, results, stop});
              },
          .encode_geometry = [](const Scene& scene,
                                const FrameLayout& layout) { return Serialize(EncodeGeometry(scene, layout)); },
          .encode_frame = [](const Frame& frame) { return Serialize(EncodeFrame(frame)); },
          .encode_failure = [](const Failure& failure) { return Serialize(EncodeFailure(failure)); },
          .encode_warnings =
              [](const std::vector<Warning>& warnings, const std::string& earlier) {
                v1::Warnings before, message = EncodeWarnings(warnings);
                if (before.ParseFromString(earlier) && before.has_imported()) {
                  *message.mutable_imported() = before.imported();
                }
                return Serialize(message);
              },
          .encode_profile = [](const RunProfile& profile) { return Serialize(EncodeProfile(profile)); },
          .encode_line = [](const LogLine& line) { return Serialize(EncodeLine(line)); },
          .inputs_of_spec = InputsOfSpec,
          .decode_inputs = DecodeInputs,
          .assets_of = AssetsOfSpec};
}

}  // namespace fascicle::server
