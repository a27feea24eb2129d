#include "core/imaging/dicom_series.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <system_error>

#include "core/base/stop.h"
#include "core/imaging/dicom_check.h"
#include "core/imaging/itk_image_io.h"

namespace fascicle {
namespace {

// Largest deviation of a slice from its expected position, relative to the slice distance.
constexpr double kTolerance = 0.02;

struct Slice {
  std::string name;
  VolumeImage image;
  double height = 0;  // along the normal [m]
};

std::string BytesOf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::optional<std::vector<Slice>> ReadSlices(const std::vector<DicomFile>& files, const VolumeReaderOptions& options,
                                             Problems& problems) {
  std::vector<Slice> slices;
  std::set<std::string> series;
  std::int64_t left = options.memory_limit;
  for (const DicomFile& file : files) {
    ThrowIfStopped(options.stop);
    std::error_code error;
    const ItkFile one{VolumeFormat::kDicom, file.path, std::filesystem::file_size(file.path, error), true};
    Problems found;
    std::optional<ItkVolume> volume;
    if (CheckDicom(BytesOf(file.path), found)) volume = ReadByItk(one, left, found);
    for (const Problem& problem : found.kept()) {
      problems.Add(problem.path, files.size() == 1 ? problem.message : file.name + ": " + problem.message,
                   problem.hint);
    }
    if (!volume) continue;
    left -= static_cast<std::int64_t>(volume->image.voxels() * sizeof(float));
    series.insert(volume->series);
    slices.push_back({file.name, std::move(volume->image)});
  }
  if (series.size() > 1) {
    problems.Add("", "the slices belong to " + std::to_string(series.size()) + " series",
                 "give the slices of one series only");
  }
  if (!problems.empty()) return std::nullopt;
  return slices;
}

// Whether the slices are parallel and have the same size, spacing and direction.
bool CheckAlike(const std::vector<Slice>& slices, Problems& problems) {
  const VolumeImage& first = slices[0].image;
  for (const Slice& slice : slices) {
    const VolumeImage& image = slice.image;
    const char* differs = nullptr;
    if (image.size[2] != 1) differs = "contains more slices";
    if (image.size[0] != first.size[0] || image.size[1] != first.size[1]) differs = "has a different size";
    if ((image.spacing - first.spacing).head<2>().cwiseAbs().maxCoeff() > 1e-4 * first.spacing[0])
      differs = "has a different spacing";
    if ((image.direction - first.direction).cwiseAbs().maxCoeff() > 1e-3) differs = "has a different direction";
    if (differs == nullptr) continue;
    problems.Add("", slice.name + " " + differs + " than " + slices[0].name, "give the slices of one series only");
    return false;
  }
  return true;
}

std::string Millimetres(double metres) {
  std::ostringstream text;
  text.precision(4);
  text << metres * 1e3 << " mm";
  return text.str();
}

// Whether the slices, which are in order, are equally spaced; finds their distance.
bool FindDistance(const std::vector<Slice>& slices, double& distance, Problems& problems) {
  std::vector<double> gaps;
  for (std::size_t s = 1; s < slices.size(); ++s) gaps.push_back(slices[s].height - slices[s - 1].height);
  const auto same = std::min_element(gaps.begin(), gaps.end()) - gaps.begin();
  if (gaps[same] < 1e-6) {
    problems.Add("", slices[same].name + " and " + slices[same + 1].name + " are at the same position",
                 "give the slices of one series and of one time");
    return false;
  }
  std::vector<double> sorted = gaps;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double usual = sorted[sorted.size() / 2];
  for (std::size_t s = 0; s < gaps.size(); ++s) {
    if (std::abs(gaps[s] - usual) <= kTolerance * usual) continue;
    problems.Add("",
                 "slices are missing: " + slices[s].name + " and " + slices[s + 1].name + " are " +
                     Millimetres(gaps[s]) + " apart, others " + Millimetres(usual),
                 "give all slices of the series");
    return false;
  }
  distance = (slices.back().height - slices.front().height) / static_cast<double>(slices.size() - 1);
  return true;
}

std::optional<VolumeImage> Stack(std::vector<Slice> slices, Problems& problems) {
  if (!CheckAlike(slices, problems)) return std::nullopt;
  VolumeImage stack = std::move(slices[0].image);
  const Vec3 normal = stack.direction.col(2);
  slices[0].image.origin = stack.origin;
  for (Slice& slice : slices) slice.height = normal.dot(slice.image.origin);
  slices[0].image.values = std::move(stack.values);
  stack.values.clear();
  std::stable_sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) { return a.height < b.height; });
  double distance = 0;
  if (!FindDistance(slices, distance, problems)) return std::nullopt;
  stack.origin = slices[0].image.origin;
  stack.spacing[2] = distance;
  stack.size[2] = static_cast<std::int32_t>(slices.size());
  stack.values.reserve(stack.voxels());
  for (std::size_t s = 0; s < slices.size(); ++s) {
    const Vec3 place = stack.origin + static_cast<double>(s) * distance * normal;
    if ((slices[s].image.origin - place).norm() > 5 * kTolerance * distance) {
      problems.Add(
          "",
          "the slices are shifted relative to each other: " + slices[s].name + " is not aligned with " + slices[0].name,
          "the scanner was tilted: resample the series to a box of voxels");
      return std::nullopt;
    }
    stack.values.insert(stack.values.end(), slices[s].image.values.begin(), slices[s].image.values.end());
    slices[s].image.values = {};
  }
  return stack;
}

}  // namespace

std::optional<VolumeImage> ReadDicomSeries(const std::vector<DicomFile>& files, const VolumeReaderOptions& options,
                                           Problems& problems) {
  std::optional<std::vector<Slice>> slices = ReadSlices(files, options, problems);
  if (!slices) return std::nullopt;
  if (slices->size() == 1) return std::move(slices->front().image);
  return Stack(std::move(*slices), problems);
}

bool IsDicom(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  char start[132] = {};
  in.read(start, sizeof(start));
  return in && std::string_view(start + 128, 4) == "DICM";
}

}  // namespace fascicle
