#include "core/imaging/dicom_series.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "core/base/stop.h"
#include "core/imaging/dicom_data.h"
#include "core/imaging/dicom_voxels.h"
#include "core/imaging/volume_files.h"

namespace fascicle {
namespace {

// Largest deviation of a slice from its expected position, relative to the slice distance.
constexpr double kTolerance = 0.02;

// Tags, and the sequences that hold them in files with functional groups for their frames [DICOM PS3.3, C.7.6.16].
struct Attribute {
  std::uint32_t tag, group;
  const char* name;
};
constexpr Attribute kPosition = {0x00200032, 0x00209113, "ImagePositionPatient (0020,0032)"};
constexpr Attribute kOrientation = {0x00200037, 0x00209116, "ImageOrientationPatient (0020,0037)"};
constexpr Attribute kPixelSpacing = {0x00280030, 0x00289110, "PixelSpacing (0028,0030)"};
constexpr Attribute kThickness = {0x00180050, 0x00289110, "SliceThickness (0018,0050)"};
constexpr Attribute kDistance = {0x00180088, 0x00289110, "SpacingBetweenSlices (0018,0088)"};
constexpr Attribute kSlope = {0x00281053, 0x00289145, "RescaleSlope (0028,1053)"};
constexpr Attribute kIntercept = {0x00281052, 0x00289145, "RescaleIntercept (0028,1052)"};

struct Slice {
  std::string name;
  VolumeImage image;                // of one layer, without a thickness
  std::optional<double> thickness;  // as stated [m]
  double height = 0;                // along the normal [m]
};

// What is not stated, with the slices that lack it.
using Missing = std::map<std::string, std::vector<std::string>>;

std::string BytesOf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// The frames of one file as slices.
class FrameReader {
 public:
  FrameReader(const std::string& name, const DicomData& data, DicomVoxels& voxels, Missing& missing)
      : name_(name), data_(data), voxels_(voxels), missing_(missing) {}

  std::vector<Slice> Read() {
    const std::optional<std::vector<double>> heights = Heights();
    std::vector<Slice> slices;
    const std::size_t count = std::size_t{voxels_.columns} * voxels_.rows;
    for (std::uint32_t f = 0; f < voxels_.frames; ++f) {
      Slice slice;
      slice.name = voxels_.frames == 1 ? name_ : "frame " + std::to_string(f + 1) + " of " + name_;
      if (!Place(f, slice)) continue;
      if (heights) slice.image.origin += (*heights)[f] * slice.image.direction.col(2);
      const double slope = Number(f, kSlope).value_or(1), intercept = Number(f, kIntercept).value_or(0);
      const float* stored = voxels_.values.data() + f * count;
      slice.image.values.assign(stored, stored + count);
      if (slope != 1 || intercept != 0) {
        for (float& value : slice.image.values)
          value = static_cast<float>(slope * static_cast<double>(value) + intercept);
      }
      slices.push_back(std::move(slice));
    }
    return slices;
  }

 private:
  // An attribute of a frame: its own, one that the frames share, or one of the whole file.
  const DicomElement* Element(std::uint32_t frame, const Attribute& attribute) const {
    const auto in_group = [&](std::uint32_t groups, std::size_t item) -> const DicomElement* {
      const DicomElement* of_frames = Find(data_.elements(), groups);
      if (of_frames == nullptr || item >= of_frames->items.size()) return nullptr;
      const DicomElement* group = Find(of_frames->items[item], attribute.group);
      return group == nullptr || group->items.empty() ? nullptr : Find(group->items[0], attribute.tag);
    };
    constexpr std::uint32_t kShared = 0x52009229, kOfEachFrame = 0x52009230;
    if (const DicomElement* own = in_group(kOfEachFrame, frame)) return own;
    if (const DicomElement* shared = in_group(kShared, 0)) return shared;
    return Find(data_.elements(), attribute.tag);
  }

  std::optional<std::vector<double>> Numbers(std::uint32_t frame, const Attribute& attribute, std::size_t count) const {
    const DicomElement* element = Element(frame, attribute);
    auto numbers = element == nullptr ? std::nullopt : Decimals(*element);
    if (!numbers || numbers->size() != count) return std::nullopt;
    return numbers;
  }
  std::optional<double> Number(std::uint32_t frame, const Attribute& attribute) const {
    const auto numbers = Numbers(frame, attribute, 1);
    return numbers ? std::optional<double>((*numbers)[0]) : std::nullopt;
  }

  // Where frames without positions of their own lie along the normal [m].
  std::optional<std::vector<double>> Heights() {
    if (voxels_.frames == 1 || Element(0, kPosition) != Element(1, kPosition)) return std::nullopt;
    std::vector<double> heights(voxels_.frames, 0);
    // Of doses in radiotherapy.
    const DicomElement* offsets = Find(data_.elements(), 0x3004000c);
    if (const auto given = offsets == nullptr ? std::nullopt : Decimals(*offsets);
        given && given->size() == heights.size()) {
      for (std::size_t f = 0; f < heights.size(); ++f) heights[f] = ((*given)[f] - (*given)[0]) * kMillimetre;
      return heights;
    }
    const std::optional<double> distance = Number(0, kDistance);
    if (!distance || !(std::abs(*distance) > 0)) {
      missing_[std::string(kDistance.name) + " or a position for each frame"].push_back(name_);
      return std::nullopt;
    }
    for (std::size_t f = 0; f < heights.size(); ++f)
      heights[f] = static_cast<double>(f) * std::abs(*distance) * kMillimetre;
    return heights;
  }

