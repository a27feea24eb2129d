#ifndef FASCICLE_CORE_IMAGING_VOLUME_FILES_H_
#define FASCICLE_CORE_IMAGING_VOLUME_FILES_H_

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/problems.h"
#include "core/imaging/volume_image.h"

// Functions shared by the readers of images. Internal to this room.
namespace fascicle {

inline constexpr double kMillimetre = 1e-3;  // [m]

enum class VolumeFormat { kMetaImage, kNrrd, kNifti, kDicom, kRaw };

// The format that belongs to a name's extension.
std::optional<VolumeFormat> FormatOf(std::string_view name);
// Whether the extension is that of a separate header: .mhd, .nhdr or .hdr.
bool IsDetachedHeader(std::string_view name);

// Size of a file; nothing, with a problem, if it can't be read.
std::optional<std::uint64_t> SizeOf(const std::filesystem::path& path, Problems& problems);
// Its first bytes, at most so many.
std::string StartOf(const std::filesystem::path& path, std::size_t bytes);
// The same for a file that may be compressed by gzip.
std::string InflatedStartOf(const std::filesystem::path& path, unsigned bytes);

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

// Checks size, spacing and axes as read from a file: spacings must be finite and above 0, and axes at right angles.
// Axes that are nearly so are replaced by the nearest ones that are, around the image's centre, if no voxel leaves its
// place by more than half a voxel; a note says so where it is more than rounding. If not, returns false and adds
// problems.
bool CheckPlace(VolumeImage& image, Problems& problems);

// Whether all values are finite.
bool CheckValues(const VolumeImage& image, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_FILES_H_
