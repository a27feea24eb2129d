#include "core/tet/fields.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>

#include "core/scene/probe_place.h"
#include "core/tet/branches.h"
#include "core/tet/diagnostics.h"
#include "core/tet/points.h"

namespace fascicle {
namespace {

// What elements need besides the positions.
struct FieldInputs {
  const TetModel& model;
  const NodalVector& x;
  FibreDrive drive;
  Vec3 line_of_action;
  ForceWorkspace patches;
  BranchDrive branches;  // at the state

  FieldInputs(const TetModel& m, FieldSource from, const TetState& state, const Controls& now, ThreadTeam& team)
      : model(m),
        x(state.positions),
        drive(now.activations),
        line_of_action(m.scene().output.line_of_action.value_or(Vec3::UnitX())) {
    if (from != FieldSource::kDeformation) UpdatePatches(model, x, team, patches);
    if (model.branch_points() > 0) SetStateDrive(model, state.branches, team, branches);
  }
};

bool HasBranches(const FieldInputs& inputs) { return inputs.model.branch_points() > 0; }

// The weights of an element's patches at a point of it (Element::kPatches).
using PatchWeights = std::array<double, 4>;

// The elastic energy of the patches per volume of an element [J/m^3].
template <class Element>
double PatchEnergyDensity(const FieldInputs& inputs, std::size_t e, const PatchWeights& L) {
  const VolumePatches& patches = inputs.model.patches();
  if (patches.empty() || patches.of_element[e][0] == VolumePatches::kNone) return 0;
  double sum = 0;
  for (int c = 0; c < Element::kPatches; ++c) {
    const std::int32_t n = patches.of_element[e][c];
    sum += L[c] * PatchEnergy{patches.modulus[n]}.Value(inputs.patches.ratio[n]);
  }
  return sum;
}

// The pressure of the patches there [Pa].
template <class Element>
double PressureAt(const FieldInputs& inputs, std::size_t e, const PatchWeights& L) {
  const VolumePatches& patches = inputs.model.patches();
  if (patches.empty() || patches.of_element[e][0] == VolumePatches::kNone) return 0;
  double sum = 0;
  for (int c = 0; c < Element::kPatches; ++c) sum += L[c] * inputs.patches.pressure[patches.of_element[e][c]];
  return sum;
}

// A point of an element, from its deformation gradient. branch_stress: that of Maxwell branches there [Pa].
template <class Element, FieldSource kFrom, class Law>
MaterialPoint PointOf(const FieldInputs& inputs, const Law& law, std::size_t e, const Mat3& F, const PatchWeights& L,
                      const Mat3& branch_stress) {
  MaterialPoint point;
  point.F = F;
  point.J = Determinant(F);
  point.a0 = inputs.model.fibres()[e];
  const double prestretch = inputs.model.PrestretchOf(e);
  if (prestretch != 1) point.a0 /= prestretch;
  point.line_of_action = inputs.line_of_action;
  if constexpr (kFrom == FieldSource::kStress || kFrom == FieldSource::kFibreStress) {
    FibreState fibre = FibreAt<Element>(inputs.model, e, inputs.drive, 0);
    const double pressure = PressureAt<Element>(inputs, e, L);
    const Mat3 P = law.Stress(F, fibre) + F * branch_stress;
    point.sigma = P * F.transpose() / point.J + pressure * Mat3::Identity();
    if constexpr (kFrom == FieldSource::kFibreStress) {
      fibre.activation = 0;
      const Mat3 passive = law.Stress(F, fibre) + F * branch_stress;
      point.passive_sigma = passive * F.transpose() / point.J + pressure * Mat3::Identity();
    }
  }
  if constexpr (kFrom == FieldSource::kEnergy) {
    point.energy_density =
        law.Energy(F, FibreAt<Element>(inputs.model, e, inputs.drive, 0)) + PatchEnergyDensity<Element>(inputs, e, L);
  }
  return point;
}

template <class Element>
PatchWeights WeightsAtPoint(int q) {
  PatchWeights weights = {};
  for (int c = 0; c < Element::kPatches; ++c) weights[c] = Element::PatchWeight(q, c);
  return weights;
}

// Calls call.operator()<source>() with a source of elements' fields as a constant.
template <class Call>
decltype(auto) WithSource(FieldSource from, const Call& call) {
  if (from == FieldSource::kStress) return call.template operator()<FieldSource::kStress>();
  if (from == FieldSource::kFibreStress) return call.template operator()<FieldSource::kFibreStress>();
  if (from == FieldSource::kEnergy) return call.template operator()<FieldSource::kEnergy>();
  return call.template operator()<FieldSource::kDeformation>();
}

// The part of a point in the average over its element: in hexahedra, whose points have different volumes, by volume.
template <class Element>
double PartOfPoint(const TetModel& model, std::size_t e, int q) {
  if constexpr (!Element::kIsHexahedron) return Element::PointWeight(q);
  double whole = 0;
  for (int p = 0; p < Element::kPoints; ++p) whole += model.rest_volume()[Element::kPoints * e + p];
  return model.rest_volume()[Element::kPoints * e + q] / whole;
}

// Averages over the points of each element of a body, in the order of its mesh.
template <FieldSource kFrom>
std::vector<double> OverElements(const FieldInputs& inputs, std::size_t body_index, OutputField field,
                                 ThreadTeam& team) {
  const TetModel& model = inputs.model;
  const TetBody& body = model.bodies()[body_index];
  const std::size_t components = InfoOf(field).components;
  std::vector<double> values(components * (body.tet_end - body.tet_begin));
  model.VisitElement([&]<class Element>(Element) {
    for (const TetGroup& group : model.groups()) {
      if (group.body != body_index) continue;
      ForElementsOfGroup(model, group, team, [&](const auto& law, std::size_t e) {
        const auto positions = ValuesOf<Element>(model, e, inputs.x);
        double* const of_element = &values[components * static_cast<std::size_t>(model.source_element()[e])];
        for (int q = 0; q < Element::kPoints; ++q) {
          const double part = PartOfPoint<Element>(model, e, q);
          const Mat3 F = GradientAt<Element>(model, e, positions, q);
          const Mat3 branches = HasBranches(inputs) ? BranchStressAt(model, inputs.branches, e, q) : Mat3(Mat3::Zero());
          const MaterialPoint point = PointOf<Element, kFrom>(inputs, law, e, F, WeightsAtPoint<Element>(q), branches);
          std::array<double, kMostComponents> at_point;
          PutField(field, point, at_point.data());
          for (std::size_t c = 0; c < components; ++c) of_element[c] += part * at_point[c];
        }
      });
    }
  });
  return values;
}

// The fields of tuples of averages.
std::vector<double> FromMeans(OutputField field, const std::vector<double>& means) {
  const std::size_t components = InfoOf(field).components, of_mean = InfoOf(InfoOf(field).mean_of).components;
  std::vector<double> values(means.size() / of_mean * components);
  for (std::size_t i = 0; i * of_mean < means.size(); ++i) {
    PutFromMean(field, &means[of_mean * i], &values[components * i]);
  }
  return values;
}

// Forces on the mesh's nodes, indexed as the model's; those of higher nodes are shared equally by the corners between
// which they lie.
NodalVector OnMeshNodes(const TetModel& model, const TetBody& body, const NodalVector& forces) {
  NodalVector lumped = forces;
  model.ForHigherNodes(body, [&](std::int32_t node, std::span<const std::int32_t> corners) {
    const double part = 1.0 / static_cast<double>(corners.size());
    for (const std::int32_t corner : corners) lumped[corner] += part * forces[node];
  });
  return lumped;
}

// The forces on all nodes: of elements or of supports.
NodalVector NodalForceOf(const TetModel& model, OutputField field, const TetState& state, const StateControls& controls,
                         ThreadTeam& team) {
  if (field == OutputField::kReactionForce) return ReactionForces(model, state, controls.now, controls.later, team);
  ForceWorkspace workspace;
  NodalVector forces;
  FibreDrive drive{controls.now.activations};
  BranchDrive branches;
  if (model.branch_points() > 0) {
    SetStateDrive(model, state.branches, team, branches);
    drive.branches = &branches;
  }
  ElasticForce(model, drive, state.positions, team, workspace, forces);
  return forces;
}

std::vector<double> AtNodes(const NodalVector& vectors, std::size_t begin, std::size_t end) {
  std::vector<double> values;
  values.reserve(3 * (end - begin));
  for (std::size_t n = begin; n < end; ++n) values.insert(values.end(), vectors[n].begin(), vectors[n].end());
  return values;
}

// The element of a probe: its index in the model, and the coordinates in it: barycentric ones of a tetrahedron, three
// from 0 to 1 of a hexahedron.
struct TetPlace {
  std::size_t element = 0;
  std::array<double, 4> L = {};
  Vec3 within = Vec3::Zero();
};

TetPlace PlaceIn(const TetModel& model, const Probe& probe) {
  const TetBody& body = model.bodies()[probe.body];
  const ProbePlace place = PlaceOf(probe, body.source->shape);
  TetPlace result = {body.tet_begin, {}, place.coordinates};
  while (model.source_element()[result.element] != place.element) ++result.element;
  const Vec3& c = place.coordinates;
  result.L = {1 - c.sum(), c[0], c[1], c[2]};
  return result;
}

// The value of nodal values at a place.
template <class Element>
Vec3 ValueAt(const TetModel& model, const TetPlace& place, const NodalVector& values) {
  const auto at = ValuesOf<Element>(model, place.element, values);
  if constexpr (Element::kNodes == 8) {
    return TrilinearValue(at, place.within);
  } else if constexpr (Element::kNodes == 27) {
    return TriquadraticValue(at, place.within);
  } else {
    const auto& L = place.L;
    Vec3 sum = Vec3::Zero();
    for (int c = 0; c < 4; ++c) sum += (Element::kNodes == 4 ? L[c] : L[c] * (2 * L[c] - 1)) * at[c];
    if constexpr (Element::kNodes == 10) {
      for (std::size_t k = 0; k < kTetEdges.size(); ++k) sum += 4 * L[kTetEdges[k][0]] * L[kTetEdges[k][1]] * at[4 + k];
    }
    return sum;
  }
}

// The same at a probe, which may be a node.
Vec3 ValueAt(const TetModel& model, const Probe& probe, const NodalVector& values) {
  if (!probe.inside) return values[model.bodies()[probe.body].node_begin + static_cast<std::size_t>(probe.node)];
  const TetPlace place = PlaceIn(model, probe);
  return model.VisitElement([&]<class Element>(Element) { return ValueAt<Element>(model, place, values); });
}

template <class Element>
Mat3 EdgesAt(const TetModel& model, const TetPlace& place, const NodalVector& values) {
  const auto at = ValuesOf<Element>(model, place.element, values);
  if constexpr (Element::kNodes == 4) {
    return EdgeMatrix(at);
  } else if constexpr (Element::kNodes == 8) {
    return TrilinearSlopes(at, place.within);
  } else if constexpr (Element::kNodes == 27) {
    return TriquadraticSlopes(at, place.within);
  } else {
    return EdgeMatrix(CornersAt(at, place.L));
  }
}

template <class Element>
PatchWeights PatchWeightsAt(const TetPlace& place) {
  if constexpr (!Element::kIsHexahedron) return place.L;
  if constexpr (Element::kPatches == 1) return {1};
  PatchWeights weights;
  for (int c = 0; c < 4; ++c) {
    weights[static_cast<std::size_t>(c)] = LinearPart(c, place.within[0], place.within[1], place.within[2]);
  }
  return weights;
}

template <FieldSource kFrom>
std::vector<double> AtPlace(const FieldInputs& inputs, const TetPlace& place, OutputField field) {
  const TetModel& model = inputs.model;
  std::vector<double> values(InfoOf(field).components);
  const std::size_t e = place.element;
  const auto group = std::find_if(model.groups().begin(), model.groups().end(),
                                  [e](const TetGroup& g) { return e >= g.tet_begin && e < g.tet_end; });
  model.VisitElement([&]<class Element>(Element) {
    const Mat3 F =
        EdgesAt<Element>(model, place, inputs.x) * EdgesAt<Element>(model, place, model.rest_positions()).inverse();
    std::visit(
        [&](const auto& laws) {
          const Mat3 branches = HasBranches(inputs) ? MeanBranchStress(model, inputs.branches, e) : Mat3(Mat3::Zero());
          const auto& law = laws[model.law_of()[e]];
          PutField(field, PointOf<Element, kFrom>(inputs, law, e, F, PatchWeightsAt<Element>(place), branches),
                   values.data());
        },
        group->laws);
  });
  if (InfoOf(field).is_direction) NormalizeDirections(values);
  return values;
}

}  // namespace

std::vector<double> FieldValuesOf(const TetModel& model, std::size_t body_index, OutputField field,
                                  const TetState& state, const StateControls& controls, ThreadTeam& team) {
  const FieldSource from = InfoOf(field).from;
  if (IsNodal(InfoOf(field))) return NodeFieldOf(model, body_index, field, state, controls, team).on_mesh;
  const FieldInputs inputs(model, from, state, controls.now, team);
  return WithSource(from, [&]<FieldSource kFrom>() {
    return FromMeans(field, OverElements<kFrom>(inputs, body_index, InfoOf(field).mean_of, team));
  });
}

NodeFieldValues NodeFieldOf(const TetModel& model, std::size_t body_index, OutputField field, const TetState& state,
                            const StateControls& controls, ThreadTeam& team) {
  const TetBody& body = model.bodies()[body_index];
  const bool has_more = body.node_end > body.mesh_node_end;
  const auto values_of = [&](const NodalVector& on_mesh, const NodalVector& on_nodes) {
    NodeFieldValues values = {AtNodes(on_mesh, body.node_begin, body.mesh_node_end), {}};
    if (has_more) values.all = AtNodes(on_nodes, body.node_begin, body.node_end);
    return values;
  };
  if (InfoOf(field).from == FieldSource::kMotion) return values_of(state.velocities, state.velocities);
  const NodalVector forces = NodalForceOf(model, field, state, controls, team);
  return values_of(OnMeshNodes(model, body, forces), forces);
}

std::vector<double> FieldValuesAt(const TetModel& model, const Probe& probe, OutputField field, const TetState& state,
                                  const Controls& now, ThreadTeam& team) {
  const FieldSource from = InfoOf(field).from;
  if (from == FieldSource::kMotion) {
    const Vec3 v = ValueAt(model, probe, state.velocities);
    return {v.begin(), v.end()};
  }
  const TetPlace place = PlaceIn(model, probe);
  const FieldInputs inputs(model, from, state, now, team);
  return WithSource(from, [&]<FieldSource kFrom>() { return AtPlace<kFrom>(inputs, place, field); });
}

Vec3 DisplacementAt(const TetModel& model, const Probe& probe, const TetState& state) {
  return ValueAt(model, probe, state.positions) - ValueAt(model, probe, model.rest_positions());
}

}  // namespace fascicle
