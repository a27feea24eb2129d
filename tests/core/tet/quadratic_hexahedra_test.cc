// Hexahedra of twenty-seven nodes: shape functions, rest data, regions, loads and curved edges.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <numbers>

#include "core/geometry/quadratic_hexahedron.h"
#include "core/tet/model.h"
#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;
using ::testing::HasSubstr;
using Shape27 = HexahedralQuadraticShape;

constexpr ElementOrder kQuadraticHexahedra = ElementOrder::kHexahedralQuadratic;

Scene QuadraticScene(Body body) {
  Scene scene = OneBody(std::move(body));
  scene.tet.element = kQuadraticHexahedra;
  return scene;
}

MooneyRivlin SoftRubber() { return MooneyRivlin(std::array{2e3, 1e3, 2e6}); }

Vec3 CoordinatesOf(int a) { return 0.5 * Vec3(HexNodeStep(a, 0), HexNodeStep(a, 1), HexNodeStep(a, 2)); }

// Each function is 1 at its node and 0 at the others, and slopes are those of the functions.
TEST(QuadraticHexahedronTest, ShapeFunctionsBelongToTheirNodes) {
  for (int a = 0; a < 27; ++a) {
    QuadraticHexahedronNodes values;
    values.fill(Vec3::Zero());
    values[static_cast<std::size_t>(a)] = Vec3::UnitX();
    for (int b = 0; b < 27; ++b) {
      EXPECT_EQ(TriquadraticValue(values, CoordinatesOf(b))[0], a == b ? 1 : 0) << a << " " << b;
    }
    for (int q = 0; q < 27; ++q) {
      const Vec3 x(Shape27::Place(q, 0), Shape27::Place(q, 1), Shape27::Place(q, 2));
      EXPECT_NEAR(Shape27::Value(q, a), TriquadraticValue(values, x)[0], 1e-15);
      for (int d = 0; d < 3; ++d) {
        const double slope = TriquadraticSlopes(values, x)(0, d), h = 1e-4;
        const Vec3 ahead = x + h * Vec3::Unit(d), behind = x - h * Vec3::Unit(d);
        EXPECT_NEAR(slope, (TriquadraticValue(values, ahead) - TriquadraticValue(values, behind))[0] / (2 * h), 1e-10);
        EXPECT_NEAR(Shape27::Slope(q, a, d), HexahedralShape::kScale * slope, 1e-13);
      }
    }
  }
  for (int a = 0; a < 8; ++a) EXPECT_EQ(CoordinatesOf(a), NodeCoordinates(a));
}

// The functions of the pressure add up to 1, are orthogonal, and span the linear functions.
TEST(QuadraticHexahedronTest, PressureFunctionsAreOrthogonal) {
  for (int c = 0; c < 4; ++c) {
    for (int d = 0; d < 4; ++d) {
      double product = 0;
      for (int q = 0; q < 27; ++q) {
        product += Shape27::PointWeight(q) * Shape27::PatchWeight(q, c) * Shape27::PatchWeight(q, d);
      }
      EXPECT_NEAR(product, c == d ? 0.25 : 0, 1e-15);
    }
  }
  for (int q = 0; q < 27; ++q) {
    double sum = 0;
    for (int c = 0; c < 4; ++c) sum += Shape27::PatchWeight(q, c);
    EXPECT_NEAR(sum, 1, 1e-15);
  }
}

TEST(QuadraticHexahedraTest, NodesMassesAndVolumes) {
  const Scene scene = QuadraticScene(BoxBody(Vec3(0.03, 0.02, 0.01), {3, 2, 1}, SoftRubber(), Cells::kHexahedra));
  const TetModel model(scene);
  EXPECT_EQ(model.nodes(), 7u * 5 * 3);
  EXPECT_EQ(model.bodies()[0].mesh_node_end, 4u * 3 * 2);
  EXPECT_EQ(model.patches().size(), 24u);
  double mass = 0;
  for (std::size_t n = 0; n < model.nodes(); ++n) mass += model.mass()[n];
  EXPECT_NEAR(mass, 1060 * 6e-6, 1e-15);
  // Row sums: a corner of one brick has 1/216 of it, its centre 8/27.
  EXPECT_NEAR(model.mass()[0], 1060e-6 / 216, 1e-15);
  EXPECT_NEAR(*std::max_element(model.mass().begin(), model.mass().end()), 1060e-6 * 8 / 27, 1e-15);
  for (const double volume : model.patches().rest_volume) EXPECT_NEAR(volume, 0.25e-6, 1e-20);
}

