#ifndef FASCICLE_CORE_IMAGING_VOLUME_FILES_H_
#define FASCICLE_CORE_IMAGING_VOLUME_FILES_H_

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/problems.h"
#include "core/imaging/volume_image.h"

// What the readers of images share. For this room alone.
namespace fascicle {

enum class VolumeFormat { kMetaImage, kNrrd, kNifti, kDicom, kRaw };

// By the extension of a name.
std::optional<VolumeFormat> FormatOf(std::string_view name);
std::string NameOf(VolumeFormat format);
// Whether it is the extension of a header alone: .mhd or .nhdr.
bool IsDetachedHeader(std::string_view name);

// What the text at the beginning of a MetaImage or NRRD file says of the numbers.
struct TextHeader {
  std::string data_file;  // empty: they follow the header
  bool compressed = false;
  bool as_text = false;
  std::size_t bytes = 0;  // of the text itself
};
// Adds to `problems`, and gives nothing, where the text is none, or names several files or one elsewhere.
std::optional<TextHeader> ReadTextHeader(VolumeFormat format, std::string_view bytes, Problems& problems);

// A folder of our own in the system's place for such, with all that is in it removed in the end.
class TemporaryFolder {
 public:
  TemporaryFolder();  // throws std::runtime_error
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// Whether an image of that size, with so many bytes a voxel in the file, can be read: its voxels can be counted, what
// reading needs is below the limit, and `available` bytes of the file can hold it. Compressed data hold at most
// 1032 times as much (deflate's bound).
struct VolumeClaim {
  std::array<std::uint64_t, 3> size = {};
  std::uint64_t bytes_per_voxel = 1;
  std::uint64_t available = 0;
  bool compressed = false;
};
bool CheckClaim(const VolumeClaim& claim, std::int64_t memory_limit, Problems& problems);

// Whether bytes begin with a whole deflated stream (zlib or gzip), check sum and all: libraries take what there is for
// the rest. False, with a problem, otherwise.
bool CheckDeflated(std::string_view bytes, Problems& problems);

// Spacing and axes as they stand in a file: spacings must be finite and above 0, axes unit vectors at right angles to
// 1e-3. They are made so to the last bit. False, with problems, otherwise.
bool CheckPlace(VolumeImage& image, Problems& problems);

// Finite everywhere.
bool CheckValues(const VolumeImage& image, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_FILES_H_
