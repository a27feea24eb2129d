// Cross-sections and fibres of bodies whose architecture is known.
#include "client/export/architecture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/hexahedron.h"
#include "core/geometry/shapes.h"
#include "tests/support/curved_ball.h"

namespace fascicle::client {
namespace {

using ::fascicle::testing::CurvedBall;

BodySnapshot SnapshotOfMesh(const TetMesh& mesh, const Vec3& fibre, const Mat3& F) {
  BodySnapshot body;
  body.shape.name = "body";
  body.shape.positions = mesh.nodes;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    body.shape.tetrahedra.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                                     static_cast<std::uint32_t>(t[2]), static_cast<std::uint32_t>(t[3])});
  }
  body.shape.fibres.assign(mesh.tetrahedra.size(), fibre.normalized());
  for (const Vec3& X : mesh.nodes) body.positions.push_back(F * X);
  return body;
}

TEST(CrossSectionAreasTest, OfABoxInAnyDirection) {
  const TetMesh box = MakeBox(Vec3(1, 2, 3), Vec3(0.02, 0.03, 0.05), {3, 4, 5});
  const BodySnapshot body = SnapshotOfMesh(box, Vec3::UnitZ(), Vec3(2, 1, 0.5).asDiagonal());
  const CrossSectionAreas along = CrossSectionAreasOf(body, Vec3(0, 0, 7), 4, false);
  ASSERT_EQ(along.areas.size(), 4u);
  EXPECT_NEAR(along.places[0], 3 + 0.05 / 8, 1e-12);
  for (const double area : along.areas) EXPECT_NEAR(area, 0.02 * 0.03, 1e-12);
  for (const double area : CrossSectionAreasOf(body, Vec3(0, 0, -1), 3, true).areas) {
    EXPECT_NEAR(area, 2 * 0.02 * 0.03, 1e-12);
  }
  // Across x and z at once, the plane through the middle cuts a rectangle.
  const CrossSectionAreas oblique = CrossSectionAreasOf(body, Vec3(0.05, 0, 0.02), 1, false);
  EXPECT_NEAR(oblique.areas[0], 0.03 * std::hypot(0.02, 0.05), 1e-12);
}

TEST(CrossSectionAreasTest, OfVoxelsAndSurfaces) {
  BodySnapshot brick;
  for (int c = 0; c < 8; ++c) brick.shape.positions.emplace_back(c & 1, 2 * (c >> 1 & 1), 3 * (c >> 2));
  brick.positions = brick.shape.positions;
  brick.shape.bricks = {{0, 1, 2, 3, 4, 5, 6, 7}};
  EXPECT_NEAR(CrossSectionAreasOf(brick, Vec3::UnitZ(), 1, false).areas[0], 2, 1e-14);
  EXPECT_NEAR(CrossSectionAreasOf(brick, Vec3::UnitX(), 1, false).areas[0], 6, 1e-14);

  const TetMesh ball = MakeSphere(0.01, 24);
  BodySnapshot surface;
  surface.shape.positions = surface.positions = ball.nodes;
  for (const Triangle& t : BoundaryTriangles(ball)) {
    surface.shape.triangles.push_back(
        {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]), static_cast<std::uint32_t>(t[2])});
  }
  const CrossSectionAreas cut = CrossSectionAreasOf(surface, Vec3(1, 2, 3), 5, false);
  for (std::size_t k = 0; k < 5; ++k) {
    const double exact = std::numbers::pi * (1e-4 - cut.places[k] * cut.places[k]);
    EXPECT_NEAR(cut.areas[k], exact, 0.02 * std::numbers::pi * 1e-4);
  }
}

// Parallel fibres between the ends of a box: length, volume and PCSA are those of the box.
TEST(FibreArchitectureTest, OfAParallelMuscle) {
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3(0.02, 0.01, 0.1), {3, 2, 11});
  const Mat3 F = Vec3(1.2, 1.1, 0.8).asDiagonal();
  const BodySnapshot body = SnapshotOfMesh(box, Vec3::UnitZ(), F);
  const auto rest = FibreArchitectureOf(body, std::nullopt, false);
  ASSERT_TRUE(rest.has_value());
  EXPECT_NEAR(rest->volume, 2e-5, 1e-17);
  EXPECT_NEAR(rest->length, 0.1, 1e-12);
  EXPECT_NEAR(rest->shortest, 0.1, 1e-12);
  EXPECT_NEAR(rest->longest, 0.1, 1e-12);
  EXPECT_NEAR(rest->pennation, 0, 1e-6);
  EXPECT_NEAR(rest->cross_section, 2e-4, 1e-15);
  const auto deformed = FibreArchitectureOf(body, Vec3(0, 0, 1), true);
  EXPECT_NEAR(deformed->length, 0.08, 1e-12);
  EXPECT_NEAR(deformed->volume, 2e-5 * F.determinant(), 1e-17);
  EXPECT_NEAR(deformed->cross_section, 2e-4 * 1.2 * 1.1, 1e-15);
}

// Unipennate: fibres at 30 degrees between two sides of a long box, d apart: length d / sin 30, cut short near the
// ends.
TEST(FibreArchitectureTest, OfAUnipennateMuscle) {
  const double angle = std::numbers::pi / 6, depth = 0.01, length = 0.4;
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3(depth, 0.01, length), {3, 2, 80});
  const BodySnapshot body = SnapshotOfMesh(box, Vec3(std::sin(angle), 0, std::cos(angle)), Mat3::Identity());
  const auto found = FibreArchitectureOf(body, Vec3(0, 0, 1), false);
  EXPECT_NEAR(found->pennation, angle, 1e-9);
  EXPECT_NEAR(found->longest, depth / std::sin(angle), 1e-9);
  EXPECT_GT(found->length, 0.95 * depth / std::sin(angle));
  const double exact = depth * 0.01 * length * std::cos(angle) / (depth / std::sin(angle));
  EXPECT_NEAR(found->cross_section, exact, 0.07 * exact);
}

