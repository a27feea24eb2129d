#include "core/tet/fields.h"

#include <cmath>

#include "core/base/von_mises.h"
#include "core/tet/points.h"

namespace fascicle {
namespace {

std::vector<double> Velocities(const TetBody& body, const NodalVector& v) {
  std::vector<double> values;
  values.reserve(3 * (body.mesh_node_end - body.node_begin));
  for (std::size_t n = body.node_begin; n < body.mesh_node_end; ++n)
    values.insert(values.end(), v[n].begin(), v[n].end());
  return values;
}

// The state at one point of an element, from which fields are computed.
struct PointState {
  Mat3 F;
  double J;
  Vec3 fibre;  // a0
  Mat3 sigma;  // P F^T / J [Pa]; only if stress is requested
};

// Calls add(PointState, values) for every point of every element of a body, in the order of the body's mesh. The values
// of an element are averaged over its points.
template <bool kStress, class Add>
std::vector<double> OverElements(const TetModel& model, std::size_t body_index, int components, const FibreDrive& drive,
                                 const NodalVector& x, ThreadTeam& team, const Add& add) {
  const TetBody& body = model.bodies()[body_index];
  std::vector<double> values(static_cast<std::size_t>(components) * (body.tet_end - body.tet_begin));
  ForceWorkspace workspace;
  if (kStress) UpdatePatches(model, x, team, workspace);
  model.VisitElement([&]<class Element>(Element) {
    for (const TetGroup& group : model.groups()) {
      if (group.body != body_index) continue;
      ForElementsOfGroup(model, group, team, [&](const auto& law, std::size_t e) {
        const auto positions = ValuesOf<Element>(model, e, x);
        double* const value = &values[components * model.source_tetrahedron()[e]];
        for (int q = 0; q < Element::kPoints; ++q) {
          PointState point;
          point.F = GradientAt<Element>(model, e, positions, q);
          point.J = Determinant(point.F);
          point.fibre = model.fibres()[e];
          if constexpr (kStress) {
            const Mat3 P = law.Stress(point.F, FibreAt<Element>(model, e, drive, q));
            const double pressure = PatchPressure<Element>(model.patches(), workspace.pressure, e, q);
            point.sigma = P * point.F.transpose() / point.J + pressure * Mat3::Identity();
          }
          add(point, Element::kPointWeight, value);
        }
      });
    }
  });
  return values;
}

int ComponentsOf(OutputField field) {
  switch (field) {
    case OutputField::kVelocity:
    case OutputField::kFibreDirection:
      return 3;
    case OutputField::kCauchyStress:
      return 6;
    default:
      return 1;
  }
}

}  // namespace

std::vector<double> FieldValuesOf(const TetModel& model, std::size_t body, OutputField field, const FibreDrive& drive,
                                  const TetState& state, ThreadTeam& team) {
  const NodalVector& x = state.positions;
  const int components = ComponentsOf(field);
  const auto of_stress = [&](const auto& add) {
    return OverElements<true>(model, body, components, drive, x, team, add);
  };
  const auto of_deformation = [&](const auto& add) {
    return OverElements<false>(model, body, components, drive, x, team, add);
  };
  switch (field) {
    case OutputField::kVelocity:
      return Velocities(model.bodies()[body], state.velocities);
    case OutputField::kCauchyStress:
      return of_stress([](const PointState& at, double weight, double* value) {
        const Mat3& s = at.sigma;
        const double six[] = {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
        for (int c = 0; c < 6; ++c) value[c] += weight * six[c];
      });
    case OutputField::kVonMisesStress:
      return of_stress(
          [](const PointState& at, double weight, double* value) { *value += weight * VonMises(at.sigma); });
    case OutputField::kPressure:
      return of_stress(
          [](const PointState& at, double weight, double* value) { *value += weight * at.sigma.trace() / 3; });
    case OutputField::kVolumeRatio:
      return of_deformation([](const PointState& at, double weight, double* value) { *value += weight * at.J; });
    case OutputField::kFibreStretch:
      return of_deformation(
          [](const PointState& at, double weight, double* value) { *value += weight * (at.F * at.fibre).norm(); });
    case OutputField::kFibreDirection: {
      std::vector<double> directions = of_deformation([](const PointState& at, double weight, double* value) {
        const Vec3 a = at.F * at.fibre;
        for (int c = 0; c < 3; ++c) value[c] += weight * a[c];
      });
      for (std::size_t i = 0; i < directions.size(); i += 3) {
        Eigen::Map<Vec3> direction(&directions[i]);
        if (direction.squaredNorm() > 0) direction.normalize();
      }
      return directions;
    }
  }
  return {};
}

}  // namespace fascicle
