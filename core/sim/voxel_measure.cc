#include "core/sim/voxel_measure.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/materials/rotation.h"
#include "core/scene/probe_place.h"
#include "core/sim/series.h"
#include "core/voxel/brick.h"
#include "core/voxel/fields.h"

namespace fascicle {
namespace {

// Deformation gradient at the centre of every voxel, along the axes of the grid.
std::vector<Mat3> GradientsAtCentres(const VoxelModel& model, const VoxelField<double>& u) {
  const auto gradients = BrickGradients(model.mesh().spacing(), Vec3::Zero());
  std::vector<Mat3> F(static_cast<std::size_t>(model.mesh().voxels()));
  ForVoxels(model.mesh(), [&](std::int32_t voxel, const GridIndex&, const Brick& nodes) {
    Mat3 sum = Mat3::Identity();
    for (int c = 0; c < 8; ++c) sum += u.At(nodes[c]) * gradients.col(c).transpose();
    F[static_cast<std::size_t>(voxel)] = sum;
  });
  return F;
}

// The tensors of the grid along the world axes; with large rotation they have been rotated with their bricks.
std::vector<Mat3> StressesOf(const VoxelSceneBody& body, const VoxelField<double>& u) {
  const VoxelModel& model = body.model();
  const bool turns = model.rotation() == VoxelRotation::kLarge;
  const std::vector<Mat3> gradients = turns ? GradientsAtCentres(model, u) : std::vector<Mat3>();
  std::vector<Mat3> stresses;
  for (const SymmetricTensor& s : StressAtCentres(model, u)) {
    Mat3 sigma;
    sigma << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    Mat3 turn = body.direction();
    if (turns) turn *= NearestRotationBySvd(gradients[stresses.size()]);
    stresses.push_back(turn * sigma * turn.transpose());
  }
  return stresses;
}

// Values of a field at points, one after another.
std::vector<double> ValuesAt(const std::vector<MaterialPoint>& points, OutputField field) {
  const std::size_t components = InfoOf(field).components;
  std::vector<double> values(components * points.size());
  for (std::size_t p = 0; p < points.size(); ++p) PutField(field, points[p], &values[components * p]);
  return values;
}

// [m/s], along the world axes.
Vec3 VelocityOf(const VoxelSceneBody& body, const VoxelState& state, double time_step, std::int32_t node) {
  if (!(time_step > 0)) return Vec3::Zero();
  const Vec3 change = state.displacement.At(node) - state.previous.At(node);
  return body.ToWorld(change / time_step);
}

std::vector<MaterialPoint> NodesOf(const VoxelSceneBody& body, const VoxelState& state, double time_step) {
  std::vector<MaterialPoint> points(static_cast<std::size_t>(state.displacement.nodes()));
  for (std::int32_t n = 0; n < state.displacement.nodes(); ++n) {
    points[static_cast<std::size_t>(n)].v = VelocityOf(body, state, time_step, n);
  }
  return points;
}

std::vector<MaterialPoint> CentresOf(const VoxelSceneBody& body, const VoxelState& state, FieldSource wanted) {
  const std::vector<Mat3> gradients = GradientsAtCentres(body.model(), state.displacement);
  std::vector<Mat3> stresses;
  std::vector<double> energies;
  if (wanted == FieldSource::kStress) stresses = StressesOf(body, state.displacement);
  if (wanted == FieldSource::kEnergy) energies = EnergyDensityAtCentres(body.model(), state.displacement);
  std::vector<MaterialPoint> points(gradients.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    points[p].F = body.direction() * gradients[p] * body.direction().transpose();
    points[p].J = gradients[p].determinant();
    if (!stresses.empty()) points[p].sigma = stresses[p];
    if (!energies.empty()) points[p].energy_density = energies[p];
  }
  return points;
}

std::vector<double> FieldValuesOf(const VoxelSceneBody& body, const VoxelState& state, double time_step,
                                  OutputField field) {
  const FieldSource from = InfoOf(field).from;
  const std::vector<MaterialPoint> points =
      from == FieldSource::kMotion ? NodesOf(body, state, time_step) : CentresOf(body, state, from);
  std::vector<double> values = ValuesAt(points, field);
  if (InfoOf(field).is_direction) NormalizeDirections(values);
  return values;
}

// Fields of elements are those at the centre of the probe's voxel, where they are most accurate; nodal values are
// interpolated.
std::vector<double> FieldValuesAt(const VoxelSceneBody& body, const VoxelState& state, double time_step,
                                  const Probe& probe, OutputField field) {
  const ProbePlace place = PlaceOf(probe, body.source().shape);
  if (InfoOf(field).from == FieldSource::kMotion) {
    Vec3 v = Vec3::Zero();
    for (const auto& [node, weight] : WeightsAt(place, body.source().shape)) {
      v += weight * VelocityOf(body, state, time_step, node);
    }
    return {v.begin(), v.end()};
  }
  const std::vector<double> values = FieldValuesOf(body, state, time_step, field);
  const auto components = static_cast<std::ptrdiff_t>(InfoOf(field).components);
  const auto first = values.begin() + components * place.element;
  return {first, first + components};
}

Vec3 DisplacementAt(const VoxelSceneBody& body, const VoxelState& state, const Probe& probe) {
  Vec3 u = Vec3::Zero();
  for (const auto& [node, weight] : WeightsAt(PlaceOf(probe, body.source().shape), body.source().shape)) {
    u += weight * state.displacement.At(node);
  }
  return body.ToWorld(u);
}

Vec3 PositionOf(const VoxelSceneBody& body, const VoxelField<double>& u, std::size_t node) {
  return body.source().nodes()[node] + body.ToWorld(u.At(static_cast<std::int32_t>(node)));
}

}  // namespace

std::vector<SeriesInfo> VoxelSeriesOf(const Scene& scene) {
  std::vector<SeriesInfo> series = {
      {"energy/elastic", "J", "elastic energy of all bodies"},
      {"energy/kinetic", "J", "kinetic energy of all bodies, for the mean velocity of the last step"},
      {"solver/step", "s", "length of the last time step"},
      {"solver/iterations", "1", "iterations of conjugate gradients since the previous frame"},
  };
  for (const Body& body : scene.bodies) {
    series.push_back({body.name + "/volume_ratio", "1", "mean volume ratio J of the voxels, at their centres"});
    series.push_back({body.name + "/min_volume_ratio", "1", "smallest volume ratio J of a voxel, at its centre"});
    AddBodySeries(body, series);
  }
  AddProbeSeries(scene, series);
  return series;
}

std::vector<double> MeasureVoxelSeries(const Scene& scene, const VoxelSolver& solver, const VoxelSceneState& state,
                                       const Controls& now, const std::vector<Reaction>& reactions,
                                       std::int64_t iterations_before) {
  double elastic = 0, kinetic = 0;
  for (const double energy : state.elastic) elastic += energy;
  for (const double energy : state.kinetic) kinetic += energy;
  std::vector<double> values = {elastic, kinetic, state.time_step,
                                static_cast<double>(state.iterations - iterations_before)};
  auto of_body = reactions.begin();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    double sum = 0, smallest = INFINITY;
    const std::vector<Mat3> gradients = GradientsAtCentres(solver.bodies()[b]->model(), state.bodies[b].displacement);
    for (const Mat3& F : gradients) {
      const double J = F.determinant();
      sum += J;
      smallest = std::min(smallest, J);
    }
    values.insert(values.end(), {sum / static_cast<double>(gradients.size()), smallest});
    const std::size_t count = scene.bodies[b].constraints.size();
    AddBodyValues(scene.bodies[b], ControlsOf(scene, b, now), {of_body, count}, values);
    of_body += static_cast<std::ptrdiff_t>(count);
  }
  for (const Probe& probe : scene.output.probes) {
    const auto b = static_cast<std::size_t>(probe.body);
    const Vec3 u = solver.bodies()[b]->ToWorld(state.bodies[b].displacement.At(probe.node));
    values.insert(values.end(), u.begin(), u.end());
  }
  return values;
}

