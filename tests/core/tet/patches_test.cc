// Volume ratios averaged around nodes, or over hexahedra.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <map>

#include "core/tet/fields.h"
#include "core/tet/points.h"
#include "core/tet/stable_step.h"
#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

const Vec3 kPatchSize(0.03, 0.02, 0.02);

// A box whose interior nodes are displaced.
TetMesh IrregularBox(const std::array<int, 3>& divisions, ElementOrder element) {
  TetMesh mesh = MakeBox(Vec3::Zero(), kPatchSize, divisions, CellsOf(element));
  std::vector<bool> inside(mesh.nodes.size(), true);
  for (const Triangle& t : BoundaryTriangles(mesh)) {
    for (const std::int32_t n : t) inside[n] = false;
  }
  const NodalVector shaken = Shaken(mesh.nodes, 1e-3, 5);
  for (std::size_t n = 0; n < inside.size(); ++n) {
    if (inside[n]) mesh.nodes[n] = shaken[n];
  }
  return mesh;
}

struct Patched {
  Patched(ElementOrder element, const Material& law, TetMesh mesh) : scene(OneBody(MakeBody("box", mesh, law))) {
    scene.tet.element = element;
    model = std::make_unique<TetModel>(scene);
  }

  NodalVector ForceAt(const NodalVector& x) {
    NodalVector force;
    EXPECT_TRUE(ElasticForce(*model, activation, x, team, workspace, force).valid);
    return force;
  }
  double EnergyAt(const NodalVector& x) { return ElasticEnergy(*model, 0, activation, x, team); }

  Scene scene;
  std::unique_ptr<TetModel> model;
  ThreadTeam team{1};
  ForceWorkspace workspace;
  const std::array<double, 1> activation = {0.6};
};

class PatchesTest : public ::testing::TestWithParam<ElementOrder> {};

// A linear displacement on an irregular mesh: no force on interior nodes.
TEST_P(PatchesTest, LinearDisplacementIsInEquilibrium) {
  Patched box(GetParam(), NearlyIncompressible(), IrregularBox({4, 3, 3}, GetParam()));
  const NodalVector& X = box.model->rest_positions();
  const std::size_t patches = GetParam() == ElementOrder::kHexahedral            ? 36
                              : GetParam() == ElementOrder::kHexahedralQuadratic ? 4 * 36
                                                                                 : 80;
  ASSERT_EQ(box.model->patches().size(), patches);
  Mat3 F;
  F << 1.2, 0.1, -0.05, 0.02, 0.9, 0.1, 0.1, -0.1, 1.1;
  NodalVector x;
  for (const Vec3& rest : X) x.push_back(F * rest);
  const NodalVector force = box.ForceAt(x);
  for (const double theta : box.workspace.ratio) EXPECT_NEAR(theta, F.determinant(), 1e-13);
  int inner = 0;
  for (std::size_t n = 0; n < X.size(); ++n) {
    if ((X[n].array() < 1e-9).any() || (X[n].array() > kPatchSize.array() - 1e-9).any()) continue;
    ++inner;
    EXPECT_LT(force[n].norm(), 1e-12 * LargestNorm(force)) << "node " << n;
  }
  EXPECT_GE(inner, box.model->nodes() > 200 ? 175 : 12);
}

std::vector<Material> PatchedLaws() {
  return {NearlyIncompressible(), Muscle(std::array{5e2, 5e2, 1e6, 3e4, 1.2, 0.05, 6.6, 1.4})};
}

// f = -dPhi/dx against a sixth-order central difference, at corners and, for quadratic elements, at mid-edge nodes.
TEST_P(PatchesTest, ForceIsMinusGradientOfEnergy) {
  for (const Material& law : PatchedLaws()) {
    Patched box(GetParam(), law, IrregularBox({3, 2, 2}, GetParam()));
    const NodalVector x = Shaken(box.model->rest_positions(), 3e-4, 7);
    const NodalVector force = box.ForceAt(x);
    const double h = 3e-7;
    for (const std::size_t n : {std::size_t{0}, std::size_t{17}, x.size() - 1}) {
      for (int c = 0; c < 3; ++c) {
        const auto rise = [&](double shift) {
          NodalVector ahead = x, behind = x;
          ahead[n][c] += shift;
          behind[n][c] -= shift;
          return box.EnergyAt(ahead) - box.EnergyAt(behind);
        };
        const double slope = (45 * rise(h) - 9 * rise(2 * h) + rise(3 * h)) / (60 * h);
        EXPECT_NEAR(force[n][c], -slope, 1e-7 * LargestNorm(force)) << "node " << n << " axis " << c;
      }
    }
  }
}