  // False if the place is not stated.
  bool Place(std::uint32_t frame, Slice& slice) {
    VolumeImage& image = slice.image;
    image.size = {static_cast<std::int32_t>(voxels_.columns), static_cast<std::int32_t>(voxels_.rows), 1};
    const auto require = [&](const Attribute& attribute, std::size_t count) {
      auto numbers = Numbers(frame, attribute, count);
      if (!numbers) missing_[attribute.name].push_back(slice.name);
      return numbers;
    };
    const auto spacing = require(kPixelSpacing, 2), position = require(kPosition, 3), axes = require(kOrientation, 6);
    if (!spacing || !position || !axes) return false;
    // The distance of rows comes first.
    image.spacing = Vec3((*spacing)[1], (*spacing)[0], (*spacing)[1]) * kMillimetre;
    image.origin = Vec3((*position)[0], (*position)[1], (*position)[2]) * kMillimetre;
    const Vec3 i((*axes)[0], (*axes)[1], (*axes)[2]), j((*axes)[3], (*axes)[4], (*axes)[5]);
    image.direction << i, j, i.cross(j).normalized();
    slice.thickness = Number(frame, kDistance);
    if (!slice.thickness) slice.thickness = Number(frame, kThickness);
    if (slice.thickness) *slice.thickness = std::abs(*slice.thickness) * kMillimetre;
    return true;
  }

  const std::string& name_;
  const DicomData& data_;
  DicomVoxels& voxels_;
  Missing& missing_;
};

void AddMissing(const Missing& missing, Problems& problems) {
  for (const auto& [what, names] : missing) {
    std::string where = names[0];
    if (names.size() > 1) where += " and " + std::to_string(names.size() - 1) + " more";
    problems.Add(
        "", where + " do" + (names.size() > 1 ? "" : "es") + " not state " + what,
        "without it the size or place of the voxels is unknown: export the series again, as images of CT or MR");
  }
}

std::optional<std::vector<Slice>> ReadSlices(const std::vector<DicomFile>& files, const VolumeReaderOptions& options,
                                             Problems& problems) {
  std::vector<Slice> slices;
  std::set<std::string> series;
  Missing missing;
  std::int64_t left = options.memory_limit;
  for (const DicomFile& file : files) {
    ThrowIfStopped(options.stop);
    Problems found;
    std::optional<DicomVoxels> voxels;
    const std::optional<DicomData> data = DicomData::Parse(BytesOf(file.path), options, found);
    if (data) voxels = ReadDicomVoxels(*data, left, found);
    for (const Problem& problem : found.kept()) {
      problems.Add(problem.path, files.size() == 1 ? problem.message : file.name + ": " + problem.message,
                   problem.hint);
    }
    if (!voxels) continue;
    left -= static_cast<std::int64_t>(voxels->values.size() * sizeof(float));
    series.insert(data->Text(0x0020000e));
    std::vector<Slice> frames = FrameReader(file.name, *data, *voxels, missing).Read();
    std::move(frames.begin(), frames.end(), std::back_inserter(slices));
  }
  if (series.size() > 1) {
    problems.Add("", "the slices belong to " + std::to_string(series.size()) + " series",
                 "give the slices of one series only");
  }
  AddMissing(missing, problems);
  if (!problems.empty()) return std::nullopt;
  return slices;
}

// Whether the slices are parallel and have the same size, spacing and direction.
bool CheckAlike(const std::vector<Slice>& slices, Problems& problems) {
  const VolumeImage& first = slices[0].image;
  for (const Slice& slice : slices) {
    const VolumeImage& image = slice.image;
    const char* differs = nullptr;
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

// A slice by itself is a layer.
bool TakeThickness(const Slice& slice, VolumeImage& image, Problems& problems) {
  if (!slice.thickness || !(*slice.thickness > 0)) {
    problems.Add("", "there is one slice, which does not state its SliceThickness (0018,0050)",
                 "give all slices of the series");
    return false;
  }
  image.spacing[2] = *slice.thickness;
  image.notes.push_back("there is one slice: it is taken as thick as it states, " + Millimetres(*slice.thickness));
  return true;
}

std::optional<VolumeImage> Stack(std::vector<Slice> slices, Problems& problems) {
  // The slices' own axes, before they are made exactly orthonormal.
  VolumeImage first = slices[0].image;
  if (!CheckPlace(first, problems) || !CheckAlike(slices, problems)) return std::nullopt;
  VolumeImage stack = std::move(slices[0].image);
  if (slices.size() == 1) {
    if (!TakeThickness(slices[0], stack, problems) || !CheckPlace(stack, problems)) return std::nullopt;
    return stack;
  }
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
  if (!CheckPlace(stack, problems)) return std::nullopt;
  return stack;
}

}  // namespace

std::optional<VolumeImage> ReadDicomSeries(const std::vector<DicomFile>& files, const VolumeReaderOptions& options,
                                           Problems& problems) {
  std::optional<std::vector<Slice>> slices = ReadSlices(files, options, problems);
  if (!slices) return std::nullopt;
  std::optional<VolumeImage> stack = Stack(std::move(*slices), problems);
  if (!stack || !CheckValues(*stack, problems)) return std::nullopt;
  return stack;
}

}  // namespace fascicle
