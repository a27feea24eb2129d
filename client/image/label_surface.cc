#include "client/image/label_surface.h"

#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkImageGaussianSmooth.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <system_error>
#include <utility>

#include "core/base/stop.h"
#include "core/imaging/labels.h"
#include "core/imaging/volume_reader.h"

namespace fascicle::client {
namespace {

constexpr int kLevelRounds = 8;
constexpr double kVolumeTolerance = 1e-3;
constexpr double kMillimetres = 1e3;  // in a metre

using Index = std::array<int, 3>;

// Maps voxel indices to positions [mm].
Eigen::Affine3d PlaceOf(const VolumeImage& image) {
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
  place.linear() = image.direction * (kMillimetres * image.spacing).asDiagonal();
  place.translation() = kMillimetres * image.origin;
  return place;
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

bool MakeMask(const VolumeImage& image, int label, double smoothing, Mask& mask, Problems& problems) {
  Index lowest{image.size[0], image.size[1], image.size[2]}, highest{-1, -1, -1};
  const auto for_each_voxel = [&](const auto& visit) {
    std::size_t v = 0;
    for (int z = 0; z < image.size[2]; ++z) {
      for (int y = 0; y < image.size[1]; ++y) {
        for (int x = 0; x < image.size[0]; ++x, ++v) {
          if (HasLabel(image.values[v], label)) visit(Index{x, y, z});
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
    problems.Add("", "no voxel has the label " + std::to_string(label), ExistingLabels(image));
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

bool IsImagePath(const std::filesystem::path& path) {
  std::error_code error;
  return IsVolumeName(path.filename().string()) || std::filesystem::is_directory(path, error);
}

std::optional<LabelSurface> ReadLabelSurface(const std::filesystem::path& path, int label, double smoothing,
                                             const std::stop_token& stop, Problems& problems) {
  VolumeReaderOptions reading;
  reading.stop = stop;
  const std::optional<VolumeImage> image = ReadVolumeFiles({path}, reading, problems);
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
  const Eigen::Affine3d place = PlaceOf(*image);
  for (Vec3& node : result.surface.nodes) node = place * node;
  result.surface_volume = EnclosedVolume(result.surface);
  if (result.surface_volume < 0) {
    for (Triangle& triangle : result.surface.triangles) std::swap(triangle[1], triangle[2]);
    result.surface_volume = -result.surface_volume;
  }
  result.voxel_volume = voxels * image->voxel_volume() * std::pow(kMillimetres, 3);
  result.notes = image->notes;
  if (const std::string note = NoteOnFractions(*image); !note.empty()) result.notes.push_back(note);
  return result;
}

}  // namespace fascicle::client
