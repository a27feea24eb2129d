#include "core/imaging/volume_reader.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <stdexcept>
#include <system_error>

#include "core/base/check.h"
#include "core/base/stop.h"
#include "core/imaging/dicom_data.h"
#include "core/imaging/dicom_series.h"
#include "core/imaging/volume_files.h"
#include "core/imaging/volume_layout.h"

namespace fascicle {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTypeNames[] = {"uint8", "int8",    "uint16",  "int16", "uint32",
                                      "int32", "float32", "float64", "int64", "uint64"};

std::string BaseName(std::string_view name) { return fs::path(name).filename().string(); }

std::optional<VolumeLayout> LayoutOfRaw(std::uint64_t bytes, const VolumeReaderOptions& options, Problems& problems) {
  if (!options.raw) {
    problems.Add("", "a .raw file does not say what it holds",
                 "give its size, spacing and type of numbers, as `fascicle segment` takes them");
    return std::nullopt;
  }
  const RawLayout& raw = *options.raw;
  if (*std::min_element(raw.size.begin(), raw.size.end()) < 1 || raw.header_bytes < 0) {
    problems.Add("", "the layout of the .raw file has a size below 1", "give the voxels along i, j and k");
    return std::nullopt;
  }
  VolumeLayout layout;
  std::copy(raw.size.begin(), raw.size.end(), layout.size.begin());
  layout.image.spacing = raw.spacing;
  layout.type = raw.type;
  layout.big_endian = raw.big_endian;
  layout.skip = raw.header_bytes;
  const double need =
      static_cast<double>(raw.size[0]) * raw.size[1] * raw.size[2] * static_cast<double>(BytesOf(raw.type)) +
      static_cast<double>(raw.header_bytes);
  if (static_cast<double>(bytes) > need) {
    problems.Add(
        "",
        "the file has " + std::to_string(bytes - static_cast<std::uint64_t>(need)) + " bytes more than its layout says",
        "are size, type and header_bytes right?");
    return std::nullopt;
  }
  return layout;
}

// The name of the file of voxels that belongs to a header of a pair.
std::string PairOf(const fs::path& header) {
  fs::path other = header;
  for (const char* extension : {".img", ".IMG", ".img.gz"}) {
    std::error_code error;
    if (fs::is_regular_file(other.replace_extension(extension), error)) return other.filename().string();
  }
  return fs::path(header).replace_extension(".img").filename().string();
}

std::optional<VolumeLayout> ReadLayout(VolumeFormat format, const fs::path& path, std::uint64_t bytes,
                                       const VolumeReaderOptions& options, Problems& problems) {
  switch (format) {
    case VolumeFormat::kMetaImage:
      return ReadMetaHeader(StartOf(path, kLongestHeader), problems);
    case VolumeFormat::kNrrd:
      return ReadNrrdHeader(StartOf(path, kLongestHeader), problems);
    case VolumeFormat::kNifti: {
      constexpr unsigned kHeader = 1024;
      const bool pair = IsDetachedHeader(path.filename().string());
      return ReadNiftiHeader(InflatedStartOf(path, kHeader), pair ? PairOf(path) : "", problems);
    }
    case VolumeFormat::kRaw:
      return LayoutOfRaw(bytes, options, problems);
    case VolumeFormat::kDicom:
      break;
  }
  FASCICLE_CHECK(false, "slices are read as a series");
}

// Reads one image; `others` are further files that were given, which must be those that its header names.
std::optional<VolumeImage> ReadFile(const fs::path& path, const std::vector<fs::path>& others,
                                    const VolumeReaderOptions& options, Problems& problems) {
  const std::optional<std::uint64_t> bytes = SizeOf(path, problems);
  if (!bytes) return std::nullopt;
  std::optional<VolumeLayout> layout = ReadLayout(*FormatOf(path.filename().string()), path, *bytes, options, problems);
  if (!layout) return std::nullopt;
  for (const fs::path& other : others) {
    const std::vector<std::string>& named = layout->files;
    if (std::find(named.begin(), named.end(), other.filename().string()) != named.end()) continue;
    problems.Add(
        "", "several images are given: " + path.filename().string() + " does not name " + other.filename().string(),
        "only one can be read; several files must be slices of a DICOM series, or a header and its data files");
    return std::nullopt;
  }
  ThrowIfStopped(options.stop);
  return ReadVoxels(std::move(*layout), path, options, problems);
}

// Reads the one image, or the slices of a series, that the files belong to.
std::optional<VolumeImage> ReadFiles(const std::vector<fs::path>& paths, const VolumeReaderOptions& options,
                                     Problems& problems) {
  std::vector<DicomFile> slices;
  std::vector<fs::path> images;
  for (const fs::path& path : paths) {
    const std::string name = path.filename().string();
    const std::optional<VolumeFormat> format = FormatOf(name);
    if (format == VolumeFormat::kDicom || (!format && IsDicom(path))) {
      slices.push_back({name, path});
    } else {
      images.push_back(path);
    }
  }
  if (images.empty() && !slices.empty()) {
    for (const DicomFile& slice : slices) SizeOf(slice.path, problems);
    if (!problems.empty()) return std::nullopt;
    return ReadDicomSeries(slices, options, problems);
  }
  // A header takes precedence over the data file that it names.
  const auto header = std::find_if(images.begin(), images.end(),
                                   [](const fs::path& path) { return IsDetachedHeader(path.filename().string()); });
  if (header != images.end()) std::iter_swap(images.begin(), header);
  if (images.empty()) {
    problems.Add("", "no image is given", "give a file");
    return std::nullopt;
  }
  const std::string name = images[0].filename().string();
  if (!FormatOf(name)) {
    problems.Add("", name + " is not a known image format", "expected " + KnownVolumeExtensions());
    return std::nullopt;
  }
  if (!slices.empty()) {
    problems.Add("", "several images are given",
                 "only one can be read; several files must be slices of a DICOM series");
    return std::nullopt;
  }
  return ReadFile(images[0], {images.begin() + 1, images.end()}, options, problems);
}

// The files of a series may lie in folders of the one given.
std::vector<fs::path> DicomFilesIn(const fs::path& folder) {
  constexpr int kDeepest = 4;
  std::vector<fs::path> files;
  std::error_code error;
  const auto options = fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator at(folder, options, error), end; !error && at != end; at.increment(error)) {
    if (at.depth() >= kDeepest) at.disable_recursion_pending();
    std::error_code of_entry;
    const fs::path& path = at->path();
    if (at->is_regular_file(of_entry) && path.filename() != "DICOMDIR" && IsDicom(path)) files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  return files;
}

void Write(const fs::path& path, std::string_view bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw std::runtime_error("no temporary file can be written: " + path.string());
}

}  // namespace

