#include "core/imaging/volume_reader.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <fstream>
#include <set>
#include <stdexcept>
#include <system_error>

#include "core/base/stop.h"
#include "core/imaging/dicom_series.h"
#include "core/imaging/itk_image_io.h"
#include "core/imaging/nifti_check.h"
#include "core/imaging/volume_files.h"

namespace fascicle {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTypeNames[] = {"uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"};
// Upper bound for the header of a MetaImage or NRRD file.
constexpr std::size_t kLongestHeader = 1 << 20;

std::string BaseName(std::string_view name) { return fs::path(name).filename().string(); }

// Size of a file; nothing, with a problem, if it can't be read.
std::optional<std::uint64_t> SizeOf(const fs::path& path, Problems& problems) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    problems.Add("", "there is no file " + path.filename().string(), "is the path right?");
    return std::nullopt;
  }
  const std::uint64_t bytes = fs::file_size(path, error);
  if (error || !std::ifstream(path, std::ios::binary)) {
    problems.Add("", path.filename().string() + " can't be read", "is there permission to read it?");
    return std::nullopt;
  }
  return bytes;
}

std::string StartOf(const fs::path& path, std::size_t bytes) {
  std::ifstream in(path, std::ios::binary);
  std::string start(bytes, '\0');
  in.read(start.data(), static_cast<std::streamsize>(bytes));
  start.resize(static_cast<std::size_t>(in.gcount()));
  return start;
}

// The first bytes of a file that may be compressed by gzip.
std::string InflatedStartOf(const fs::path& path, unsigned bytes) {
  const gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return {};
  std::string start(bytes, '\0');
  const int count = gzread(file, start.data(), bytes);
  gzclose(file);
  start.resize(static_cast<std::size_t>(std::max(count, 0)));
  return start;
}

std::optional<VolumeImage> ReadRaw(const fs::path& path, std::uint64_t bytes, const VolumeReaderOptions& options,
                                   Problems& problems) {
  if (!options.raw) {
    problems.Add("", "a .raw file does not say what it holds", "give its size, spacing and type of numbers");
    return std::nullopt;
  }
  const RawLayout& layout = *options.raw;
  VolumeImage image;
  image.size = layout.size;
  image.spacing = layout.spacing;
  if (*std::min_element(layout.size.begin(), layout.size.end()) < 1 || layout.header_bytes < 0) {
    problems.Add("", "the layout of the .raw file has a size below 1", "give the voxels along i, j and k");
    return std::nullopt;
  }
  const std::size_t width = BytesOf(layout.type);
  const auto skipped = static_cast<std::uint64_t>(layout.header_bytes);
  VolumeClaim claim{{}, width, bytes - std::min(bytes, skipped), false};
  std::copy(layout.size.begin(), layout.size.end(), claim.size.begin());
  if (!CheckClaim(claim, options.memory_limit, problems) || !CheckPlace(image, problems)) return std::nullopt;
  if (claim.available != image.voxels() * width) {
    problems.Add(
        "",
        "the file has " + std::to_string(claim.available - image.voxels() * width) + " bytes more than its layout says",
        "are size, type and header_bytes right?");
    return std::nullopt;
  }
  std::ifstream in(path, std::ios::binary);
  in.seekg(layout.header_bytes);
  std::vector<char> data(image.voxels() * width);
  in.read(data.data(), static_cast<std::streamsize>(data.size()));
  if (!in) {
    problems.Add("", "it can't be read to its end", "");
    return std::nullopt;
  }
  if (layout.big_endian != (std::endian::native == std::endian::big)) {
    for (std::size_t at = 0; at < data.size(); at += width) std::reverse(&data[at], &data[at] + width);
  }
  image.values.resize(image.voxels());
  ConvertVoxels(layout.type, data.data(), image.voxels(), image.values.data());
  if (!CheckValues(image, problems)) return std::nullopt;
  return image;
}