// K p against a difference of forces; K is stored in float.
TEST_P(PatchesTest, StiffnessIsDerivativeOfForce) {
  for (const Material& law : PatchedLaws()) {
    Patched box(GetParam(), law, IrregularBox({3, 2, 2}, GetParam()));
    const NodalVector x = Shaken(box.model->rest_positions(), 3e-4, 7);
    TetStiffness stiffness;
    stiffness.Set(*box.model, box.activation, x, box.team, box.workspace);
    const NodalVector p = RandomVectors(x.size(), 11);
    NodalVector product;
    stiffness.Apply(*box.model, p, box.team, box.workspace, product);
    const double h = 1e-8;
    NodalVector ahead = x, behind = x;
    for (std::size_t n = 0; n < p.size(); ++n) {
      ahead[n] += h * p[n];
      behind[n] -= h * p[n];
    }
    NodalVector difference = box.ForceAt(behind);
    const NodalVector force_ahead = box.ForceAt(ahead);
    for (std::size_t n = 0; n < p.size(); ++n) difference[n] = (difference[n] - force_ahead[n]) / (2 * h);
    EXPECT_LT(LargestDifference(product, difference), 1e-5 * LargestNorm(product));
  }
}

// The element of a tetrahedron.
std::size_t ElementOf(const TetMesh& mesh, std::size_t t) { return mesh.hexahedra.empty() ? t : t / 6; }

// Rms difference between neighbouring elements relative to the rms deviation from the mean.
double RelativeJump(const TetMesh& mesh, const std::vector<double>& values) {
  std::map<Triangle, std::vector<std::size_t>> faces;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (int opposite = 0; opposite < 4; ++opposite) {
      Triangle face;
      for (int c = 0, k = 0; c < 4; ++c) {
        if (c != opposite) face[k++] = mesh.tetrahedra[t][c];
      }
      std::sort(face.begin(), face.end());
      faces[face].push_back(ElementOf(mesh, t));
    }
  }
  double mean = 0, variance = 0, jumps = 0;
  int inner = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) variance += (value - mean) * (value - mean) / static_cast<double>(values.size());
  for (const auto& [face, sides] : faces) {
    if (sides.size() != 2 || sides[0] == sides[1]) continue;
    ++inner;
    jumps += std::pow(values[sides[0]] - values[sides[1]], 2);
  }
  return std::sqrt(jumps / inner / variance);
}

// If pressures alternate from node to node, neighbours differ by more than the spread of the field.
TEST_P(PatchesTest, PressuresOfABentBeamDoNotAlternate) {
  const bool linear = GetParam() == ElementOrder::kLinear;
  // Pressures that are constant in each of two hexahedra across the beam would have the signs of its two halves.
  // Those of 27 nodes are linear, but the means of two have these signs, too; InfSupTest speaks for them.
  if (GetParam() == ElementOrder::kHexahedralQuadratic) return;
  const int across = GetParam() == ElementOrder::kQuadratic ? 2 : 4;
  SteppedRun run(StaticScene(LockingCantilever(across, Ramp(1), CellsOf(GetParam())), GetParam()));
  ASSERT_TRUE(run.To(1));
  Controls controls;
  controls.activations = {0};
  const std::vector<double> pressures =
      FieldValuesOf(run.model, 0, OutputField::kPressure, run.state, {controls, controls}, run.team);
  const double jump = RelativeJump(run.scene.bodies[0].tet().mesh, pressures);
  std::printf("%s: rms jump of the pressure over its rms %.3f\n", ElementNameOf(GetParam()).c_str(), jump);
  EXPECT_LT(jump, linear ? 0.45 : 0.6);
}

INSTANTIATE_TEST_SUITE_P(Elements, PatchesTest, ::testing::ValuesIn(kEveryElement),
                         [](const auto& element) { return ElementNameOf(element.param); });

