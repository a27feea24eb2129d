// Any bytes as an image; the first byte selects the format. The result is an image within a small limit of size, or
// problems.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/check.h"
#include "core/imaging/volume_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::string_view kNames[] = {"a.mha", "a.nrrd", "a.nii", "a.nii.gz", "a.dcm", "a.raw", "a.hdr"};
  constexpr std::int64_t kLimit = 1 << 24;
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  fascicle::VolumeReaderOptions options;
  options.memory_limit = kLimit;
  options.raw = fascicle::RawLayout{{4, 3, 2}};
  fascicle::Problems problems;
  const std::optional<fascicle::VolumeImage> image =
      fascicle::ReadVolume({{kNames[data[0] % std::size(kNames)], bytes}}, options, problems);
  FASCICLE_CHECK(image.has_value() == problems.empty(), "an image or problems");
  if (image) FASCICLE_CHECK(image->voxels() * sizeof(float) <= kLimit, "within the limit");
  return 0;
}