// The nodes of a side, an edge and one element.
TEST(QuadraticHexahedraTest, RegionsHaveTheirHigherNodes) {
  Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, SoftRubber(), Cells::kHexahedra);
  const HexahedralBoundary boundary = BoundaryOfHexahedra(body.tet().mesh);
  const auto add = [&](const Vec3& low, const Vec3& high) {
    const auto region = static_cast<std::int32_t>(body.regions.size());
    body.regions.push_back(SelectRegion(body.tet().mesh, boundary, "part", BoxSelector{low, high}));
    body.constraints.push_back({region, {true, true, true}, {}});
  };
  body.constraints = {Fix(kX0)};
  add(Vec3(0, 0, 0), Vec3(0.03, 0, 0));
  add(Vec3(0, 0, 0), Vec3(0.01, 0.01, 0.01));
  add(Vec3(0, 0, 0), Vec3(0.01, 0.02, 0.02));  // the sides between two inner nodes
  const Scene scene = QuadraticScene(std::move(body));
  const TetModel model(scene);
  EXPECT_EQ(model.supports()[0].nodes.size(), 25u);
  EXPECT_EQ(model.supports()[1].nodes.size(), 7u);
  EXPECT_EQ(model.supports()[2].nodes.size(), 27u);
  EXPECT_EQ(model.supports()[3].nodes.size(), 3u * 5 * 5);
}

// A traction on crooked sides: the resultant is the area times the traction, and its moment that of the surface, as of
// hexahedra of eight nodes on the same sides.
TEST(QuadraticHexahedraTest, TractionsAreConsistent) {
  const auto resultants = [](ElementOrder element) {
    TetMesh mesh = MakeBox(Vec3::Zero(), Vec3(0.03, 0.02, 0.01), {4, 3, 2}, Cells::kHexahedra);
    const std::vector<Vec3> straight = mesh.nodes;
    Body body = MakeBody("bar", std::move(mesh), SoftRubber());
    body.tet().mesh.nodes = Shaken(straight, 4e-4, 3);
    body.constraints = {Fix(kX0)};
    body.loads.push_back({kX1, Traction{Vec3(300, -200, 500)}, Curve::Constant(1), {}});
    Scene scene = OneBody(std::move(body));
    scene.tet.element = element;
    const TetModel model(scene);
    Eigen::Matrix<double, 6, 1> sums = Eigen::Matrix<double, 6, 1>::Zero();
    const NodalLoad& load = model.loads().at(0);
    for (std::size_t i = 0; i < load.nodes.size(); ++i) {
      const Vec3& X = model.rest_positions()[static_cast<std::size_t>(load.nodes[i])];
      sums.head<3>() += load.forces[i];
      sums.tail<3>() += X.cross(load.forces[i]);
    }
    return sums;
  };
  const auto linear = resultants(ElementOrder::kHexahedral), quadratic = resultants(kQuadraticHexahedra);
  EXPECT_LT((linear - quadratic).head<3>().norm(), 1e-5 * linear.head<3>().norm());
  EXPECT_LT((linear - quadratic).tail<3>().norm(), 1e-5 * linear.tail<3>().norm());
}

// A quarter of a ring.
TEST(QuadraticHexahedraTest, EdgesMayBeCurved) {
  const auto place = [](const Vec3& p) {
    const double angle = 0.5 * std::numbers::pi * p[0];
    return Vec3((0.02 + 0.01 * p[1]) * std::sin(angle), (0.02 + 0.01 * p[1]) * std::cos(angle), 0.01 * p[2]);
  };
  const double exact = 0.25 * std::numbers::pi * (0.03 * 0.03 - 0.02 * 0.02) * 0.01;
  const auto volume_of = [&](bool curved, int n) {
    TetMesh mesh = MakeBox(Vec3::Zero(), Vec3::Ones(), {n, 1, 1}, Cells::kHexahedra);
    Place(place, mesh);
    if (!curved) mesh.curved_edges.clear();
    const Scene scene = QuadraticScene(MakeBody("arc", std::move(mesh), SoftRubber()));
    Problems problems;
    CheckScene(scene, problems);
    EXPECT_EQ(problems.ToString(), "");
    const TetModel model(scene);
    double volume = 0;
    for (std::size_t q = 0; q < 27 * model.elements(); ++q) volume += model.rest_volume()[q];
    return volume / exact - 1;
  };
  EXPECT_LT(volume_of(false, 3), -0.04);
  EXPECT_LT(std::abs(volume_of(true, 3)), 1e-3);
  EXPECT_LT(std::abs(volume_of(true, 6)), 1e-4);
}

TEST(QuadraticHexahedraTest, DistortedElementsAreRefused) {
  Body body = BoxBody(Vec3::Constant(0.01), {2, 1, 1}, SoftRubber(), Cells::kHexahedra);
  TetMesh& mesh = body.tet().mesh;
  const Hexahedron& first = mesh.hexahedra[0];
  // Beyond a quarter of the edge, the mapping folds.
  mesh.curved_edges.push_back({{first[0], first[1]}, Vec3(0.0046, 0, 0)});
  body.constraints = {Fix(kX0)};
  const Scene scene = QuadraticScene(std::move(body));
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_THAT(problems.ToString(), HasSubstr("bodies[0].mesh: has 1 hexahedra too distorted for 27 nodes: 0"));
}

}  // namespace
}  // namespace fascicle
