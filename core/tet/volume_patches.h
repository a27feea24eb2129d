#ifndef FASCICLE_CORE_TET_VOLUME_PATCHES_H_
#define FASCICLE_CORE_TET_VOLUME_PATCHES_H_

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace fascicle {

// Averages of the volume ratio, against volumetric locking.
//
// Of hexahedra: the mean over each element (mean dilatation), or a linear function of its coordinates, as four values
// (shape_functions.h). Of tetrahedra: nodal averages. Their patch is the dual
// region of a corner node among the elements of one group, weighted by the corner's barycentric coordinate L_n:
//   V_n = sum of the integrals of L_n over those elements at rest,   theta_n = (1/V_n) sum of the integrals of L_n J.
// Most of the volume energy of a nearly incompressible law acts on theta_n, U = k/2 (ln theta)^2, instead of each
// element's J: there are about six linear elements for each node, too many constraints for its three displacements.
// With quadratic elements the constraint theta_n = 1 is that of the Taylor-Hood element (continuous linear pressure
// with a lumped mass matrix), with linear elements that of the nodally averaged tetrahedron [Bonet & Burton 1998]. With
// the latter, pressures that alternate from node to node may cancel each other. So theta is averaged once more, from
// nodes to elements to nodes (the cyclic smoothing of [Onishi & Amaya 2017]). This operator W is self-adjoint in the
// inner product weighted by V. See README.md. Immutable once built.
struct VolumePatches {
  // The patch at each corner of a tetrahedron, or the Element::kPatches of a hexahedron in the first places; kNone in
  // elements that keep their whole volume energy.
  using Corners = std::array<std::int32_t, 4>;
  static constexpr std::int32_t kNone = -1;

  std::vector<Corners> of_element;
  std::vector<double> rest_volume;  // V_n [m^3]
  std::vector<double> modulus;      // k_n [Pa], volume average over the patch
  // Row n of W: weights weight[k] of patches neighbour[k], k in [row[n], row[n + 1]); empty if W = 1.
  std::vector<std::int32_t> row, neighbour;
  std::vector<double> weight;

  // out = W in; both have size() values and must not overlap.
  void Smooth(std::span<const double> in, std::span<double> out) const { SmoothRows(0, size(), in, out); }
  // The rows of patches [begin, end) only.
  void SmoothRows(std::size_t begin, std::size_t end, std::span<const double> in, std::span<double> out) const {
    for (std::size_t n = begin; n < end; ++n) out[n] = row.empty() ? in[n] : RowOf(n, in);
  }
  double RowOf(std::size_t n, std::span<const double> in) const {
    double sum = 0;
    for (std::int32_t k = row[n]; k < row[n + 1]; ++k) sum += weight[k] * in[neighbour[k]];
    return sum;
  }

  std::size_t size() const { return rest_volume.size(); }
  bool empty() const { return rest_volume.empty(); }
};

// U = k/2 (ln theta)^2 for one patch of modulus k; not finite where theta <= 0.
struct PatchEnergy {
  double k;  // [Pa]

  double Value(double theta) const {
    const double log_theta = std::log(theta);
    return 0.5 * k * log_theta * log_theta;
  }
  double Pressure(double theta) const { return k * std::log(theta) / theta; }
  double Slope(double theta) const { return k * (1 - std::log(theta)) / (theta * theta); }
  // U'' where the energy is convex, up to theta = e; clamped to a safe positive value before that.
  double ConvexSlope(double theta) const { return Slope(theta < 2 ? theta : 2); }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_VOLUME_PATCHES_H_