std::vector<SeriesInfo> VoxelLaterSeriesOf(const Scene& scene) {
  std::vector<SeriesInfo> series;
  AddMomentSeries(scene, series);
  AddInnerProbeSeries(scene, series);
  return series;
}

std::vector<double> MeasureVoxelLaterSeries(const Scene& scene, const VoxelSolver& solver, const VoxelSceneState& state,
                                            const std::vector<Reaction>& reactions) {
  std::vector<double> values;
  AddMomentValues(scene, reactions, values);
  const auto body_of = [&](const Probe& probe) -> const VoxelSceneBody& {
    return *solver.bodies()[static_cast<std::size_t>(probe.body)];
  };
  const auto state_of = [&](const Probe& probe) -> const VoxelState& {
    return state.bodies[static_cast<std::size_t>(probe.body)];
  };
  const ProbeMeasures probes = {
      [&](const Probe& probe) { return DisplacementAt(body_of(probe), state_of(probe), probe); },
      [&](const Probe& probe, OutputField field) {
        return FieldValuesAt(body_of(probe), state_of(probe), state.time_step, probe, field);
      }};
  AddInnerProbeValues(scene, probes, values);
  return values;
}

std::vector<double> VoxelValuesOf(const VoxelSolver& solver, const VoxelSceneState& state, std::size_t body,
                                  OutputField field) {
  return FieldValuesOf(*solver.bodies()[body], state.bodies[body], state.time_step, field);
}

std::vector<BodyFrame> MeasureVoxelBodies(const Scene& scene, const VoxelSolver& solver, const VoxelSceneState& state) {
  std::vector<BodyFrame> frames(scene.bodies.size());
  for (std::size_t b = 0; b < frames.size(); ++b) {
    const VoxelSceneBody& body = *solver.bodies()[b];
    const std::size_t nodes = scene.bodies[b].nodes().size();
    frames[b].positions.reserve(nodes);
    for (std::size_t n = 0; n < nodes; ++n) {
      frames[b].positions.push_back(PositionOf(body, state.bodies[b].displacement, n));
    }
    for (const OutputField field : scene.output.fields) {
      frames[b].fields.push_back(FieldOf(field, LocationOf(InfoOf(field), scene.bodies[b].shape),
                                         FieldValuesOf(body, state.bodies[b], state.time_step, field)));
    }
  }
  return frames;
}

}  // namespace fascicle
