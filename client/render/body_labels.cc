#include "client/render/body_labels.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkResampleToImage.h>

#include <algorithm>
#include <cmath>

#include "client/render/body_mesh.h"
#include "client/vtk/body_grid.h"

namespace fascicle::client {

void AddLabels(const BodyShape& shape, const std::vector<Vec3>& positions, const ImagePlace& place, std::uint8_t label,
               std::vector<std::uint8_t>& labels) {
  // In voxel units, so that the samples are those of the image; only within the body's bounding box.
  std::vector<Vec3> in_voxels;
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const Vec3& x : positions) {
    const Vec3 at = (place.direction.transpose() * (x - place.origin)).cwiseQuotient(place.spacing);
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
    in_voxels.push_back(at);
  }
  std::array<int, 3> first, dimensions;
  std::array<double, 6> bounds;
  for (int d = 0; d < 3; ++d) {
    first[d] = std::max(0, static_cast<int>(std::ceil(low[d])));
    const int last = std::min(place.size[d] - 1, static_cast<int>(std::floor(high[d])));
    dimensions[d] = last - first[d] + 1;
    if (dimensions[d] < 1) return;
    bounds[2 * d] = first[d];
    // A single sample still needs a width.
    bounds[2 * d + 1] = std::max(last, first[d] + 1);
    dimensions[d] = std::max(2, dimensions[d]);
  }
  vtkNew<vtkResampleToImage> resample;
  resample->SetInputDataObject(MakeLinearGrid(shape, in_voxels));
  resample->UseInputBoundsOff();
  resample->SetSamplingBounds(bounds.data());
  resample->SetSamplingDimensions(dimensions.data());
  resample->Update();
  vtkDataArray& inside = *resample->GetOutput()->GetPointData()->GetArray("vtkValidPointMask");
  vtkIdType sample = 0;
  for (int k = 0; k < dimensions[2]; ++k) {
    for (int j = 0; j < dimensions[1]; ++j) {
      for (int i = 0; i < dimensions[0]; ++i, ++sample) {
        const int at[] = {first[0] + i, first[1] + j, first[2] + k};
        if (inside.GetTuple1(sample) == 0) continue;
        if (at[0] >= place.size[0] || at[1] >= place.size[1] || at[2] >= place.size[2]) continue;
        labels[static_cast<std::size_t>(
            at[0] + place.size[0] * (at[1] + static_cast<std::int64_t>(place.size[1]) * at[2]))] = label;
      }
    }
  }
}

}  // namespace fascicle::client
