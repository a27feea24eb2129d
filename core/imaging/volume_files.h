#ifndef FASCICLE_CORE_IMAGING_VOLUME_FILES_H_
#define FASCICLE_CORE_IMAGING_VOLUME_FILES_H_

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/base/problems.h"
#include "core/imaging/volume_image.h"

// Functions shared by the readers of images. Internal to this room.
namespace fascicle {

enum class VolumeFormat { kMetaImage, kNrrd, kNifti, kDicom, kRaw };

// The format that belongs to a name's extension.
std::optional<VolumeFormat> FormatOf(std::string_view name);
std::string NameOf(VolumeFormat format);
// Whether the extension is that of a separate header: .mhd or .nhdr.
bool IsDetachedHeader(std::string_view name);

// What the text header of a MetaImage or NRRD file says about its data.
struct TextHeader {
  std::string data_file;  // empty: the data follow the header
  bool compressed = false;
  bool as_text = false;
  std::size_t bytes = 0;  // length of the text itself
};
// Returns nothing and adds to `problems` if the text is not a header, or names several data files or one elsewhere.
std::optional<TextHeader> ReadTextHeader(VolumeFormat format, std::string_view bytes, Problems& problems);

// A folder within the system's temporary folder; removed with its contents by the destructor.
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

// Whether an image of that size, with so many bytes per voxel in the file, can be read: the number of voxels is within
// range, reading needs less memory than the limit, and the `available` bytes of the file can hold the voxels.
// Compressed data hold at most 1032 times their size (deflate's bound).
struct VolumeClaim {
  std::array<std::uint64_t, 3> size = {};
  std::uint64_t bytes_per_voxel = 1;
  std::uint64_t available = 0;
  bool compressed = false;
};
bool CheckClaim(const VolumeClaim& claim, std::int64_t memory_limit, Problems& problems);

// Whether the bytes start with a complete deflated stream (zlib or gzip), checksum included. Libraries accept
// incomplete streams. If not, returns false and adds a problem. Throws Stopped after a stop request.
bool CheckDeflated(std::string_view bytes, const std::stop_token& stop, Problems& problems);

// Checks spacing and axes as read from a file: spacings must be finite and above 0; axes must be orthonormal to 1e-3
// and are then made so to the last bit. If not, returns false and adds problems.
bool CheckPlace(VolumeImage& image, Problems& problems);

// Whether all values are finite.
bool CheckValues(const VolumeImage& image, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_FILES_H_
