// Values of fields at points and over regions.
#include "client/export/sample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "client/export/read_series.h"
#include "client/export/vtk_series.h"
#include "tests/support/curved_ball.h"
#include "tests/support/files.h"
#include "tests/support/sample_job.h"

namespace fascicle::client {
namespace {

using ::fascicle::testing::CurvedBall;
using ::fascicle::testing::SampleJob;
using ::fascicle::testing::TemporaryFolder;
using ::testing::HasSubstr;

// u = A X + b, a linear field.
Vec3 Displacement(const Vec3& X) { return {0.1 * X[0] + 0.02 * X[1], -0.05 * X[1], 0.1 + 0.03 * X[2]}; }

void AddFields(std::size_t elements, BodySnapshot& body) {
  BodyField displacement = {"displacement", "m", {"x", "y", "z"}, true, {}};
  for (const Vec3& X : body.shape.positions) {
    const Vec3 u = Displacement(X);
    displacement.values.insert(displacement.values.end(), u.begin(), u.end());
    body.positions.push_back(X + u);
  }
  BodyField number = {"volume_ratio", "1", {""}, false, {}};
  for (std::size_t e = 0; e < elements; ++e) number.values.push_back(static_cast<double>(e));
  body.fields = {displacement, number};
}

// Two bricks side by side along x, 1 x 1 x 1 and 2 x 1 x 1 m.
Snapshot Bricks() {
  BodySnapshot body;
  body.shape.name = "bricks";
  for (const double z : {0.0, 1.0}) {
    for (const double y : {0.0, 1.0}) {
      for (const double x : {0.0, 1.0, 3.0}) body.shape.positions.emplace_back(x, y, z);
    }
  }
  body.shape.bricks = {{0, 1, 3, 4, 6, 7, 9, 10}, {1, 2, 4, 5, 7, 8, 10, 11}};
  body.shape.regions = {{"all", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}}, {"end", {2, 5, 8, 11}}, {"corner", {0}}};
  AddFields(2, body);
  return {3, 0.5, {body}};
}

// A tetrahedron beside them.
Snapshot WithTetrahedron() {
  Snapshot snapshot = Bricks();
  BodySnapshot body;
  body.shape.name = "tet";
  body.shape.positions = {Vec3(5, 0, 0), Vec3(6, 0, 0), Vec3(5, 1, 0), Vec3(5, 0, 1)};
  body.shape.tetrahedra = {{0, 1, 2, 3}};
  body.shape.regions = {{"all", {0, 1, 2, 3}}};
  AddFields(1, body);
  snapshot.bodies.push_back(body);
  return snapshot;
}

TEST(SampleTest, ALinearFieldIsExactInsideAndNothingOutside) {
  const std::vector<Vec3> points = {Vec3(0.3, 0.9, 0.2), Vec3(2.5, 0.5, 1), Vec3(4, 0.5, 0.5), Vec3(5.2, 0.3, 0.4),
                                    Vec3(5.6, 0.3, 0.4)};
  const std::vector<double> elements = {0, 1, NAN, 0, NAN};
  const std::vector<SampledColumn> columns = SampleAtPoints(WithTetrahedron(), points, false);
  ASSERT_EQ(columns.size(), 4u);
  EXPECT_EQ(columns[2].name, "displacement/z");
  EXPECT_EQ(columns[3].name, "volume_ratio");
  for (std::size_t p = 0; p < points.size(); ++p) {
    const bool outside = std::isnan(elements[p]);
    EXPECT_EQ(std::isnan(columns[3].values[p]), outside);
    if (outside) continue;
    EXPECT_EQ(columns[3].values[p], elements[p]);
    for (int d = 0; d < 3; ++d) {
      EXPECT_NEAR(columns[static_cast<std::size_t>(d)].values[p], Displacement(points[p])[d], 1e-14);
    }
  }
}

TEST(SampleTest, DeformedPointsArePointsOfSpace) {
  for (const Vec3& X : {Vec3(0.3, 0.9, 0.2), Vec3(2.9, 0.1, 0.7), Vec3(5.1, 0.2, 0.3)}) {
    const std::vector<SampledColumn> columns = SampleAtPoints(WithTetrahedron(), {X + Displacement(X)}, true);
    for (int d = 0; d < 3; ++d) {
      EXPECT_NEAR(columns[static_cast<std::size_t>(d)].values[0], Displacement(X)[d], 1e-13);
    }
  }
}

// Elements 0 and 1 with volumes 1 and 2: mean 2/3, integral 2.
TEST(SampleTest, ARegionIsWeightedByVolume) {
  const auto sample = SampleRegion(Bricks(), "all", false);
  ASSERT_TRUE(sample && sample->is_volume);
  EXPECT_NEAR(sample->size, 3, 1e-14);
  const RegionStatistics& ratio = sample->fields.back();
  EXPECT_NEAR(ratio.mean, 2.0 / 3, 1e-14);
  EXPECT_NEAR(ratio.integral, 2, 1e-14);
  EXPECT_EQ(ratio.smallest, 0);
  EXPECT_EQ(ratio.largest, 1);
  // det(I + A) = 1.1 x 0.95 x 1.03.
  EXPECT_NEAR(SampleRegion(Bricks(), "all", true)->size, 3 * 1.1 * 0.95 * 1.03, 1e-13);
}

TEST(SampleTest, ASurfaceIsWeightedByArea) {
  const auto sample = SampleRegion(Bricks(), "end", false);
  ASSERT_TRUE(sample && !sample->is_volume);
  EXPECT_NEAR(sample->size, 1, 1e-14);
  EXPECT_EQ(sample->fields.back().mean, 1);
  EXPECT_NEAR(sample->fields[0].mean, 0.1 * 3 + 0.02 * 0.5, 1e-14);
  EXPECT_FALSE(SampleRegion(Bricks(), "corner", false).has_value());
}

TEST(SampleTest, RegionsAreFoundByNameAndBody) {
  EXPECT_EQ(SampleRegion(WithTetrahedron(), "tet/all", false)->fields.back().mean, 0);
  for (const char* name : {"all", "nowhere"}) {
    try {
      SampleRegion(WithTetrahedron(), name, false);
      ADD_FAILURE() << name;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr("bricks/all, bricks/end, bricks/corner, tet/all"));
    }
  }
}

