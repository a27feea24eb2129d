// From the layout of a file to its voxels.
#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <system_error>

#include "core/base/stop.h"
#include "core/imaging/unpack.h"
#include "core/imaging/volume_files.h"
#include "core/imaging/volume_layout.h"
#include "core/imaging/voxel_types.h"

namespace fascicle {
namespace {

namespace fs = std::filesystem;

bool TooShort(Problems& problems, const std::string& what) {
  problems.Add("", "the file is too short: " + what, "is it complete, and is its header right?");
  return false;
}

bool IsBlank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0 || c == ','; }

class VoxelReader {
 public:
  VoxelReader(VolumeLayout layout, const fs::path& header, const VolumeReaderOptions& options, Problems& problems)
      : layout_(std::move(layout)), options_(options), problems_(problems) {
    for (const std::string& file : layout_.files) paths_.push_back(header.parent_path() / file);
    if (paths_.empty()) paths_.push_back(header);
  }

  std::optional<VolumeImage> Read() {
    if (!Measure()) return std::nullopt;
    VolumeImage& image = layout_.image;
    for (std::size_t axis = 0; axis < 3; ++axis) image.size[axis] = static_cast<std::int32_t>(layout_.size[axis]);
    if (!CheckPlace(image, problems_)) return std::nullopt;
    image.values.resize(image.voxels());
    // Each file holds equal parts of the voxels.
    const std::size_t part = image.voxels() / paths_.size();
    if (part * paths_.size() != image.voxels()) {
      problems_.Add("",
                    std::to_string(image.voxels()) + " voxels can't be shared by " + std::to_string(paths_.size()) +
                        " data files",
                    "each must hold the same number of slices");
      return std::nullopt;
    }
    for (std::size_t f = 0; f < paths_.size(); ++f) {
      if (!ReadPart(paths_[f], part, image.values.data() + f * part)) return std::nullopt;
    }
    if (layout_.replaces_non_finite) ReplaceNonFinite();
    if (!CheckValues(image, problems_)) return std::nullopt;
    return std::move(image);
  }

 private:
  // Whether the files may hold the voxels, before anything of their size is allocated.
  bool Measure() {
    VolumeClaim claim;
    claim.size = layout_.size;
    for (const fs::path& path : paths_) {
      const std::optional<std::uint64_t> bytes = SizeOf(path, problems_);
      if (!bytes) return false;
      const auto start = static_cast<std::uint64_t>(layout_.start);
      claim.available += *bytes - std::min(*bytes, start);
    }
    if (layout_.packing == Packing::kAsMarked) {
      layout_.packing = StartOf(paths_[0], 2) == "\x1f\x8b" ? Packing::kDeflate : Packing::kNone;
    }
    claim.compressed = layout_.packing != Packing::kNone;
    if (!claim.compressed && layout_.skip > 0) {
      claim.available -= std::min(claim.available, static_cast<std::uint64_t>(layout_.skip));
    }
    claim.bytes_per_voxel = BytesOf(layout_.type);
    if (layout_.coding == Coding::kHexadecimal) claim.bytes_per_voxel *= 2;
    // In text, every number takes at least a digit.
    if (layout_.coding == Coding::kDecimal) claim.bytes_per_voxel = 1;
    return CheckClaim(claim, options_.memory_limit, problems_);
  }

  bool ReadPart(const fs::path& path, std::size_t count, float* values) {
    ThrowIfStopped(options_.stop);
    const bool binary = layout_.coding == Coding::kBinary;
    const std::uint64_t width = BytesOf(layout_.type);
    // Text has no known length.
    const std::uint64_t need =
        binary ? count * width : static_cast<std::uint64_t>(std::max<std::int64_t>(options_.memory_limit, 0));
    std::string data;
    if (!ReadData(path, need, data)) return false;
    if (layout_.coding == Coding::kDecimal) return ReadDecimals(data, count, values);
    if (layout_.coding == Coding::kHexadecimal && !Unhex(data)) return false;
    if (data.size() < count * width) {
      return TooShort(problems_, std::to_string(count) + " voxels need " + std::to_string(count * width) +
                                     " bytes, and it has " + std::to_string(data.size()));
    }
    if (layout_.big_endian != (std::endian::native == std::endian::big)) {
      for (std::size_t at = 0; at < count * width; at += width) {
        std::reverse(&data[at], &data[at] + width);
      }
    }
    ConvertVoxels(layout_.type, data.data(), count, layout_.slope, layout_.intercept, values);
    return true;
  }

