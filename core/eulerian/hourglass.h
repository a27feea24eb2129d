#ifndef FASCICLE_CORE_EULERIAN_HOURGLASS_H_
#define FASCICLE_CORE_EULERIAN_HOURGLASS_H_

namespace fascicle {

// Hourglass modes: the four modes of the corners of a cell, yz, zx, xy and xyz, for which the gradient at its centre is
// zero. Each has a stiffness [Flanagan & Belytschko 1981, A uniform strain hexahedron and quadrilateral with orthogonal
// hourglass control, Int. J. Numer. Methods Eng. 17].
inline constexpr int kHourglassModes = 4;

// The value of a mode at corner c: +1 or -1.
inline int HourglassSign(int mode, int c) {
  const int x = (c & 1) != 0 ? 1 : -1, y = (c & 2) != 0 ? 1 : -1, z = (c & 4) != 0 ? 1 : -1;
  return mode == 0 ? y * z : mode == 1 ? z * x : mode == 2 ? x * y : x * y * z;
}

// k [N/m] of a mode's energy 1/2 k |g|^2, g = 1/8 sum of +-X over the corners, in a cell with the given spacing [m] and
// solid volume [m^3]: a tenth of the shear modulus [Pa] for a mode as steep as a strain.
inline double HourglassStiffness(double shear_modulus, double volume, double spacing) {
  constexpr double kPart = 0.1;
  return kPart * shear_modulus * volume * 4 / (spacing * spacing);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_HOURGLASS_H_
