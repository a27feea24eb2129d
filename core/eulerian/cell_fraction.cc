#include "core/eulerian/cell_fraction.h"

#include <algorithm>

namespace fascicle {
namespace {

constexpr int kTets[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};

// How much of an edge from a, negative, to b, not negative, is negative.
double Along(double a, double b) { return a / (a - b); }

// Of a tetrahedron, corners by rising values.
double OfTetrahedron(std::array<double, 4> phi) {
  std::sort(phi.begin(), phi.end());
  const auto [a, b, c, d] = phi;
  if (a >= 0) return 0;
  if (d < 0) return 1;
  if (b >= 0) return Along(a, b) * Along(a, c) * Along(a, d);
  if (c < 0) return 1 - Along(-d, -a) * Along(-d, -b) * Along(-d, -c);
  // A prism between the edges of two corners, as three tetrahedra.
  const double ac = Along(a, c), ad = Along(a, d), bc = Along(b, c), bd = Along(b, d);
  return ac * ad * (1 - bd) + ac * bd * (1 - bc) + bc * bd;
}

}  // namespace

double NegativeFraction(const std::array<double, 8>& phi) {
  double sum = 0;
  for (const auto& tet : kTets) sum += OfTetrahedron({phi[tet[0]], phi[tet[1]], phi[tet[2]], phi[tet[3]]});
  return sum / 6;
}

}  // namespace fascicle
