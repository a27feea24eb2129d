// Wedges and pyramids: hexahedra with repeated nodes, in meshes of all three.
#include <gtest/gtest.h>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/mesh_writer.h"
#include "core/geometry/solid_cells.h"
#include "core/tet/element_matrices.h"
#include "plain_stiffness.h"
#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// A box of hexahedra in columns along z, of which some are halved into wedges and some divided into six pyramids.
TetMesh MixedBox(const Vec3& size, const std::array<int, 3>& divisions) {
  TetMesh mesh = MakeBox(Vec3::Zero(), size, divisions, Cells::kHexahedra);
  std::vector<Hexahedron> mixed;
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    const Hexahedron n = mesh.hexahedra[h];
    const auto nx = static_cast<std::size_t>(divisions[0]), ny = static_cast<std::size_t>(divisions[1]);
    const std::size_t kind = (h % nx + h / nx % ny) % 3;
    if (kind == 0) {
      mixed.push_back(n);
    } else if (kind == 1) {
      for (const int k : {1, 2}) {
        const std::array<std::int32_t, 8> wedge = {n[0], n[k], n[k + 1], n[4], n[4 + k], n[5 + k]};
        mixed.push_back(AsHexahedron(SolidShape::kWedge, wedge));
      }
    } else {
      const auto apex = static_cast<std::int32_t>(mesh.nodes.size());
      mesh.nodes.push_back(ElementCentroid(mesh, h));
      for (const SolidSide& side : SidesOf(SolidShape::kHexahedron)) {
        // Counter-clockwise seen from the apex.
        const std::array<std::int32_t, 8> pyramid = {n[side[3]], n[side[2]], n[side[1]], n[side[0]], apex};
        mixed.push_back(AsHexahedron(SolidShape::kPyramid, pyramid));
      }
    }
  }
  mesh.hexahedra = std::move(mixed);
  SplitHexahedra(mesh);
  return mesh;
}

// The same with its inner nodes moved.
TetMesh CrookedMixedBox(const Vec3& size, const std::array<int, 3>& divisions, double by) {
  TetMesh mesh = MixedBox(size, divisions);
  const NodalVector moved = Shaken(mesh.nodes, by, 5);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec3& X = mesh.nodes[n];
    if ((X.array() > 1e-9).all() && (X.array() < size.array() - 1e-9).all()) mesh.nodes[n] = moved[n];
  }
  return mesh;
}

const Vec3 kMixedSize(0.03, 0.03, 0.02);

Scene MixedScene(TetMesh mesh, const Material& law) {
  Scene scene = OneBody(MakeBody("box", std::move(mesh), law));
  scene.tet.element = ElementOrder::kHexahedral;
  return scene;
}

TEST(WedgesTest, VolumesMassesAndSides) {
  const TetMesh mesh = MixedBox(kMixedSize, {3, 3, 2});
  EXPECT_EQ(mesh.hexahedra.size(), 2u * (3 + 2 * 3 + 6 * 3));
  EXPECT_NEAR(TotalVolume(mesh), kMixedSize.prod(), 1e-18);
  Problems problems;
  CheckMesh(mesh, problems);
  EXPECT_EQ(problems.ToString(), "");
  const HexahedralBoundary boundary = BoundaryOfHexahedra(mesh);
  // Halved columns have two triangles at each end.
  EXPECT_EQ(boundary.quads.size(), 2u * (3 * 2 + 3 * 2) + 2 * (6 + 3 * 2));
  Vec3 area = Vec3::Zero();
  double whole = 0;
  for (const Quad& side : boundary.quads) {
    const LoadedRegion::Face face = LoadedSide(side, mesh.nodes);
    area += face.area;
    for (int c = 0; c < 4; ++c) whole += face.share[c];
  }
  EXPECT_LT(area.norm(), 1e-18);
  EXPECT_NEAR(whole, 2 * (9e-4 + 2 * 6e-4), 1e-15);
  const Scene scene = MixedScene(mesh, NearlyIncompressible());
  const TetModel model(scene);
  double mass = 0;
  for (const double m : model.mass()) mass += m;
  EXPECT_NEAR(mass, 1060 * kMixedSize.prod(), 1e-15);
  EXPECT_GT(*std::min_element(model.mass().begin(), model.mass().end()), 0);
}

// A linear displacement of a crooked mesh: no force on interior nodes.
TEST(WedgesTest, LinearDisplacementIsInEquilibrium) {
  const Scene scene = MixedScene(CrookedMixedBox(kMixedSize, {3, 3, 3}, 8e-4), NearlyIncompressible());
  const TetModel model(scene);
  ThreadTeam team(2);
  ForceWorkspace workspace;
  Mat3 F;
  F << 1.2, 0.1, -0.05, 0.02, 0.9, 0.1, 0.1, -0.1, 1.1;
  NodalVector x, force;
  for (const Vec3& X : model.rest_positions()) x.push_back(F * X);
  EXPECT_TRUE(ElasticForce(model, std::array{0.0}, x, team, workspace, force).valid);
  for (const double theta : workspace.ratio) EXPECT_NEAR(theta, F.determinant(), 1e-13);
  int inner = 0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const Vec3& X = model.rest_positions()[n];
    if ((X.array() < 1e-9).any() || (X.array() > kMixedSize.array() - 1e-9).any()) continue;
    ++inner;
    EXPECT_LT(force[n].norm(), 1e-12 * LargestNorm(force)) << n;
  }
  EXPECT_GE(inner, 8 + 9);
}