  // The bytes of voxels in a file, unpacked: at most `need`.
  bool ReadData(const fs::path& path, std::uint64_t need, std::string& data) {
    const std::optional<std::uint64_t> bytes = SizeOf(path, problems_);
    if (!bytes) return false;
    const bool packed = layout_.packing != Packing::kNone;
    const auto skip = static_cast<std::uint64_t>(std::max<std::int64_t>(layout_.skip, 0));
    std::uint64_t from = static_cast<std::uint64_t>(layout_.start);
    if (!packed) from += skip;
    if (!packed && layout_.skip < 0) from = *bytes - std::min(*bytes, need);
    from = std::min(from, *bytes);
    std::string read(static_cast<std::size_t>(packed ? *bytes - from : std::min(*bytes - from, need)), '\0');
    std::ifstream in(path, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(from));
    in.read(read.data(), static_cast<std::streamsize>(read.size()));
    if (!in) {
      problems_.Add("", "it can't be read to its end", "");
      return false;
    }
    if (!packed) {
      if (layout_.skip >= 0 && layout_.coding == Coding::kBinary) NoteRest(*bytes - from - read.size());
      data = std::move(read);
      return true;
    }
    const Compression compression = layout_.packing == Packing::kBzip2 ? Compression::kBzip2 : Compression::kGzipOrZlib;
    // Three bytes more show whether there are more than needed. The last ones may be anywhere.
    const auto limit = static_cast<std::uint64_t>(std::max<std::int64_t>(options_.memory_limit, 0));
    const std::uint64_t most = layout_.skip < 0 ? limit : skip + need + 3;
    if (!Unpack(compression, read, most, data, options_.stop, problems_)) return false;
    if (layout_.skip < 0) {
      data.erase(0, data.size() - std::min<std::size_t>(data.size(), static_cast<std::size_t>(need)));
    } else {
      data.erase(0, static_cast<std::size_t>(skip));
      NoteRest(data.size() - std::min<std::uint64_t>(data.size(), need));
    }
    return true;
  }

  // A byte or two may end a line.
  void NoteRest(std::uint64_t bytes) {
    if (bytes <= 2 || has_rest_) return;
    has_rest_ = true;
    layout_.image.notes.push_back("the file has more voxels than its header says: the rest is left out");
  }

  bool ReadDecimals(const std::string& text, std::size_t count, float* values) {
    const char *at = text.data(), *const end = at + text.size();
    for (std::size_t v = 0; v < count; ++v) {
      while (at != end && IsBlank(*at)) ++at;
      if (at == end) {
        return TooShort(problems_, "its text has " + std::to_string(v) + " numbers of " + std::to_string(count));
      }
      if (*at == '+') ++at;
      double number = 0;
      const auto [next, error] = std::from_chars(at, end, number);
      if (error != std::errc() || (next != end && !IsBlank(*next))) {
        problems_.Add("",
                      "its text has something else than a number: `" +
                          std::string(at, std::min<std::ptrdiff_t>(end - at, 20)) + "`",
                      "is it what its header says?");
        return false;
      }
      at = next;
      values[v] = static_cast<float>(layout_.slope * number + layout_.intercept);
    }
    return true;
  }

  // Two digits a byte, in any lines.
  bool Unhex(std::string& text) {
    std::erase_if(text, IsBlank);
    const auto digit = [](char c) {
      return c >= '0' && c <= '9'   ? c - '0'
             : c >= 'a' && c <= 'f' ? c - 'a' + 10
             : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                    : -1;
    };
    for (std::size_t at = 0; at + 1 < text.size(); at += 2) {
      const int high = digit(text[at]), low = digit(text[at + 1]);
      if (high < 0 || low < 0) {
        problems_.Add("", "its text has something else than hexadecimal digits", "is it what its header says?");
        return false;
      }
      text[at / 2] = static_cast<char>(16 * high + low);
    }
    text.resize(text.size() / 2);
    return true;
  }

  void ReplaceNonFinite() {
    std::int64_t count = 0;
    for (float& value : layout_.image.values) {
      if (std::isfinite(value)) continue;
      value = 0;
      ++count;
    }
    if (count == 0) return;
    layout_.image.notes.push_back(std::to_string(count) + " voxels are infinite or not numbers: they are read as 0");
  }

  VolumeLayout layout_;
  const VolumeReaderOptions& options_;
  Problems& problems_;
  std::vector<fs::path> paths_;
  bool has_rest_ = false;
};

}  // namespace

std::optional<VolumeImage> ReadVoxels(VolumeLayout layout, const fs::path& header, const VolumeReaderOptions& options,
                                      Problems& problems) {
  return VoxelReader(std::move(layout), header, options, problems).Read();
}

std::size_t BytesOf(VoxelType type) {
  std::size_t bytes = 0;
  WithType(type, [&]<class T>(T) { bytes = sizeof(T); });
  return bytes;
}

void ConvertVoxels(VoxelType type, const char* bytes, std::size_t count, double slope, double intercept,
                   float* values) {
  const bool scaled = slope != 1 || intercept != 0;
  WithType(type, [&]<class T>(T) {
    for (std::size_t v = 0; v < count; ++v) {
      T number;
      std::memcpy(&number, bytes + v * sizeof(T), sizeof(T));
      values[v] =
          scaled ? static_cast<float>(slope * static_cast<double>(number) + intercept) : static_cast<float>(number);
    }
  });
}

}  // namespace fascicle
