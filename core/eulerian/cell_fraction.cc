#include "core/eulerian/cell_fraction.h"

#include <algorithm>

namespace fascicle {
namespace {

// The six tetrahedra around the diagonal from corner 0 to corner 7.
constexpr int kTets[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};

// The negative part of an edge from a (negative) to b (non-negative).
double Along(double a, double b) { return a / (a - b); }

// The negative part of a tetrahedron with values phi at its corners.
double OfTetrahedron(std::array<double, 4> phi) {
  std::sort(phi.begin(), phi.end());
  const auto [a, b, c, d] = phi;
  if (a >= 0) return 0;
  if (d < 0) return 1;
  if (b >= 0) return Along(a, b) * Along(a, c) * Along(a, d);
  if (c < 0) return 1 - Along(-d, -a) * Along(-d, -b) * Along(-d, -c);
  // A prism between the edges of two corners, divided into three tetrahedra.
  const double ac = Along(a, c), ad = Along(a, d), bc = Along(b, c), bd = Along(b, d);
  return ac * ad * (1 - bd) + ac * bd * (1 - bc) + bc * bd;
}

}  // namespace

double NegativeFraction(const std::array<double, 8>& phi) {
  const bool any_in = std::any_of(phi.begin(), phi.end(), [](double value) { return value < 0; });
  const bool all_in = std::all_of(phi.begin(), phi.end(), [](double value) { return value < 0; });
  if (all_in || !any_in) return all_in ? 1 : 0;
  // Replacing corner c by c ^ d maps the other diagonals to this one; the average is unbiased.
  double sum = 0;
  for (int d = 0; d < 4; ++d) {
    for (const auto& tet : kTets) {
      sum += OfTetrahedron({phi[tet[0] ^ d], phi[tet[1] ^ d], phi[tet[2] ^ d], phi[tet[3] ^ d]});
    }
  }
  return sum / 24;
}

}  // namespace fascicle
