#ifndef FASCICLE_TESTS_SUPPORT_SAMPLE_OBJECTS_H_
#define FASCICLE_TESTS_SUPPORT_SAMPLE_OBJECTS_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/pose.h"
#include "fascicle/v1/frame.pb.h"
#include "tests/support/sample_job.h"

// Handmade rigid bodies and lines as a job sends them; bodies come from SampleJob.
namespace fascicle::testing {

// A box around the origin with corners (+-x, +-y, +-z) / 2, as a closed surface.
inline void SetBox(const Vec3& size, v1::RigidBodyGeometry& body) {
  std::vector<double> positions;
  for (int n = 0; n < 8; ++n) {
    for (int k = 0; k < 3; ++k) positions.push_back(size[k] * ((n >> k & 1) - 0.5));
  }
  const std::vector<std::uint32_t> triangles = {0, 3, 1, 0, 2, 3, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                2, 7, 3, 2, 6, 7, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  body.set_positions(Bytes(positions));
  body.set_triangles(Bytes(triangles));
}

inline v1::RigidBodyGeometry& AddRigidBody(const std::string& name, const Pose& pose, bool moves,
                                           v1::Geometry& geometry) {
  v1::RigidBodyGeometry& body = *geometry.add_rigid_bodies();
  body.set_name(name);
  body.set_pose(Bytes(std::vector<Pose>{pose}));
  body.set_moves(moves);
  return body;
}

inline void AddLine(const std::string& name, const std::vector<std::array<const char*, 2>>& values,
                    v1::Geometry& geometry) {
  v1::LineGeometry& line = *geometry.add_lines();
  line.set_name(name);
  for (const auto& [value, unit] : values) {
    v1::SeriesInfo& info = *line.add_values();
    info.set_name(value);
    info.set_unit(unit);
    info.set_description(std::string("the line's ") + value);
  }
}

inline void AddLine(const std::vector<Vec3>& points, const std::vector<double>& values, v1::Frame& frame) {
  v1::LineFrame& line = *frame.add_lines();
  line.set_points(Bytes(points));
  line.mutable_values()->Assign(values.begin(), values.end());
}

// A quarter turn about z.
inline std::array<double, 4> QuarterTurn() { return {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}; }

// A box of 40 x 20 x 20 mm, `bone`, that moves; one of 20 x 20 x 20 mm, `ground`, fixed at (0, 0, -0.1) m; `joint`,
// which moves and has no shape; `flexor`, a line along two sides of a square of 200 mm; and `slack`, a line without
// points at first.
inline v1::Geometry SampleObjects() {
  v1::Geometry geometry;
  SetBox(Vec3(0.04, 0.02, 0.02), AddRigidBody("bone", {}, true, geometry));
  SetBox(Vec3(0.02, 0.02, 0.02), AddRigidBody("ground", {Vec3(0, 0, -0.1), QuarterTurn()}, false, geometry));
  AddRigidBody("joint", {}, true, geometry);
  AddLine("flexor", {{"activation", "1"}, {"length", "m"}}, geometry);
  AddLine("slack", {{"activation", "1"}}, geometry);
  return geometry;
}

// Index 0: as in the geometry. Later: the bone is rotated by 90 degrees about z and displaced by (40, 20, 0) mm,
// activations are 0.1 index, `flexor` has one point more, and `slack` is straight above the bone.
inline v1::Frame SampleObjectsFrame(int index) {
  v1::Frame frame;
  frame.set_index(index);
  frame.set_time(0.05 * index);
  frame.set_step(10 * index);
  std::vector<Pose> poses(2);
  std::vector<Vec3> square = {Vec3(-0.1, -0.1, 0), Vec3(0.1, -0.1, 0), Vec3(0.1, 0.1, 0)}, slack;
  if (index > 0) {
    poses[0] = {Vec3(0.04, 0.02, 0), QuarterTurn()};
    square.insert(square.begin() + 1, Vec3(0, -0.1, 0));
    slack = {Vec3(-0.06, 0.06, 0.05), Vec3(0.02, 0.06, 0.05)};
  }
  frame.set_poses(Bytes(poses));
  AddLine(square, {0.1 * index, 0.4}, frame);
  AddLine(slack, {0.1 * index + 0.5}, frame);
  return frame;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_SAMPLE_OBJECTS_H_
