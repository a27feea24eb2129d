#include "core/sim/voxel_measure.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/materials/rotation.h"
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

std::vector<MaterialPoint> NodesOf(const VoxelSceneBody& body, const VoxelState& state, double time_step) {
  std::vector<MaterialPoint> points(static_cast<std::size_t>(state.displacement.nodes()));
  for (std::int32_t n = 0; time_step > 0 && n < state.displacement.nodes(); ++n) {
    const Vec3 change = state.displacement.At(n) - state.previous.At(n);
    points[static_cast<std::size_t>(n)].v = body.ToWorld(change / time_step);
  }
  return points;
}

std::vector<MaterialPoint> CentresOf(const VoxelSceneBody& body, const VoxelState& state, FieldSource wanted) {
  const std::vector<Mat3> gradients = GradientsAtCentres(body.model(), state.displacement);
  std::vector<Mat3> stresses;
  if (wanted == FieldSource::kStress) stresses = StressesOf(body, state.displacement);
  std::vector<MaterialPoint> points(gradients.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    points[p].F = body.direction() * gradients[p] * body.direction().transpose();
    points[p].J = gradients[p].determinant();
    if (!stresses.empty()) points[p].sigma = stresses[p];
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
                                       const Controls& now, const std::vector<Vec3>& reactions,
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
      frames[b].fields.push_back(
          FieldOf(field, Method::kVoxel, FieldValuesOf(body, state.bodies[b], state.time_step, field)));
    }
  }
  return frames;
}

}  // namespace fascicle
