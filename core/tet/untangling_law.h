#ifndef FASCICLE_CORE_TET_UNTANGLING_LAW_H_
#define FASCICLE_CORE_TET_UNTANGLING_LAW_H_

#include "core/materials/tensor_algebra.h"

namespace fascicle {

// An elastic energy that is finite for every F, inverted or flat, and drives F towards a rotation:
//   W = 1/2 (|F|^2 - 3) - (J - 1) + c/2 (J - 1)^2,
// the stable neo-Hookean energy without its barrier, with a shear modulus of one [Smith, de Goes & Kim 2018, 3]. It
// replaces the laws of all bodies until no element is inverted; the scale of the energy does not matter.
struct UntanglingLaw {
  static constexpr double kVolume = 4;  // c, for a Poisson's ratio of 0.4

  static double Energy(const Mat3& F) {
    const double change = DeterminantOf(F, Cofactor(F)) - 1;
    return 0.5 * (F.squaredNorm() - 3) - change + 0.5 * kVolume * change * change;
  }
  static Mat3 Stress(const Mat3& F) {
    const Mat3 cofactor = Cofactor(F);
    return F + (kVolume * (DeterminantOf(F, cofactor) - 1) - 1) * cofactor;
  }
  static Mat9 Tangent(const Mat3& F) {
    const Mat3 cofactor = Cofactor(F);
    const Vec9 h = Flatten(cofactor);
    Mat9 tangent = Mat9::Identity() + kVolume * h * h.transpose();
    AddCofactorTangent(kVolume * (DeterminantOf(F, cofactor) - 1) - 1, F, tangent);
    return tangent;
  }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_UNTANGLING_LAW_H_
