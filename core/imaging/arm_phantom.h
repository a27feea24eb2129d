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
  kBone = 5,  // the hard shell
  kMarrow = 6,
};

struct ArmPhantomSettings {
  double noise = 0.05;     // [0, 0.5]: standard deviation of the noise, of fat's value
  double bias = 0.1;       // [0, 0.5]: how far the receiving coil's field departs from 1 at most
  std::uint64_t seed = 1;  // of the noise

  bool operator==(const ArmPhantomSettings&) const = default;
};

struct ArmPhantom {
  VolumeImage image;             // fat has value 1000
  std::vector<ArmTissue> truth;  // of the centre of each voxel
};

// Where a point of the anconeus is for sure [m]: a seed.
Vec3 ArmPhantomSeed();

// A section of an arm near the elbow as magnetic resonance shows it (T1: fat and marrow bright, muscle between, air and
// hard bone dark), made of formulas: skin, fat, humerus, muscles parted by sheets of fat, and the anconeus, whose place
// is that of [Zhu, Chen & Kaufman 1998]: 140 x 220 x 71 voxels. They give no size of voxels; ours are cubes of 0.5 mm,
// so that an anconeus of about as many voxels as theirs (116,630) has 14.6 cm^3. Voxels that tissues share have their
// mean; the noise is Rician, and the same for the same seed everywhere. Settings must be in their ranges.
ArmPhantom MakeArmPhantom(const ArmPhantomSettings& settings);

void CheckArmPhantom(const ArmPhantomSettings& settings, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ARM_PHANTOM_H_
