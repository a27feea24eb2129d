#ifndef FASCICLE_CORE_IMAGING_ARM_PHANTOM_H_
#define FASCICLE_CORE_IMAGING_ARM_PHANTOM_H_

#include <cstdint>
#include <vector>

#include "core/base/problems.h"
#include "core/imaging/volume_image.h"

namespace fascicle {

enum class ArmTissue : std::uint8_t {
  kAir = 0,
  kSkin = 1,
  kFat = 2,  // under the skin and between muscles
  kMuscle = 3,
  kAnconeus = 4,
  kBone = 5,  // cortical bone
  kMarrow = 6,
};

struct ArmPhantomSettings {
  double noise = 0.05;     // [0, 0.5]: standard deviation of the noise, relative to fat's value
  double bias = 0.1;       // [0, 0.5]: largest deviation of the coil's sensitivity from 1
  std::uint64_t seed = 1;  // of the noise

  bool operator==(const ArmPhantomSettings&) const = default;
};

struct ArmPhantom {
  VolumeImage image;             // fat has the value 1000
  std::vector<ArmTissue> truth;  // at the centre of each voxel
};

// A point inside of the anconeus [m], for use as a seed.
Vec3 ArmPhantomSeed();

// A section of an arm near the elbow as in a T1-weighted magnetic resonance image (fat and marrow bright, muscle
// medium, air and cortical bone dark), defined by formulas: skin, fat, humerus, muscles separated by septa of fat, and
// the anconeus, located as in [Zhu, Chen & Kaufman 1998]. 140 x 220 x 71 voxels. The paper does not state their size;
// cubes of 0.5 mm are chosen here, so that an anconeus of about as many voxels as the paper's (116,630) has 14.6 cm^3.
// A voxel with several tissues has their mean value. The noise is Rician; the same seed gives the same noise on every
// machine. Settings must be within their ranges.
ArmPhantom MakeArmPhantom(const ArmPhantomSettings& settings);

void CheckArmPhantom(const ArmPhantomSettings& settings, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ARM_PHANTOM_H_
