#ifndef FASCICLE_TESTS_CORE_IMAGING_VOLUME_SAMPLES_H_
#define FASCICLE_TESTS_CORE_IMAGING_VOLUME_SAMPLES_H_

#include <Eigen/Geometry>

#include "core/imaging/volume_image.h"

namespace fascicle::testing {

// Different integers in all voxels, some negative; axes of different lengths and spacings, none along x, y or z.
inline VolumeImage ObliqueImage() {
  VolumeImage image;
  image.size = {7, 5, 4};
  image.spacing = {0.7e-3, 1.25e-3, 3e-3};
  image.origin = {-31.5e-3, 12e-3, 800e-3};
  image.direction = Eigen::AngleAxisd(0.5, Vec3(1, -2, 3).normalized()).toRotationMatrix();
  for (std::size_t v = 0; v < image.voxels(); ++v) image.values.push_back(static_cast<float>(v) * 3 - 100);
  return image;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CORE_IMAGING_VOLUME_SAMPLES_H_
