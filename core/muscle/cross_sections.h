#ifndef FASCICLE_CORE_MUSCLE_CROSS_SECTIONS_H_
#define FASCICLE_CORE_MUSCLE_CROSS_SECTIONS_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A muscle cut into slices along its harmonic potential: a middle line and coordinates across it.
class CrossSections {
 public:
  // `potential` has one value for each node, in [0, 1]. Returns nothing if the mesh is too short to be cut in two.
  static std::optional<CrossSections> Make(const TetMesh& mesh, const std::vector<double>& potential);

  // Length of the middle line up to a potential, normalized to 1 at potential 1.
  double Along(double potential) const;
  // Position of X across the middle line, in axes that do not twist about it, divided by the standard deviation of the
  // slice in each direction: an elliptic cross-section becomes a circle.
  Eigen::Vector2d Across(const Vec3& X, double potential) const;

 private:
  struct Slice {
    double potential;
    Vec3 center;                         // [m]
    Mat3 covariance;                     // [m^2]
    double length = 0;                   // of the middle line [m], from the first slice
    Eigen::Matrix<double, 2, 3> across;  // [1/m]
  };
  // A place between two slices or beyond the outermost ones.
  struct Place {
    std::size_t before;
    double fraction;
  };

  CrossSections() = default;
  void Cut(const TetMesh& mesh, const std::vector<double>& potential);
  void Smooth();
  void LayFrames();
  Place Find(double potential) const;
  double Length(double potential) const;

  std::vector<Slice> slices_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_CROSS_SECTIONS_H_
