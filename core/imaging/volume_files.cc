#include "core/imaging/volume_files.h"

#include <stdlib.h>
#include <zlib.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "core/base/letters.h"

namespace fascicle {
namespace {

std::string Gigabytes(double bytes) {
  std::ostringstream text;
  text.precision(3);
  text << bytes / 1e9 << " GB";
  return text.str();
}

void AddSheared(const VolumeImage& image, const std::string& more, Problems& problems) {
  std::ostringstream message;
  message.precision(3);
  message << "the image's axes are not at right angles, or not finite" << more;
  if (image.direction.allFinite()) {
    const Mat3 cosines = image.direction.transpose() * image.direction;
    const auto angle = [&](int a, int b) {
      return std::acos(std::clamp(cosines(a, b), -1.0, 1.0)) * 180 / std::numbers::pi;
    };
    message << ": " << angle(0, 1) << ", " << angle(1, 2) << " and " << angle(2, 0) << " degrees";
  }
  problems.Add("", message.str(), "resample it to a box of voxels");
}

// Replaces axes by the nearest orthonormal ones, around the image's centre.
bool SquareAxes(VolumeImage& image, Problems& problems) {
  const Eigen::JacobiSVD<Mat3> svd(image.direction, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 square = svd.matrixU() * svd.matrixV().transpose(), change = square - image.direction;
  Vec3 half;  // from the first voxel to the centre
  for (int axis = 0; axis < 3; ++axis) half[axis] = 0.5 * (image.size[axis] - 1) * image.spacing[axis];
  double moved = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const Vec3 signs(1, (corner & 1) != 0 ? -1 : 1, (corner & 2) != 0 ? -1 : 1);
    moved = std::max(moved, (change * half.cwiseProduct(signs)).norm());
  }
  constexpr double kMostMoved = 0.5, kUntold = 1e-3;  // of the shortest edge of a voxel
  std::ostringstream by;
  by.precision(3);
  by << moved * 1e3 << " mm";
  if (moved > kMostMoved * image.spacing.minCoeff()) {
    AddSheared(image, " (voxels would move by up to " + by.str() + ")", problems);
    return false;
  }
  if (moved > kUntold * image.spacing.minCoeff()) {
    image.notes.push_back("the image's axes are not quite at right angles: voxels are moved by up to " + by.str());
  }
  image.origin -= change * half;
  image.direction = square;
  return true;
}

}  // namespace

std::optional<VolumeFormat> FormatOf(std::string_view name) {
  const std::string lower = Lower(name);
  const auto ends = [&](const char* extension) { return lower.ends_with(extension); };
  if (ends(".mha") || ends(".mhd")) return VolumeFormat::kMetaImage;
  if (ends(".nrrd") || ends(".nhdr")) return VolumeFormat::kNrrd;
  if (ends(".nii") || ends(".nii.gz") || ends(".hdr")) return VolumeFormat::kNifti;
  if (ends(".dcm")) return VolumeFormat::kDicom;
  if (ends(".raw")) return VolumeFormat::kRaw;
  return std::nullopt;
}

bool IsDetachedHeader(std::string_view name) {
  const std::string lower = Lower(name);
  return lower.ends_with(".mhd") || lower.ends_with(".nhdr") || lower.ends_with(".hdr");
}

std::optional<std::uint64_t> SizeOf(const std::filesystem::path& path, Problems& problems) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    problems.Add("", "there is no file " + path.filename().string(), "is the path right?");
    return std::nullopt;
  }
  const std::uint64_t bytes = std::filesystem::file_size(path, error);
  if (error || !std::ifstream(path, std::ios::binary)) {
    problems.Add("", path.filename().string() + " can't be read", "is there permission to read it?");
    return std::nullopt;
  }
  return bytes;
}

std::string StartOf(const std::filesystem::path& path, std::size_t bytes) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  std::string start(error ? 0 : std::min<std::uint64_t>(bytes, size), '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  return start;
}

std::string InflatedStartOf(const std::filesystem::path& path, unsigned bytes) {
  const gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return {};
  std::string start(bytes, '\0');
  const int count = gzread(file, start.data(), bytes);
  gzclose(file);
  start.resize(static_cast<std::size_t>(std::max(count, 0)));
  return start;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "fascicle-image-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder can be made: " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

bool CheckClaim(const VolumeClaim& claim, std::int64_t memory_limit, Problems& problems) {
  constexpr double kMostVoxels = std::numeric_limits<std::int32_t>::max(), kDeflate = 1032;
  double voxels = 1;
  std::ostringstream size;
  for (int axis = 0; axis < 3; ++axis) {
    voxels *= static_cast<double>(claim.size[axis]);
    size << (axis > 0 ? " x " : "") << claim.size[axis];
  }
  if (voxels == 0) {
    problems.Add("", "the image has no voxels: " + size.str(), "");
    return false;
  }
  if (voxels > kMostVoxels) {
    problems.Add("", "the image claims " + size.str() + " voxels", "at most 2^31 - 1 can be read: crop or coarsen it");
    return false;
  }
  const double bytes = voxels * static_cast<double>(claim.bytes_per_voxel);
  const double held = static_cast<double>(claim.available) * (claim.compressed ? kDeflate : 1);
  if (bytes > held) {
    std::ostringstream message;
    message << "the file is too short: " << size.str() << " voxels need " << static_cast<std::uint64_t>(bytes)
            << " bytes, and it has " << claim.available << (claim.compressed ? " compressed ones" : "");
    problems.Add("", message.str(), "is it complete, and is its header right?");
    return false;
  }
  const double needed = bytes + voxels * sizeof(float);
  if (needed > static_cast<double>(memory_limit)) {
    problems.Add("", "reading " + size.str() + " voxels takes " + Gigabytes(needed),
                 "at most " + Gigabytes(static_cast<double>(memory_limit)) + " are allowed: crop or coarsen it");
    return false;
  }
  return true;
}

bool CheckPlace(VolumeImage& image, Problems& problems) {
  if (!image.spacing.allFinite() || !(image.spacing.minCoeff() > 0)) {
    std::ostringstream message;
    message << "the image's voxels have no volume: their spacing is " << image.spacing[0] * 1e3 << " x "
            << image.spacing[1] * 1e3 << " x " << image.spacing[2] * 1e3 << " mm";
    problems.Add("", message.str(), "all three must be above 0");
    return false;
  }
  const Mat3 off = image.direction.transpose() * image.direction - Mat3::Identity();
  // 3 degrees
  constexpr double kFurthestOff = 0.05;
  if (!image.origin.allFinite() || !image.direction.allFinite() || off.cwiseAbs().maxCoeff() > kFurthestOff) {
    AddSheared(image, "", problems);
    return false;
  }
  return off.cwiseAbs().maxCoeff() == 0 || SquareAxes(image, problems);
}

bool CheckValues(const VolumeImage& image, Problems& problems) {
  const auto finite = [](float value) { return std::isfinite(value); };
  const auto bad = std::find_if_not(image.values.begin(), image.values.end(), finite);
  if (bad == image.values.end()) return true;
  const auto count = std::count_if(bad, image.values.end(), [&](float value) { return !finite(value); });
  const auto index = bad - image.values.begin();
  std::ostringstream message;
  message << count << " voxels are infinite or not numbers: the first is (" << index % image.size[0] << ", "
          << index / image.size[0] % image.size[1] << ", " << index / image.size[0] / image.size[1] << ")";
  problems.Add("", message.str(), "write a number there, such as 0");
  return false;
}

}  // namespace fascicle
