#ifndef FASCICLE_CORE_TET_POINTS_H_
#define FASCICLE_CORE_TET_POINTS_H_

#include <atomic>
#include <cmath>

#include "core/tet/forces.h"

// Functions shared by loops over elements and their quadrature points.
namespace fascicle {

// The values at the nodes of an element.
template <class Element>
std::array<Vec3, Element::kNodes> ValuesOf(const TetModel& model, std::size_t tet, const NodalVector& values) {
  const auto nodes = model.NodesOf<Element>(tet);
  std::array<Vec3, Element::kNodes> at;
  for (int a = 0; a < Element::kNodes; ++a) at[a] = values[nodes[a]];
  return at;
}

// Gradient of nodal values at point q with respect to rest position: F for positions, Fdot for velocities.
template <class Element>
Mat3 GradientAt(const TetModel& model, std::size_t tet, const std::array<Vec3, Element::kNodes>& values, int q) {
  return EdgeMatrix(Element::Corners(values, q)) * model.Dm_inverse()[Element::kPoints * tet + q];
}

// Rest gradients of an element's shape functions at point q, one column for each node [1/m].
template <class Element>
Eigen::Matrix<double, 3, Element::kNodes> ShapeGradients(const TetModel& model, std::size_t tet, int q) {
  Eigen::Matrix<double, 3, 4> g;
  g.rightCols<3>() = model.Dm_inverse()[Element::kPoints * tet + q].transpose();
  g.col(0) = -g.rightCols<3>().rowwise().sum();
  Eigen::Matrix<double, 3, Element::kNodes> gradients;
  for (int a = 0; a < Element::kNodes; ++a) {
    gradients.col(a).setZero();
    for (int c = 0; c < 4; ++c) gradients.col(a) += Element::CornerWeight(q, c, a) * g.col(c);
  }
  return gradients;
}

// The pressure of the patches at point q [Pa].
template <class Element>
double PatchPressure(const VolumePatches& patches, std::span<const double> pressure, std::size_t tet, int q) {
  if (patches.empty()) return 0;
  const VolumePatches::Corners& at = patches.of_element[tet];
  if (at[0] == VolumePatches::kNone) return 0;
  double sum = 0;
  for (int c = 0; c < Element::kPatches; ++c) sum += Element::PatchWeight(q, c) * pressure[at[c]];
  return sum;
}

// The fibre arguments of an element's law.
template <class Element>
FibreState FibreAt(const TetModel& model, std::size_t tet, const FibreDrive& drive, int q) {
  FibreState fibre{model.fibres()[tet], model.ActivationOf(tet, drive.activation)};
  if (drive.inverse_step != 0 && model.depends_on_rate()) {
    const Mat3 F = GradientAt<Element>(model, tet, ValuesOf<Element>(model, tet, *drive.previous), q);
    fibre.previous_stretch = (F * fibre.direction).norm() / std::cbrt(Determinant(F));
    fibre.inverse_step = drive.inverse_step;
  }
  return fibre;
}

// Atomic minimum, independent of the order of calls; NaN counts as less than any number.
inline void TakeLeast(std::atomic<double>& least, double value) {
  double now = least.load(std::memory_order_relaxed);
  while (!(value >= now) && !std::isnan(now) && !least.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
  }
}

// Least number of elements that a thread takes at a time.
inline constexpr std::size_t kElementGrain = 512;

// Calls visit(law, element) for every element of a group, in parallel.
template <class Visit>
void ForElementsOfGroup(const TetModel& model, const TetGroup& group, ThreadTeam& team, const Visit& visit) {
  std::visit(
      [&](const auto& laws) {
        team.For(group.tet_end - group.tet_begin, kElementGrain, [&](std::size_t begin, std::size_t end) {
          for (std::size_t e = group.tet_begin + begin; e < group.tet_begin + end; ++e) {
            visit(laws[model.law_of()[e]], e);
          }
        });
      },
      group.laws);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_POINTS_H_