// The numerical inf-sup test [Chapelle & Bathe 1993]: the stationary values of
//   sup_v (q, div v) / (|grad v| |q|)
// over pressures q of the patches, with v zero at both ends of a unit cube of n^3 hexahedra, ascending: the square
// roots of the eigenvalues of B A^-1 B^T with respect to diag(V). The inf-sup constant is the least. `smooth`: with W.
Eigen::VectorXd InfSupValues(ElementOrder order, int n, bool smooth) {
  Body body = BoxBody(Vec3::Ones(), {n, n, n}, NearlyIncompressible(), CellsOf(order));
  body.constraints = {Fix(kZ0), Fix(kZ1)};
  Scene scene = OneBody(std::move(body));
  scene.tet.element = order;
  const TetModel model(scene);
  std::vector<int> unknown(model.nodes(), -1);
  int count = 0;
  for (std::size_t node = 0; node < model.nodes(); ++node) {
    if (model.inverse_mass()[node][0] != 0) unknown[node] = count++;
  }
  const VolumePatches& patches = model.patches();
  const auto size = static_cast<int>(patches.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count, count);  // of one component: the same for all three
  std::array<Eigen::MatrixXd, 3> B;
  B.fill(Eigen::MatrixXd::Zero(count, size));
  model.VisitElement([&]<class Element>(Element) {
    for (std::size_t e = 0; e < model.elements(); ++e) {
      const auto nodes = model.NodesOf<Element>(e);
      for (int q = 0; q < Element::kPoints; ++q) {
        const auto gradients = ShapeGradients<Element>(model, e, q);
        const double volume = model.rest_volume()[Element::kPoints * e + q];
        for (int a = 0; a < Element::kNodes; ++a) {
          const int i = unknown[nodes[a]];
          if (i < 0) continue;
          for (int b = 0; b < Element::kNodes; ++b) {
            const int j = unknown[nodes[b]];
            if (j >= 0) A(i, j) += volume * gradients.col(a).dot(gradients.col(b));
          }
          for (int c = 0; c < Element::kPatches; ++c) {
            const double share = volume * Element::PatchWeight(q, c);
            for (int axis = 0; axis < 3; ++axis) B[axis](i, patches.of_element[e][c]) += share * gradients(axis, a);
          }
        }
      }
    }
  });
  const Eigen::LLT<Eigen::MatrixXd> factor(A);
  const Eigen::VectorXd volumes = Eigen::Map<const Eigen::VectorXd>(patches.rest_volume.data(), size);
  Eigen::MatrixXd W = Eigen::MatrixXd::Identity(size, size);
  if (smooth) {
    for (int m = 0; m < size; ++m) {
      std::vector<double> unit(size, 0.0), column(size);
      unit[m] = 1;
      patches.Smooth(unit, column);
      W.col(m) = Eigen::Map<const Eigen::VectorXd>(column.data(), size);
    }
  }
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(size, size);
  for (const Eigen::MatrixXd& part : B) {
    const Eigen::MatrixXd acting = part * W;
    S += acting.transpose() * factor.solve(acting);
  }
  const Eigen::VectorXd scale = volumes.cwiseSqrt().cwiseInverse();
  S = scale.asDiagonal() * S * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(S, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
}

// Quadratic elements stay clear of zero on any mesh. With linear ones some pressures act on no displacement; smoothing
// adds pressures that alternate from node to node and almost do not, and keeps them off the elements.
TEST(InfSupTest, QuadraticElementsAreStable) {
  constexpr double kZero = 1e-6;
  std::array<double, 5> quadratic = {}, of_hexahedra = {};
  for (const int n : {2, 3, 4}) {
    quadratic[n] = InfSupValues(ElementOrder::kQuadratic, n, false)[0];
    of_hexahedra[n] = InfSupValues(ElementOrder::kHexahedralQuadratic, n, false)[0];
    std::printf("inf-sup constant at %d^3 hexahedra: quadratic %.4f, of hexahedra %.4f", n, quadratic[n],
                of_hexahedra[n]);
    for (const bool smooth : {false, true}) {
      const Eigen::VectorXd linear = InfSupValues(ElementOrder::kLinear, n, smooth);
      const auto zeros = (linear.array() < kZero).count();
      std::printf("; linear%s %.4f beside %d zeros of %d", smooth ? " smoothed" : "", linear[zeros],
                  static_cast<int>(zeros), static_cast<int>(linear.size()));
    }
    std::printf("\n");
  }
  EXPECT_GT(quadratic[2], 0.2);
  EXPECT_GT(quadratic[3], 0.95 * quadratic[2]);
  EXPECT_GT(quadratic[4], 0.95 * quadratic[3]);
  // 0.71, 0.63, 0.61: few pressures have their neighbours on all sides on the coarsest mesh.
  EXPECT_GT(of_hexahedra[3], 0.6);
  EXPECT_GT(of_hexahedra[4], 0.95 * of_hexahedra[3]);
}

}  // namespace
}  // namespace fascicle