// The bits per voxel, a 16-bit number in either byte order; 0 if the value is not a known one.
std::uint64_t NiftiVoxelBytes(const std::string& header) {
  constexpr std::size_t kPlace = 72;
  if (header.size() < kNiftiHeader) return 0;
  const auto byte = [&](std::size_t at) { return static_cast<unsigned>(static_cast<unsigned char>(header[at])); };
  const unsigned bits = byte(kPlace) + byte(kPlace + 1);  // one of the two is 0
  return bits == 8 || bits == 16 || bits == 32 || bits == 64 ? bits / 8 : 0;
}

// Compressed voxels at an offset of their file must be complete. Other encodings, such as text, are left to ITK.
bool CheckCompressed(const ItkFile& file, std::size_t offset, const fs::path& voxels, const std::stop_token& stop,
                     Problems& problems) {
  const std::string bytes = StartOf(voxels, offset + file.bytes);
  const std::string_view data = std::string_view(bytes).substr(std::min(offset, bytes.size()));
  const bool gzip = data.starts_with("\x1f\x8b");
  if (!gzip && file.format != VolumeFormat::kMetaImage) return true;
  return CheckDeflated(data, stop, problems);
}

std::optional<VolumeImage> ReadFile(const fs::path& path, const VolumeReaderOptions& options, Problems& problems) {
  const std::optional<VolumeFormat> format = FormatOf(path.filename().string());
  const std::optional<std::uint64_t> bytes = SizeOf(path, problems);
  if (!bytes) return std::nullopt;
  if (*format == VolumeFormat::kRaw) return ReadRaw(path, *bytes, options, problems);
  ItkFile file{*format, path, *bytes, true};
  fs::path voxels = path;
  std::size_t offset = 0;
  if (*format == VolumeFormat::kNifti) {
    file.compressed = path.extension() != ".nii";
    const std::string header = InflatedStartOf(path, kNiftiHeader);
    if (!CheckNiftiPlace(header, problems)) return std::nullopt;
    if (!file.compressed) {
      file.bytes -= std::min<std::uint64_t>(file.bytes, kNiftiHeader);
      file.bytes_per_voxel = NiftiVoxelBytes(header);
    }
  }
  if (*format == VolumeFormat::kMetaImage || *format == VolumeFormat::kNrrd) {
    const std::optional<TextHeader> header = ReadTextHeader(*format, StartOf(path, kLongestHeader), problems);
    if (!header) return std::nullopt;
    // In text every number takes at least a digit and a blank.
    file.compressed = header->compressed || header->as_text;
    file.bytes -= header->bytes;
    offset = header->bytes;
    if (!header->data_file.empty()) {
      voxels = path.parent_path() / header->data_file;
      offset = 0;
      const std::optional<std::uint64_t> data = SizeOf(voxels, problems);
      if (!data) return std::nullopt;
      file.bytes = *data;
    }
  }
  if (file.compressed && !CheckCompressed(file, offset, voxels, options.stop, problems)) return std::nullopt;
  ThrowIfStopped(options.stop);
  std::optional<ItkVolume> volume = ReadByItk(file, options.memory_limit, problems);
  ThrowIfStopped(options.stop);
  if (!volume) return std::nullopt;
  return std::move(volume->image);
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
  if (!slices.empty() || images.size() > (header != images.end() ? 2 : 1)) {
    problems.Add("", "several images are given",
                 "only one can be read; several files must be slices of a DICOM series");
    return std::nullopt;
  }
  return ReadFile(images[0], options, problems);
}

std::vector<fs::path> DicomFilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_regular_file(error) && entry.path().filename() != "DICOMDIR" && IsDicom(entry.path())) {
      files.push_back(entry.path());
    }
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

std::string DataFileOf(const VolumeFile& header, Problems& problems) {
  const std::optional<VolumeFormat> format = FormatOf(header.name);
  if (format != VolumeFormat::kMetaImage && format != VolumeFormat::kNrrd) return {};
  const std::optional<TextHeader> read = ReadTextHeader(*format, header.bytes.substr(0, kLongestHeader), problems);
  return read ? read->data_file : std::string();
}

bool IsVolumeName(std::string_view name) { return FormatOf(name).has_value(); }

std::string KnownVolumeExtensions() { return ".mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz, .dcm or .raw"; }

}  // namespace fascicle
