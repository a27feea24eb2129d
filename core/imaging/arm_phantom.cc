#include "core/imaging/arm_phantom.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace fascicle {
namespace {

// The anatomy, with lengths in millimetres: x to the side of the anconeus, y to the back, z along the arm.
constexpr GridIndex kSize = {140, 220, 71};
constexpr double kSpacing = 0.5;
constexpr double kMiddleHeight = 0.5 * kSpacing * 71;
constexpr int kSubdivisions = 2;  // of a voxel along each axis, to average tissues

// Values of tissues, by ArmTissue: T1-weighted, fat has 1000.
constexpr std::array<double, 7> kValue = {0, 480, 1000, 380, 380, 40, 900};

struct Point {
  double x, y, z;
};

// First-order signed distance from an ellipse around (x, y): exact on the ellipse, and everywhere for a circle.
double Ellipse(const Point& p, double x, double y, double half_x, double half_y) {
  const double u = (p.x - x) / half_x, v = (p.y - y) / half_y;
  const double k = std::hypot(u, v), slope = std::hypot(u / half_x, v / half_y);
  return slope == 0 ? -std::min(half_x, half_y) : k * (k - 1) / slope;
}

// Signed distance from the anconeus: an ellipsoid, bent to lie against the skin.
double Anconeus(const Point& p) {
  constexpr double kHalfX = 9.3, kHalfY = 22, kHalfZ = 17.2;
  const double v = (p.y - 60) / kHalfY, w = (p.z - kMiddleHeight) / kHalfZ;
  const double u = (p.x - (49 - 3.3 * v * v)) / kHalfX;
  const double k = std::sqrt(u * u + v * v + w * w);
  const double slope = std::hypot(u / kHalfX, v / kHalfY, w / kHalfZ);
  return slope == 0 ? -kHalfX : k * (k - 1) / slope;
}

// Distance from the nearest sheet of fat between muscles.
double Septum(const Point& p) {
  const double tilt = 0.1 * (p.z - kMiddleHeight);
  const double across = std::abs(p.y - 51 - 3 * std::sin(p.x / 9) - tilt);
  double nearest = across;
  // The septa between biceps and brachialis, and between the heads of the triceps.
  if (p.y < 50) nearest = std::min(nearest, std::abs(p.y - 27 - 0.008 * (p.x - 30) * (p.x - 30) + tilt));
  if (p.y > 52) nearest = std::min(nearest, std::abs(p.x - 30 - 4 * std::sin(p.y / 12) - tilt));
  return nearest;
}

ArmTissue TissueAt(const Point& p) {
  constexpr double kSkin = 1.5, kSheath = 2, kSheet = 0.8, kShell = 3;
  const double narrowing = 0.04 * (p.z - kMiddleHeight);
  const double skin = Ellipse(p, 35, 55, 32.5 - narrowing, 51.5 - narrowing);
  if (skin > 0) return ArmTissue::kAir;
  if (skin > -kSkin) return ArmTissue::kSkin;
  const double anconeus = Anconeus(p);
  if (anconeus <= 0) return ArmTissue::kAnconeus;
  const double humerus = Ellipse(p, 26, 52, 9.5, 9);
  if (humerus <= -kShell) return ArmTissue::kMarrow;
  if (humerus <= 0) return ArmTissue::kBone;
  // Subcutaneous fat is thickest at the back.
  const double fat = 4 + 1.5 * (p.y / 110);
  if (skin > -kSkin - fat || anconeus <= kSheath || Septum(p) < kSheet) return ArmTissue::kFat;
  return ArmTissue::kMuscle;
}

// Normally distributed numbers, computed from the engine's bits, which the C++ standard specifies. (It does not specify
// the results of std::normal_distribution.)
class NormalNumbers {
 public:
  explicit NormalNumbers(std::uint64_t seed) : engine_(seed) {}

  // Two independent numbers [Box and Muller 1958].
  std::array<double, 2> Next() {
    const double radius = std::sqrt(-2 * std::log(1 - Uniform())), angle = 2 * std::numbers::pi * Uniform();
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

 private:
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // in [0, 1)

  std::mt19937_64 engine_;
};

// Mean value of the tissues in the voxel around a centre.
double MeanValue(const Point& centre) {
  double sum = 0;
  for (int s = 0; s < kSubdivisions * kSubdivisions * kSubdivisions; ++s) {
    const auto off = [](int part) { return kSpacing * ((part + 0.5) / kSubdivisions - 0.5); };
    const Point p = {centre.x + off(s % kSubdivisions), centre.y + off(s / kSubdivisions % kSubdivisions),
                     centre.z + off(s / (kSubdivisions * kSubdivisions))};
    sum += kValue[static_cast<int>(TissueAt(p))];
  }
  return sum / (kSubdivisions * kSubdivisions * kSubdivisions);
}

// Sensitivity of the receiving coil: highest at one side of the arm, lowest at the other.
double Field(const Point& p, double bias) { return 1 + bias * std::cos(std::numbers::pi * (p.y - 10) / 110); }

}  // namespace

Vec3 ArmPhantomSeed() { return 1e-3 * Vec3(49, 60, kMiddleHeight); }

ArmPhantom MakeArmPhantom(const ArmPhantomSettings& settings) {
  ArmPhantom phantom;
  VolumeImage& image = phantom.image;
  image.size = kSize;
  image.spacing = Vec3::Constant(1e-3 * kSpacing);
  image.origin = 0.5 * image.spacing;
  image.values.reserve(image.voxels());
  phantom.truth.reserve(image.voxels());
  NormalNumbers normal(settings.seed);
  const double noise = settings.noise * kValue[static_cast<int>(ArmTissue::kFat)];
  for (std::int32_t k = 0; k < kSize[2]; ++k) {
    for (std::int32_t j = 0; j < kSize[1]; ++j) {
      for (std::int32_t i = 0; i < kSize[0]; ++i) {
        const Point p = {kSpacing * (i + 0.5), kSpacing * (j + 0.5), kSpacing * (k + 0.5)};
        const auto [real, imaginary] = normal.Next();
        // The magnitude of a complex signal has Rician noise [Gudbjartsson and Patz 1995].
        const double signal = MeanValue(p) * Field(p, settings.bias);
        image.values.push_back(static_cast<float>(std::hypot(signal + noise * real, noise * imaginary)));
        phantom.truth.push_back(TissueAt(p));
      }
    }
  }
  return phantom;
}

void CheckArmPhantom(const ArmPhantomSettings& settings, Problems& problems) {
  if (!(settings.noise >= 0 && settings.noise <= 0.5)) {
    problems.Add("noise", "must be 0 to 0.5", "0.05 of fat's value is what scans have");
  }
  if (!(settings.bias >= 0 && settings.bias <= 0.5)) problems.Add("bias", "must be 0 to 0.5", "0.1 is usual");
}

}  // namespace fascicle