// Fibres that turn from element to element: an arc, whose path crosses many elements.
TEST(FibreArchitectureTest, FollowsCurvedFibres) {
  TetMesh mesh = MakeBox(Vec3::Zero(), Vec3(0.01, 0.01, 1), {3, 3, 60});
  for (Vec3& X : mesh.nodes) {
    const double radius = 0.05 + X[0], angle = std::numbers::pi / 2 * X[2];
    X = Vec3(radius * std::cos(angle), X[1], radius * std::sin(angle));
  }
  BodySnapshot body = SnapshotOfMesh(mesh, Vec3::UnitZ(), Mat3::Identity());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const Vec3 middle = Centroid(mesh, t);
    body.shape.fibres[t] = Vec3(-middle.z(), 0, middle.x()).normalized();
  }
  const auto found = FibreArchitectureOf(body, Vec3(-1, 0, 1), false);
  // Mean over a volume that is proportional to the radius.
  const double mean_radius = (std::pow(0.06, 3) - std::pow(0.05, 3)) / 3 / ((0.06 * 0.06 - 0.05 * 0.05) / 2);
  EXPECT_NEAR(found->length, mean_radius * std::numbers::pi / 2, 0.02 * found->length);
}

TEST(FibreArchitectureTest, TakesVolumesFromTheFieldIfThereIsOne) {
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3::Ones(), {1, 1, 1});
  BodySnapshot body = SnapshotOfMesh(box, Vec3::UnitZ(), Vec3(2, 1, 1).asDiagonal());
  EXPECT_NEAR(FibreArchitectureOf(body, std::nullopt, true)->volume, 2, 1e-12);
  body.fields = {{"volume_ratio", "1", {""}, false, std::vector<double>(6, 1.5)}};
  EXPECT_NEAR(FibreArchitectureOf(body, std::nullopt, true)->volume, 1.5, 1e-12);
  EXPECT_NEAR(FibreArchitectureOf(body, std::nullopt, false)->volume, 1, 1e-12);
}

// The same muscle of hexahedra.
TEST(FibreArchitectureTest, OfHexahedra) {
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3(0.02, 0.01, 0.1), {3, 2, 11}, Cells::kHexahedra);
  BodySnapshot body = SnapshotOfMesh(box, Vec3(0.1, 0, 1), Mat3::Identity());
  const auto of_tetrahedra = FibreArchitectureOf(body, std::nullopt, false);
  body.shape.tetrahedra.clear();
  for (const Hexahedron& h : box.hexahedra) {
    auto& brick = body.shape.bricks.emplace_back();
    for (std::size_t c = 0; c < 8; ++c)
      brick[c] = static_cast<std::uint32_t>(h[static_cast<std::size_t>(kBrickOrder[c])]);
  }
  body.shape.fibres.resize(box.hexahedra.size());
  body.fields = {{"volume_ratio", "1", {""}, false, std::vector<double>(box.hexahedra.size(), 1.25)}};
  const auto of_hexahedra = FibreArchitectureOf(body, std::nullopt, false);
  ASSERT_TRUE(of_hexahedra && of_tetrahedra);
  EXPECT_NEAR(of_hexahedra->length, of_tetrahedra->length, 1e-3 * of_tetrahedra->length);
  EXPECT_NEAR(of_hexahedra->pennation, of_tetrahedra->pennation, 1e-9);
  EXPECT_NEAR(of_hexahedra->volume, 2e-5, 1e-17);
  EXPECT_NEAR(FibreArchitectureOf(body, std::nullopt, true)->volume, 2.5e-5, 1e-17);
}

// Curved surfaces: a ball's cross-sections and volume, at rest and stretched.
TEST(FibreArchitectureTest, OfQuadraticElements) {
  const CurvedBall ball(8);
  const Snapshot snapshot = SnapshotOf(ball.geometry(), ball.frame(2));
  const BodySnapshot& body = snapshot.bodies[0];
  constexpr double kRadius = CurvedBall::kRadius;
  const double volume = 4 * std::numbers::pi / 3 * std::pow(kRadius, 3);
  const auto rest = FibreArchitectureOf(body, Vec3::UnitX(), false);
  const auto deformed = FibreArchitectureOf(body, Vec3::UnitX(), true);
  ASSERT_TRUE(rest && deformed);
  EXPECT_NEAR(rest->volume, volume, 1e-3 * volume);
  EXPECT_NEAR(deformed->volume, 1.2 * rest->volume, 1e-12 * volume);
  EXPECT_NEAR(deformed->length, 1.2 * rest->length, 1e-12);
  EXPECT_NEAR(deformed->pennation, 0, 1e-6);
  const CrossSectionAreas cut = CrossSectionAreasOf(body, Vec3::UnitX(), 5, true);
  for (std::size_t k = 0; k < 5; ++k) {
    const double X = cut.places[k] / 1.2, exact = std::numbers::pi * (kRadius * kRadius - X * X);
    EXPECT_NEAR(cut.areas[k], exact, 2e-3 * exact);
  }
}

TEST(FibreArchitectureTest, NeedsFibres) {
  BodySnapshot body = SnapshotOfMesh(MakeBox(Vec3::Zero(), Vec3::Ones(), {1, 1, 1}), Vec3::UnitZ(), Mat3::Identity());
  body.shape.fibres.clear();
  EXPECT_FALSE(FibreArchitectureOf(body, std::nullopt, false).has_value());
}

}  // namespace
}  // namespace fascicle::client