// An exported frame reads back as the frame.
// Quadratic elements: x^2 is exact where edges are straight, and points below the curved surface are inside.
TEST(SampleTest, QuadraticElementsAreInterpolatedByTheirShapeFunctions) {
  const CurvedBall ball(8);
  constexpr double kRadius = CurvedBall::kRadius;
  const Snapshot snapshot = SnapshotOf(ball.geometry(), ball.frame(2));
  const auto velocity = [&](const Vec3& point, bool deformed) {
    for (const SampledColumn& column : SampleAtPoints(snapshot, {point}, deformed)) {
      if (column.name == "velocity/x") return column.values[0];
    }
    return 0.0;
  };
  for (const double x : {-0.31, 0.123, 0.4}) {
    const Vec3 X = kRadius * Vec3(x, 0.21, -0.17);
    EXPECT_NEAR(velocity(X, false), X.x() * X.x(), 1e-16);
    EXPECT_NEAR(velocity(Vec3(1.2 * X.x(), X.y(), X.z()), true), X.x() * X.x(), 1e-16);
  }
  // In the middle of a triangle of the surface, between the flat triangle and the sphere.
  const Triangle t = BoundaryTriangles(ball.mesh())[40];
  const Vec3 middle = (ball.mesh().nodes[t[0]] + ball.mesh().nodes[t[1]] + ball.mesh().nodes[t[2]]) / 3;
  const Vec3 below = (0.5 * middle.norm() + 0.5 * kRadius) * middle.normalized();
  EXPECT_NEAR(velocity(below, false), below.x() * below.x(), 1e-3 * kRadius * kRadius);
  EXPECT_TRUE(std::isnan(velocity(1.01 * kRadius * middle.normalized(), false)));
  // The integral of x^2 over the sphere is 4 pi R^4 / 3; over the ball, 4 pi R^5 / 15.
  const auto surface = SampleRegion(snapshot, "surface", false);
  ASSERT_TRUE(surface && !surface->is_volume);
  EXPECT_NEAR(surface->size / (4 * M_PI * kRadius * kRadius), 1, 1e-3);
  for (const RegionStatistics& field : surface->fields) {
    if (field.name != "velocity/x") continue;
    EXPECT_NEAR(field.integral / (4 * M_PI / 3 * std::pow(kRadius, 4)), 1, 2e-3);
  }
}

TEST(SampleTest, AnExportedSeriesIsTheSame) {
  const SampleJob job;
  const TemporaryFolder folder;
  EXPECT_FALSE(HasSeries(folder.path()));
  VtkSeriesWriter writer(job.geometry(), folder.path());
  writer.Add(job.frame(0));
  writer.Add(job.frame(7));
  writer.Finish();
  ASSERT_TRUE(HasSeries(folder.path()));
  const std::vector<ExportedFrame> frames = ReadSeriesIndex(folder.path());
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].frame, 7);
  const Snapshot read = ReadSnapshot(frames[1]), sent = SnapshotOf(job.geometry(), job.frame(7));
  EXPECT_EQ(read.time, sent.time);
  ASSERT_EQ(read.bodies.size(), sent.bodies.size());
  const BodySnapshot &a = read.bodies[0], &b = sent.bodies[0];
  EXPECT_EQ(a.shape.name, b.shape.name);
  EXPECT_EQ(a.shape.tetrahedra, b.shape.tetrahedra);
  ASSERT_EQ(a.shape.positions.size(), b.shape.positions.size());
  for (std::size_t n = 0; n < b.positions.size(); ++n) {
    EXPECT_EQ(a.positions[n], b.positions[n]);
    EXPECT_LT((a.shape.positions[n] - b.shape.positions[n]).norm(), 1e-15);
  }
  for (const BodyField& field : b.fields) {
    const auto same =
        std::find_if(a.fields.begin(), a.fields.end(), [&](const auto& f) { return f.name == field.name; });
    ASSERT_NE(same, a.fields.end()) << field.name;
    EXPECT_EQ(same->values, field.values);
    EXPECT_EQ(same->unit, field.unit);
    EXPECT_EQ(same->at_nodes, field.at_nodes);
  }
  ASSERT_EQ(a.shape.regions.size(), b.shape.regions.size());
  EXPECT_EQ(a.shape.regions[0].nodes, b.shape.regions[0].nodes);
}

}  // namespace
}  // namespace fascicle::client
