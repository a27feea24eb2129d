#include "client/cli/frame_options.h"

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>

namespace fascicle::client {

void AddFrameOptions(CLI::App& command, FrameOptions& options) {
  command.add_option("--fields", options.fields, "Only these fields of the scene, such as velocity,cauchy_stress")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAMES");
  command
      .add_option("--encoding", options.encoding,
                  "How numbers travel: quantized16 has positions in 16 bit of the bounding box, fields in 32 bit")
      ->check(CLI::IsMember({"stored", "float32", "quantized16"}));
  command.add_flag("--compress", options.compress, "Compress frames on their way, by zstd");
}

void SetFrameOptions(const FrameOptions& options, const std::vector<std::string>& needed, WatchOptions& watch) {
  using Request = v1::StreamFramesRequest;
  watch.fields = options.fields;
  if (!watch.fields.empty()) watch.fields.insert(watch.fields.end(), needed.begin(), needed.end());
  watch.encoding = options.encoding == "float32"       ? Request::ENCODING_FLOAT32
                   : options.encoding == "quantized16" ? Request::ENCODING_QUANTIZED16
                                                       : Request::ENCODING_STORED;
  watch.compress = options.compress;
}

}  // namespace fascicle::client
