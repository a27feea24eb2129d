#ifndef FASCICLE_CORE_TET_POSITION_LOADS_H_
#define FASCICLE_CORE_TET_POSITION_LOADS_H_

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/linalg/nodal_vector.h"
#include "core/scene/method.h"

namespace fascicle {

class TetModel;

// Loads whose forces depend on the positions:
//   pressure   f_a = -p times the integral of N_a (x,1 x x,2) over the deformed faces [Bonet & Wood 2008, 8.5]
//   springs    f_a = -sum over b of k_ab (x_b - X_b)
//   line       f_a = +- w_a k (L - L_0) e, between two means of positions sum w_a x_a at a distance L along e
// All are multiplied by the scale of their load.

// A face of the surface: three corners and, for quadratic elements, the nodes between corners 0 and 1, 1 and 2, 2 and
// 0; of hexahedra, four corners and, for those of 27 nodes, the nodes between corners 0 and 1 and so on, then that in
// the middle. Counter-clockwise seen from outside.
struct PressureFace {
  std::array<std::int32_t, 9> nodes = {};
};
// The area of a face at rest that belongs to each of its nodes: the integrals of its shape functions [m^2].
std::vector<double> SharesOf(ElementOrder order, const PressureFace& face, const NodalVector& X);
struct PressureLoad {
  std::size_t load = 0;  // index into TetModel::loads(), for its scale
  double pressure = 0;   // at scale 1 [Pa]
  std::vector<PressureFace> faces;
};
// A component k_ab of the stiffness of springs.
struct SpringEntry {
  std::int32_t row = 0, column = 0;  // nodes a and b
  Vec3 stiffness = Vec3::Zero();     // along x, y, z, at scale 1 [N/m]
};
struct SpringLoad {
  std::size_t load = 0;
  double largest_scale = 0;          // at any time
  std::vector<SpringEntry> entries;  // several may have the same place
};
// The entries of springs in equal parts of the area at rest: k_ab = k/A times the integral of N_a N_b. In equal parts
// on nodes, they would pull the corners out of the plane, since corners of quadratic faces have no part of a constant
// traction.
//   X  rest positions [m];  stiffness  k along x, y, z [N/m]
std::vector<SpringEntry> SpringsOnFaces(ElementOrder order, std::span<const PressureFace> faces, const NodalVector& X,
                                        const Vec3& stiffness);
// A mean of positions: the sum of weights times positions. Weights add up to 1.
struct MeanPosition {
  std::vector<std::int32_t> nodes;
  std::vector<double> weights;  // positive
};
double DistanceBetween(const MeanPosition& a, const MeanPosition& b, const NodalVector& x);

struct LineSpringLoad {
  std::size_t load = 0;
  std::array<MeanPosition, 2> ends;
  double stiffness = 0, rest_length = 0;  // [N/m], [m]
  bool tension_only = false;
  double largest_scale = 0;
};
struct PositionLoads {
  std::vector<PressureLoad> pressures;
  std::vector<SpringLoad> springs;
  std::vector<LineSpringLoad> line_springs;

  bool empty() const { return pressures.empty() && springs.empty() && line_springs.empty(); }
};

// Adds the forces of all such loads to every node [N].
//   load_scales  Controls::load_scales
void AddPositionLoads(const TetModel& model, std::span<const double> load_scales, const NodalVector& x,
                      NodalVector& force);

// Their expansion to the first order about positions c: f(x) = f(c) - S (x - c), with the symmetric part S of -df/dx.
// A pressure on a surface that is closed, or held at its rim, has a potential, so its -df/dx is symmetric.
struct LoadExpansion {
  struct Entry {
    std::int32_t row = 0, column = 0;  // nodes
    Mat3 block = Mat3::Zero();         // [N/m]
  };
  NodalVector centre;            // c [m]
  std::vector<Entry> stiffness;  // S; several entries may have the same place
  // product = S (x - c).
  void Multiply(const NodalVector& x, NodalVector& product) const;
};
LoadExpansion ExpandPositionLoads(const TetModel& model, std::span<const double> load_scales, const NodalVector& c);

// The nodes that a line spring couples with each other.
std::vector<std::int32_t> NodesOf(const LineSpringLoad& load);

// product += K p for the springs at their largest scale: an upper bound for the stable step.
void AddSpringStiffness(const TetModel& model, const NodalVector& p, NodalVector& product);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_POSITION_LOADS_H_
