#include "client/image/label_surface.h"

#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkImageGaussianSmooth.h>
#include <vtkMatrix4x4.h>
#include <vtkMetaImageReader.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/base/stop.h"

namespace fascicle::client {
namespace {

constexpr int kLevelRounds = 8;
constexpr double kVolumeTolerance = 1e-3;
constexpr std::size_t kLabelsTold = 20;

using Index = std::array<int, 3>;

// Maps voxel indices to positions.
struct Image {
  vtkSmartPointer<vtkImageData> data;
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
};

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool IsMetaImage(const std::string& name) {
  const std::string lower = Lower(name);
  return lower.ends_with(".mha") || lower.ends_with(".mhd");
}

// The directions of a MetaImage's axes, which VTK's reader ignores.
Eigen::Matrix3d Directions(const std::filesystem::path& path) {
  constexpr int kLongestHeader = 200;  // lines
  Eigen::Matrix3d directions = Eigen::Matrix3d::Identity();
  std::ifstream in(path, std::ios::binary);
  std::string line;
  for (int i = 0; i < kLongestHeader && std::getline(in, line) && !line.starts_with("ElementDataFile"); ++i) {
    const std::size_t equals = line.find('=');
    const std::string key = line.substr(0, line.find_first_of(" \t="));
    if (equals == std::string::npos || (key != "TransformMatrix" && key != "Rotation" && key != "Orientation"))
      continue;
    std::istringstream numbers(line.substr(equals + 1));
    Eigen::Matrix3d read;
    for (int axis = 0; axis < 3; ++axis) {
      for (int c = 0; c < 3; ++c) numbers >> read(c, axis);
    }
    if (numbers && std::abs(read.determinant()) > 1e-6) directions = read;
  }
  return directions;
}

std::optional<Image> ReadMetaImage(const std::filesystem::path& path, vtkCallbackCommand* on_error) {
  vtkNew<vtkMetaImageReader> reader;
  reader->AddObserver("ErrorEvent", on_error);
  if (reader->CanReadFile(path.c_str()) == 0) return std::nullopt;
  reader->SetFileName(path.c_str());
  reader->Update();
  Image image{reader->GetOutput()};
  const double *spacing = image.data->GetSpacing(), *origin = image.data->GetOrigin();
  image.place.linear() = Directions(path) * Vec3(spacing).asDiagonal();
  image.place.translation() = Vec3(origin);
  return image;
}

std::optional<Image> ReadNifti(const std::filesystem::path& path, vtkCallbackCommand* on_error) {
  vtkNew<vtkNIFTIImageReader> reader;
  reader->AddObserver("ErrorEvent", on_error);
  if (reader->CanReadFile(path.c_str()) == 0) return std::nullopt;
  reader->SetFileName(path.c_str());
  reader->Update();
  Image image{reader->GetOutput()};
  vtkMatrix4x4* matrix = reader->GetSFormMatrix() != nullptr ? reader->GetSFormMatrix() : reader->GetQFormMatrix();
  Eigen::Affine3d placed = Eigen::Affine3d::Identity();
  for (int r = 0; matrix != nullptr && r < 3; ++r) {
    for (int c = 0; c < 4; ++c) placed(r, c) = matrix->GetElement(r, c);
  }
  image.place = placed * Eigen::Scaling(Vec3(image.data->GetSpacing()));
  return image;
}

std::optional<Image> ReadImage(const std::filesystem::path& path, Problems& problems) {
  // Otherwise VTK would print errors itself.
  bool failed = false;
  vtkNew<vtkCallbackCommand> on_error;
  on_error->SetClientData(&failed);
  on_error->SetCallback([](vtkObject*, unsigned long, void* flag, void*) { *static_cast<bool*>(flag) = true; });
  std::optional<Image> image = IsMetaImage(path.string()) ? ReadMetaImage(path, on_error) : ReadNifti(path, on_error);
  if (failed || !image || image->data->GetNumberOfPoints() == 0 ||
      image->data->GetPointData()->GetScalars() == nullptr) {
    problems.Add("", "the image can't be read", "is the file complete, and is it what its extension says?");
    return std::nullopt;
  }
  if (image->data->GetNumberOfScalarComponents() != 1) {
    problems.Add("",
                 "the image has " + std::to_string(image->data->GetNumberOfScalarComponents()) + " components a voxel",
                 "a label image has one");
    return std::nullopt;
  }
  if (!(std::abs(image->place.linear().determinant()) > 0) || !image->place.matrix().allFinite()) {
    problems.Add("", "the image's voxels have no volume", "its spacing must be above zero");
    return std::nullopt;
  }
  return image;
}

// Runs a filter, which ends at its next report of progress after a stop request.
void UpdateUnlessStopped(vtkAlgorithm& filter, std::stop_token stop) {
  vtkNew<vtkCallbackCommand> on_progress;
  on_progress->SetClientData(&stop);
  on_progress->SetCallback([](vtkObject* caller, unsigned long, void* data, void*) {
    if (static_cast<std::stop_token*>(data)->stop_requested()) vtkAlgorithm::SafeDownCast(caller)->AbortExecuteOn();
  });
  filter.AddObserver(vtkCommand::ProgressEvent, on_progress);
  filter.Update();
  filter.RemoveObserver(on_progress);
  ThrowIfStopped(stop);
}

// The voxels of a label: 1 in a box with a margin, everything else 0.
struct Mask {
  vtkNew<vtkImageData> data;  // float, in index space
  std::int64_t voxels = 0;
};

void AddUnknownLabel(vtkDataArray& values, int label, Problems& problems) {
  std::set<double> labels;
  for (vtkIdType i = 0; i < values.GetNumberOfTuples() && labels.size() <= kLabelsTold; ++i) {
    labels.insert(values.GetComponent(i, 0));
  }
  std::ostringstream known;
  const bool many = labels.size() > kLabelsTold;
  for (const double value : labels) {
    if (value != 0) known << (known.tellp() > 0 ? ", " : "") << value;
  }
  problems.Add("", "no voxel has the label " + std::to_string(label),
               known.tellp() > 0 ? (many ? "some of the existing labels: " : "existing labels: ") + known.str()
                                 : "all voxels are 0");
}

bool MakeMask(const Image& image, int label, double smoothing, Mask& mask, Problems& problems) {
  int extent[6];
  image.data->GetExtent(extent);
  vtkDataArray& values = *image.data->GetPointData()->GetScalars();
  Index lowest{extent[1], extent[3], extent[5]}, highest{extent[0], extent[2], extent[4]};
  const auto for_each_voxel = [&](const auto& visit) {
    vtkIdType i = 0;
    for (int z = extent[4]; z <= extent[5]; ++z) {
      for (int y = extent[2]; y <= extent[3]; ++y) {
        for (int x = extent[0]; x <= extent[1]; ++x, ++i) {
          if (values.GetComponent(i, 0) == label) visit(Index{x, y, z});
        }
      }
    }
  };
  for_each_voxel([&](const Index& at) {
    ++mask.voxels;
    for (int axis = 0; axis < 3; ++axis) {
      lowest[axis] = std::min(lowest[axis], at[axis]);
      highest[axis] = std::max(highest[axis], at[axis]);
    }
  });
  if (mask.voxels == 0) {
    AddUnknownLabel(values, label, problems);
    return false;
  }
  const int room = static_cast<int>(std::ceil(4 * smoothing)) + 2;
  mask.data->SetExtent(lowest[0] - room, highest[0] + room, lowest[1] - room, highest[1] + room, lowest[2] - room,
                       highest[2] + room);
  mask.data->AllocateScalars(VTK_FLOAT, 1);
  mask.data->GetPointData()->GetScalars()->Fill(0);
  for_each_voxel([&](const Index& at) { *static_cast<float*>(mask.data->GetScalarPointer(at[0], at[1], at[2])) = 1; });
  return true;
}

TriangleMesh SurfaceAt(vtkImageData& blurred, double level) {
  vtkNew<vtkFlyingEdges3D> edges;
  edges->SetInputData(&blurred);
  edges->SetValue(0, level);
  edges->ComputeNormalsOff();
  edges->ComputeGradientsOff();
  edges->ComputeScalarsOff();
  edges->Update();
  vtkPolyData& output = *edges->GetOutput();
  TriangleMesh surface;
  for (vtkIdType p = 0; p < output.GetNumberOfPoints(); ++p) surface.nodes.emplace_back(output.GetPoint(p));
  vtkIdType count = 0;
  const vtkIdType* nodes = nullptr;
  vtkCellArray& polygons = *output.GetPolys();
  for (polygons.InitTraversal(); polygons.GetNextCell(count, nodes) != 0;) {
    surface.triangles.push_back({static_cast<std::int32_t>(nodes[0]), static_cast<std::int32_t>(nodes[1]),
                                 static_cast<std::int32_t>(nodes[2])});
  }
  return surface;
}

// The surface in index space that encloses the given volume; the volume decreases with the level.
TriangleMesh SurfaceOfVolume(vtkImageData& blurred, double volume, const std::stop_token& stop) {
  double low = 0.02, high = 0.98, level = 0.5;
  TriangleMesh surface;
  for (int round = 0; round < kLevelRounds; ++round) {
    ThrowIfStopped(stop);
    surface = SurfaceAt(blurred, level);
    const double error = std::abs(EnclosedVolume(surface)) / volume - 1;
    if (std::abs(error) < kVolumeTolerance) break;
    (error > 0 ? low : high) = level;
    level = 0.5 * (low + high);
  }
  return surface;
}

}  // namespace

bool IsImageName(const std::string& name) {
  const std::string lower = Lower(name);
  return IsMetaImage(name) || lower.ends_with(".nii") || lower.ends_with(".nii.gz");
}

std::optional<LabelSurface> ReadLabelSurface(const std::filesystem::path& path, int label, double smoothing,
                                             const std::stop_token& stop, Problems& problems) {
  const std::optional<Image> image = ReadImage(path, problems);
  ThrowIfStopped(stop);
  Mask mask;
  if (!image || !MakeMask(*image, label, smoothing, mask, problems)) return std::nullopt;
  ThrowIfStopped(stop);
  vtkNew<vtkImageGaussianSmooth> blur;
  blur->SetInputData(mask.data);
  blur->SetStandardDeviation(smoothing);
  blur->SetRadiusFactor(4);
  UpdateUnlessStopped(*blur, stop);
  const auto voxels = static_cast<double>(mask.voxels);
  LabelSurface result;
  result.surface = SurfaceOfVolume(*blur->GetOutput(), voxels, stop);
  if (result.surface.triangles.empty()) {
    problems.Add("", "the label has " + std::to_string(mask.voxels) + " voxels, all of which disappear by smoothing",
                 "smooth less");
    return std::nullopt;
  }
  for (Vec3& node : result.surface.nodes) node = image->place * node;
  result.surface_volume = EnclosedVolume(result.surface);
  if (result.surface_volume < 0) {
    for (Triangle& triangle : result.surface.triangles) std::swap(triangle[1], triangle[2]);
    result.surface_volume = -result.surface_volume;
  }
  result.voxel_volume = voxels * std::abs(image->place.linear().determinant());
  return result;
}

}  // namespace fascicle::client
