#include "core/tet/fields.h"

#include <array>

#include "core/scene/output_fields.h"
#include "core/tet/points.h"

namespace fascicle {
namespace {

std::vector<double> AtNodes(const TetBody& body, OutputField field, const NodalVector& v) {
  const std::size_t components = InfoOf(field).components;
  std::vector<double> values(components * (body.mesh_node_end - body.node_begin));
  for (std::size_t n = body.node_begin; n < body.mesh_node_end; ++n) {
    MaterialPoint point;
    point.v = v[n];
    PutField(field, point, &values[components * (n - body.node_begin)]);
  }
  return values;
}

// Values of the elements of a body, in the order of its mesh, averaged over the points of each.
template <bool kStress>
std::vector<double> OverElements(const TetModel& model, std::size_t body_index, OutputField field,
                                 const FibreDrive& drive, const NodalVector& x, ThreadTeam& team) {
  const TetBody& body = model.bodies()[body_index];
  const std::size_t components = InfoOf(field).components;
  std::vector<double> values(components * (body.tet_end - body.tet_begin));
  ForceWorkspace workspace;
  if (kStress) UpdatePatches(model, x, team, workspace);
  model.VisitElement([&]<class Element>(Element) {
    for (const TetGroup& group : model.groups()) {
      if (group.body != body_index) continue;
      ForElementsOfGroup(model, group, team, [&](const auto& law, std::size_t e) {
        const auto positions = ValuesOf<Element>(model, e, x);
        double* const of_element = &values[components * static_cast<std::size_t>(model.source_tetrahedron()[e])];
        for (int q = 0; q < Element::kPoints; ++q) {
          MaterialPoint point;
          point.F = GradientAt<Element>(model, e, positions, q);
          point.J = Determinant(point.F);
          point.a0 = model.fibres()[e];
          if constexpr (kStress) {
            const Mat3 P = law.Stress(point.F, FibreAt<Element>(model, e, drive, q));
            const double pressure = PatchPressure<Element>(model.patches(), workspace.pressure, e, q);
            point.sigma = P * point.F.transpose() / point.J + pressure * Mat3::Identity();
          }
          std::array<double, kMostComponents> at_point;
          PutField(field, point, at_point.data());
          for (std::size_t c = 0; c < components; ++c) of_element[c] += Element::kPointWeight * at_point[c];
        }
      });
    }
  });
  return values;
}

}  // namespace

std::vector<double> FieldValuesOf(const TetModel& model, std::size_t body, OutputField field, const FibreDrive& drive,
                                  const TetState& state, ThreadTeam& team) {
  const NodalVector& x = state.positions;
  std::vector<double> values;
  switch (InfoOf(field).from) {
    case FieldSource::kMotion:
      values = AtNodes(model.bodies()[body], field, state.velocities);
      break;
    case FieldSource::kDeformation:
      values = OverElements<false>(model, body, field, drive, x, team);
      break;
    case FieldSource::kStress:
      values = OverElements<true>(model, body, field, drive, x, team);
      break;
  }
  if (InfoOf(field).is_direction) NormalizeDirections(values);
  return values;
}

}  // namespace fascicle