std::string NameOf(VoxelType type) { return kTypeNames[static_cast<int>(type)]; }

std::optional<VoxelType> VoxelTypeOf(std::string_view name) {
  const auto found = std::find(std::begin(kTypeNames), std::end(kTypeNames), name);
  if (found == std::end(kTypeNames)) return std::nullopt;
  return static_cast<VoxelType>(found - std::begin(kTypeNames));
}

std::optional<VolumeImage> ReadVolumeFiles(const std::vector<fs::path>& paths, const VolumeReaderOptions& options,
                                           Problems& problems) {
  std::error_code error;
  if (paths.size() != 1 || !fs::is_directory(paths[0], error)) return ReadFiles(paths, options, problems);
  const std::vector<fs::path> files = DicomFilesIn(paths[0]);
  if (files.empty()) {
    problems.Add("", "no DICOM file is in the folder", "give the folder of a series, or a file");
    return std::nullopt;
  }
  return ReadFiles(files, options, problems);
}

std::optional<VolumeImage> ReadVolume(const std::vector<VolumeFile>& files, const VolumeReaderOptions& options,
                                      Problems& problems) {
  const TemporaryFolder folder;
  std::set<std::string> names;
  for (const VolumeFile& file : files) names.insert(BaseName(file.name));
  std::vector<fs::path> paths;
  for (const VolumeFile& file : files) {
    ThrowIfStopped(options.stop);
    fs::path place = folder.path();
    // Slices of different folders may have the same names.
    if (names.size() < files.size()) place /= std::to_string(paths.size());
    fs::create_directories(place);
    std::string name = BaseName(file.name);
    if (name.empty() || name == "." || name == "..") name = "unnamed";
    paths.push_back(place / name);
    Write(paths.back(), file.bytes);
  }
  return ReadFiles(paths, options, problems);
}

bool IsVolumeName(std::string_view name) { return FormatOf(name).has_value(); }

std::string KnownVolumeExtensions() { return ".mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz, .hdr, .dcm or .raw"; }

}  // namespace fascicle
