// Loads that depend on positions: their forces, and the expansions that Newton's method uses.
#include "core/tet/position_loads.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/sim/control_source.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kPressure = 3e3;

// A box of 2 x 2 x 1 hexahedra with a pressure on the given side, or on all of its surface.
Scene PressedBox(ElementOrder element, std::optional<Side> side) {
  Body body = BoxBody(Vec3(0.02, 0.02, 0.01), {2, 2, 1}, NeoHookean(std::array{1e4, 0.3}), CellsOf(element));
  Region whole;
  whole.name = "surface";
  whole.triangles = BoundaryTriangles(body.tet().mesh);
  whole.sides = BoundaryOfHexahedra(body.tet().mesh).quads;
  for (std::size_t n = 0; n < body.tet().mesh.nodes.size(); ++n) whole.nodes.push_back(static_cast<std::int32_t>(n));
  body.regions.push_back(whole);
  Load load;
  load.region = side ? *side : 6;
  load.kind = Pressure{kPressure};
  body.loads = {load};
  Scene scene = OneBody(std::move(body));
  scene.tet.element = element;
  return scene;
}

NodalVector ForcesAt(const TetModel& model, const NodalVector& x) {
  NodalVector force(model.nodes(), Vec3::Zero());
  AddPositionLoads(model, ControlSource(model.scene()).At(0).load_scales, x, force);
  return force;
}

double VolumeAt(const TetModel& model, const NodalVector& x) {
  double volume = 0;
  model.VisitElement([&]<class Element>(Element) {
    for (std::size_t e = 0; e < model.elements(); ++e) {
      std::array<Vec3, Element::kNodes> at;
      const auto nodes = model.NodesOf<Element>(e);
      for (int a = 0; a < Element::kNodes; ++a) at[a] = x[nodes[a]];
      for (int q = 0; q < Element::kPoints; ++q) {
        volume += Element::PointWeight(q) * Determinant(EdgeMatrix(Element::Corners(at, q))) / 6;
      }
    }
  });
  return volume;
}

class PositionLoadsTest : public ::testing::TestWithParam<ElementOrder> {};

// On a closed surface the force of a pressure is the derivative of -p V, however the faces are bent. (The volume of a
// bent quadratic element is of degree 6, its quadrature only of degree 2: small displacements keep the difference
// below the tolerance.)
TEST_P(PositionLoadsTest, PressureOnAClosedSurfaceIsTheDerivativeOfItsVolume) {
  const Scene scene = PressedBox(GetParam(), std::nullopt);
  const TetModel model(scene);
  const NodalVector x = Shaken(model.rest_positions(), 1e-5, 1), d = RandomVectors(model.nodes(), 2);
  NodalVector ahead = x, behind = x;
  const double step = 1e-6;
  for (std::size_t n = 0; n < x.size(); ++n) {
    ahead[n] += step * d[n];
    behind[n] -= step * d[n];
  }
  const NodalVector force = ForcesAt(model, x);
  double work = 0;
  Vec3 sum = Vec3::Zero();
  for (std::size_t n = 0; n < x.size(); ++n) {
    work += force[n].dot(d[n]);
    sum += force[n];
  }
  const double expected = -kPressure * (VolumeAt(model, ahead) - VolumeAt(model, behind)) / (2 * step);
  EXPECT_NEAR(work, expected, 1e-4 * std::abs(expected));
  EXPECT_LT(sum.norm(), 1e-12 * kPressure * 0.02 * 0.02);
}

// The expansion is exact up to the second order where -df/dx is symmetric.
TEST_P(PositionLoadsTest, ExpansionsAreOfTheFirstOrder) {
  const Scene scene = PressedBox(GetParam(), std::nullopt);
  const TetModel model(scene);
  const std::vector<double> scales = ControlSource(scene).At(0).load_scales;
  const NodalVector c = Shaken(model.rest_positions(), 1e-3, 3), d = RandomVectors(model.nodes(), 4);
  const LoadExpansion expansion = ExpandPositionLoads(model, scales, c);
  const auto miss = [&](double step) {
    NodalVector x = c, change;
    for (std::size_t n = 0; n < x.size(); ++n) x[n] += step * d[n];
    const NodalVector at = ForcesAt(model, x), before = ForcesAt(model, c);
    expansion.Multiply(x, change);
    double largest = 0;
    for (std::size_t n = 0; n < x.size(); ++n) largest = std::max(largest, (at[n] - before[n] + change[n]).norm());
    return largest;
  };
  EXPECT_NEAR(miss(1e-4) / miss(1e-5), 100, 1);
}

TEST_P(PositionLoadsTest, PressureTurnsWithItsFace) {
  const Scene scene = PressedBox(GetParam(), kZ1);
  const TetModel model(scene);
  const Mat3 R = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  NodalVector x = model.rest_positions();
  for (Vec3& position : x) position = R * position + Vec3(1, 2, 3);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& force : ForcesAt(model, x)) sum += force;
  EXPECT_LT((sum - R * Vec3(0, 0, -kPressure * 4e-4)).norm(), 1e-12);
}

TEST_P(PositionLoadsTest, BodyForceHasTheWeightOfItsElements) {
  Body body = BoxBody(Vec3(0.02, 0.02, 0.01), {2, 2, 1}, NeoHookean(std::array{1e4, 0.3}), CellsOf(GetParam()));
  const TetMesh& mesh = body.tet().mesh;
  const PlaneSelector half{Vec3(0.01, 0, 0), Vec3::UnitX()};
  body.regions.push_back(mesh.hexahedra.empty() ? SelectRegion(mesh, BoundaryTriangles(mesh), "half", half)
                                                : SelectRegion(mesh, BoundaryOfHexahedra(mesh), "half", half));
  Load load;
  load.region = 6;
  load.kind = BodyForce{Vec3(0, 100, -2e4)};
  body.loads = {load};
  Scene scene = OneBody(std::move(body));
  scene.tet.element = GetParam();
  const TetModel model(scene);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t i = 0; i < model.loads()[0].nodes.size(); ++i) {
    const Vec3& force = model.loads()[0].forces[i];
    sum += force;
    moment += model.rest_positions()[static_cast<std::size_t>(model.loads()[0].nodes[i])].cross(force);
  }
  const Vec3 whole = 2e-6 * Vec3(0, 100, -2e4);
  EXPECT_LT((sum - whole).norm(), 1e-14);
  EXPECT_LT((moment - Vec3(0.015, 0.01, 0.005).cross(whole)).norm(), 1e-15) << "at the centroid of the half";
}

TEST_P(PositionLoadsTest, SpringsPullToTheRestPositions) {
  Body body = BoxBody(Vec3(0.02, 0.02, 0.01), {2, 2, 1}, NeoHookean(std::array{1e4, 0.3}), CellsOf(GetParam()));
  Load load;
  load.region = kX0;
  load.kind = Springs{Vec3(100, 0, 7)};
  load.scale = Curve::Constant(2);
  body.loads = {load};
  Scene scene = OneBody(std::move(body));
  scene.tet.element = GetParam();
  const TetModel model(scene);
  NodalVector x = model.rest_positions();
  for (Vec3& position : x) position += Vec3(1e-3, 5e-3, -2e-3);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& force : ForcesAt(model, x)) sum += force;
  EXPECT_LT((sum - Vec3(-0.2, 0, 0.028)).norm(), 1e-14);
}

INSTANTIATE_TEST_SUITE_P(Elements, PositionLoadsTest, ::testing::ValuesIn(kEveryElement),
                         [](const auto& test) { return ElementNameOf(test.param); });

}  // namespace
}  // namespace fascicle