// Blocks of repeated nodes count twice: the matrix is the derivative of the force.
TEST(WedgesTest, MatrixIsTheDerivativeOfTheForce) {
  const Scene scene = MixedScene(CrookedMixedBox(kMixedSize, {3, 3, 2}, 8e-4), NeoHookean(std::array{1e4, 0.3}));
  const TetModel model(scene);
  ThreadTeam team(1);
  ForceWorkspace workspace;
  const BlockPattern pattern = PatternOfElements(model.nodes(), model.elements(),
                                                 [&](std::size_t e) { return model.NodesOf<HexahedralElement>(e); });
  const StiffnessLayout layout(model, pattern);
  const std::array<double, 1> activation = {0};
  IncrementalPotential potential;
  potential.drive = FibreDrive{activation};
  const NodalVector x = Shaken(model.rest_positions(), 5e-4, 8), p = RandomVectors(x.size(), 11);
  BlockValues values(pattern.blocks());
  AssembleStiffness(model, potential, x, {}, layout, team, workspace, values);
  const BlockValues plain = PlainStiffness(model, potential, x, {}, pattern, false);
  double largest = 0, apart = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    largest = std::max(largest, values[k].cwiseAbs().maxCoeff());
    apart = std::max(apart, (values[k] - plain[k]).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(apart, 1e-13 * largest);
  NodalVector product, ahead = x, behind = x, force_ahead, difference;
  Multiply(pattern, values, p, team, product);
  const double h = 1e-8;
  for (std::size_t n = 0; n < p.size(); ++n) {
    ahead[n] += h * p[n];
    behind[n] -= h * p[n];
  }
  EvaluateElements(model, potential, ahead, {}, team, workspace, force_ahead);
  EvaluateElements(model, potential, behind, {}, team, workspace, difference);
  for (std::size_t n = 0; n < p.size(); ++n) difference[n] = (difference[n] - force_ahead[n]) / (2 * h);
  EXPECT_LT(LargestDifference(product, difference), 1e-6 * LargestNorm(product));
}

// The nearly incompressible cantilever of wedges and pyramids beside hexahedra: it bends as far as hexahedra do.
TEST(WedgesTest, DoNotLock) {
  const auto tip_of = [](TetMesh mesh) {
    Body body = MakeBody("beam", std::move(mesh), NearlyIncompressible());
    body.constraints = {Fix(kX0)};
    body.loads.push_back({kX1, Traction{Vec3(0, 0, -5e-4 / 1e-6)}, Ramp(1), {}});
    SteppedRun run(StaticScene(std::move(body), ElementOrder::kHexahedral));
    EXPECT_TRUE(run.To(1));
    EXPECT_LT(run.solver.EquilibriumResidual(run.state), 1e-6);
    return 1e3 * run.DisplacementAt(kCantileverTip)[2];
  };
  const Vec3 size(0.01, 0.001, 0.001);
  const double hexahedra = tip_of(MakeBox(Vec3::Zero(), size, {40, 4, 4}, Cells::kHexahedra));
  const double mixed = tip_of(MixedBox(size, {40, 4, 4}));
  std::printf("f with 40 x 4 x 4 cells: hexahedra %.4f mm, beside wedges and pyramids %.4f mm\n", hexahedra, mixed);
  EXPECT_NEAR(mixed, hexahedra, 0.03 * std::abs(hexahedra));
}

TEST(WedgesTest, OtherRepetitionsAreRefused) {
  TetMesh mesh = MakeBox(Vec3::Zero(), kMixedSize, {2, 1, 1}, Cells::kHexahedra);
  mesh.hexahedra[1][2] = mesh.hexahedra[1][1];
  Problems problems;
  CheckMesh(mesh, problems);
  EXPECT_NE(problems.ToString().find("hexahedron has repeated nodes, but is neither a wedge nor a pyramid: 1"),
            std::string::npos)
      << problems.ToString();
}

TEST(WedgesTest, QuadraticHexahedraRefuseThem) {
  Scene scene = MixedScene(MixedBox(kMixedSize, {2, 2, 1}), NearlyIncompressible());
  scene.tet.element = ElementOrder::kHexahedralQuadratic;
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_NE(problems.ToString().find("wedges and pyramids, which cannot have 27 nodes"), std::string::npos)
      << problems.ToString();
}

// Written for Gmsh and read again.
TEST(WedgesTest, FilesKeepThem) {
  TetMesh mesh = MixedBox(kMixedSize, {2, 2, 1});
  for (const std::int32_t h : HexahedraOfTetrahedra(mesh)) mesh.tetrahedron_tags.push_back(1 + h % 2);
  Problems problems;
  const std::string text = GmshText(mesh, {});
  const auto read = ReadMesh({.name = "m.msh", .bytes = text, .solids = Solids::kKeep}, problems);
  ASSERT_TRUE(read) << problems.ToString();
  EXPECT_EQ(read->hexahedra, mesh.hexahedra);
  EXPECT_EQ(read->tetrahedron_tags, mesh.tetrahedron_tags);
}

}  // namespace
}  // namespace fascicle
