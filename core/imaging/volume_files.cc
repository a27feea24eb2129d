#include "core/imaging/volume_files.h"

#include <stdlib.h>
#include <zlib.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "core/base/stop.h"

namespace fascicle {
namespace {

// Headers have few and short lines. Anything beyond these bounds is not a header, whatever a library would do with it.
constexpr std::size_t kLongestLine = 4096, kMostLines = 1000;

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Removes and returns the next line of `text`; nothing at its end, or when the line is too long.
std::optional<std::string_view> TakeLine(std::string_view& text) {
  if (text.empty()) return std::nullopt;
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  if (line.size() > kLongestLine) return std::nullopt;
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

bool AddNoHeader(VolumeFormat format, Problems& problems) {
  problems.Add("", "the file has no header of a " + NameOf(format) + " image",
               "is it complete, and is it what its extension says?");
  return false;
}

// A header may name one data file, which must be beside it.
bool CheckDataFile(const std::string& name, Problems& problems) {
  const bool several = name == "LIST" || name.starts_with("LIST ") || name.find('%') != std::string::npos;
  if (several) {
    problems.Add("", "the header names several data files: `" + name.substr(0, 100) + "`",
                 "save the image with one file for all voxels, or as .mha, .nrrd or .nii.gz");
    return false;
  }
  if (name.find_first_of("/\\") != std::string::npos || name == "." || name == "..") {
    problems.Add("", "the header names a data file in another folder: `" + name.substr(0, 100) + "`",
                 "it must be in the header's folder and be named without one");
    return false;
  }
  return true;
}

bool ReadMetaHeader(std::string_view& text, TextHeader& header, Problems& problems) {
  bool has_dimensions = false;
  for (std::size_t lines = 0; lines < kMostLines; ++lines) {
    const std::optional<std::string_view> line = TakeLine(text);
    const std::size_t equals = line ? line->find('=') : std::string_view::npos;
    if (equals == std::string_view::npos) return AddNoHeader(VolumeFormat::kMetaImage, problems);
    const std::string key = Lower(Trimmed(line->substr(0, equals)));
    const std::string_view value = Trimmed(line->substr(equals + 1));
    if (key == "ndims") {
      // The library supports up to ten dimensions.
      if (value != "2" && value != "3" && value != "4") {
        problems.Add("", "the image has `" + std::string(value.substr(0, 20)) + "` dimensions",
                     "only three can be read");
        return false;
      }
      has_dimensions = true;
    } else if (key == "compresseddata") {
      header.compressed = !value.empty() && (value[0] == 'T' || value[0] == 't' || value[0] == '1');
    } else if (key == "binarydata") {
      header.as_text = !value.empty() && (value[0] == 'F' || value[0] == 'f' || value[0] == '0');
    } else if (key == "elementdatafile") {
      if (!has_dimensions) return AddNoHeader(VolumeFormat::kMetaImage, problems);
      if (value == "LOCAL" || value == "Local" || value == "local") return true;
      header.data_file = std::string(value);
      return CheckDataFile(header.data_file, problems);
    }
  }
  return AddNoHeader(VolumeFormat::kMetaImage, problems);
}

bool ReadNrrdHeader(std::string_view& text, TextHeader& header, Problems& problems) {
  const std::optional<std::string_view> magic = TakeLine(text);
  if (!magic || !magic->starts_with("NRRD000")) return AddNoHeader(VolumeFormat::kNrrd, problems);
  for (std::size_t lines = 0; lines < kMostLines; ++lines) {
    const std::optional<std::string_view> line = TakeLine(text);
    if (!line) return header.data_file.empty() ? AddNoHeader(VolumeFormat::kNrrd, problems) : true;
    if (Trimmed(*line).empty()) return true;
    const std::size_t colon = line->find(": ");
    if (line->starts_with('#') || colon == std::string_view::npos) continue;
    const std::string key = Lower(line->substr(0, colon));
    const std::string_view value = Trimmed(line->substr(colon + 2));
    if (key == "encoding") {
      const std::string encoding = Lower(value);
      header.compressed = encoding != "raw";
      header.as_text = encoding == "ascii" || encoding == "txt" || encoding == "text";
    } else if (key == "data file" || key == "datafile") {
      header.data_file = std::string(value);
      if (!CheckDataFile(header.data_file, problems)) return false;
    }
  }
  return AddNoHeader(VolumeFormat::kNrrd, problems);
}

std::string Gigabytes(double bytes) {
  std::ostringstream text;
  text.precision(3);
  text << bytes / 1e9 << " GB";
  return text.str();
}

}  // namespace

std::optional<VolumeFormat> FormatOf(std::string_view name) {
  const std::string lower = Lower(name);
  const auto ends = [&](const char* extension) { return lower.ends_with(extension); };
  if (ends(".mha") || ends(".mhd")) return VolumeFormat::kMetaImage;
  if (ends(".nrrd") || ends(".nhdr")) return VolumeFormat::kNrrd;
  if (ends(".nii") || ends(".nii.gz")) return VolumeFormat::kNifti;
  if (ends(".dcm")) return VolumeFormat::kDicom;
  if (ends(".raw")) return VolumeFormat::kRaw;
  return std::nullopt;
}

std::string NameOf(VolumeFormat format) {
  switch (format) {
    case VolumeFormat::kMetaImage:
      return "MetaImage";
    case VolumeFormat::kNrrd:
      return "NRRD";
    case VolumeFormat::kNifti:
      return "NIfTI";
    case VolumeFormat::kDicom:
      return "DICOM";
    case VolumeFormat::kRaw:
      return "raw";
  }
  return {};
}

bool IsDetachedHeader(std::string_view name) {
  const std::string lower = Lower(name);
  return lower.ends_with(".mhd") || lower.ends_with(".nhdr");
}

std::optional<TextHeader> ReadTextHeader(VolumeFormat format, std::string_view bytes, Problems& problems) {
  TextHeader header;
  std::string_view rest = bytes;
  const bool read = format == VolumeFormat::kMetaImage ? ReadMetaHeader(rest, header, problems)
                                                       : ReadNrrdHeader(rest, header, problems);
  if (!read) return std::nullopt;
  header.bytes = bytes.size() - rest.size();
  return header;
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

bool CheckDeflated(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  constexpr int kEitherHeader = 15 + 32;
  std::vector<unsigned char> scratch(1 << 16);
  z_stream stream = {};
  int state = inflateInit2(&stream, kEitherHeader);
  constexpr std::size_t kMost = 1 << 30;  // zlib counts in 32 bits
  while (state == Z_OK && !stop.stop_requested()) {
    if (stream.avail_in == 0) {
      const std::size_t taken = std::min(bytes.size(), kMost);
      if (taken == 0) break;
      stream.next_in = reinterpret_cast<unsigned char*>(const_cast<char*>(bytes.data()));
      stream.avail_in = static_cast<unsigned>(taken);
      bytes.remove_prefix(taken);
    }
    stream.next_out = scratch.data();
    stream.avail_out = static_cast<unsigned>(scratch.size());
    state = inflate(&stream, Z_NO_FLUSH);
  }
  inflateEnd(&stream);
  ThrowIfStopped(stop);
  if (state == Z_STREAM_END) return true;
  problems.Add("", "the file's compressed voxels are incomplete or damaged", "is it complete?");
  return false;
}

bool CheckPlace(VolumeImage& image, Problems& problems) {
  if (!image.spacing.allFinite() || !(image.spacing.minCoeff() > 0)) {
    std::ostringstream message;
    message << "the image's voxels have no volume: their spacing is " << image.spacing.transpose() * 1e3 << " mm";
    problems.Add("", message.str(), "all three must be above 0");
    return false;
  }
  const Mat3 off = image.direction.transpose() * image.direction - Mat3::Identity();
  if (!image.origin.allFinite() || !image.direction.allFinite() || off.cwiseAbs().maxCoeff() > 1e-3) {
    problems.Add("", "the image's axes are not at right angles, or not finite", "resample it to a box of voxels");
    return false;
  }
  if (off.cwiseAbs().maxCoeff() > 0) {
    const Eigen::JacobiSVD<Mat3> svd(image.direction, Eigen::ComputeFullU | Eigen::ComputeFullV);
    image.direction = svd.matrixU() * svd.matrixV().transpose();
  }
  return true;
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
