// Element matrices for Newton's method, against the laws point by point and against differences.
#include "core/tet/element_matrices.h"

#include <gtest/gtest.h>

#include <cstring>

#include "mixed_scene.h"
#include "plain_stiffness.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// A potential with everything the kernels support: activation, rate, viscous increment, pressures of patches.
struct LoadedMatrix : Setting {
  LoadedMatrix(const Material& law, ElementOrder element, VolumeForm volume, int divisions)
      : Setting(law, element, volume, divisions) {
    potential.drive = drive;
    potential.previous = &previous;
    potential.viscous_rate = 100;
    const NodalVector random = RandomVectors(model.patches().size(), 3);
    for (const Vec3& r : random) acting.push_back(5e3 * r.x());
  }

  ElementEvaluation Evaluate(const NodalVector& at, NodalVector& force) {
    return EvaluateElements(model, potential, at, acting, team, workspace, force);
  }
  const BlockValues& Stiffness(ThreadTeam& threads) {
    AssembleStiffness(model, potential, x, acting, layout, threads, workspace, values);
    return values;
  }
  const BlockValues& Stiffness() { return Stiffness(team); }
  const BlockValues& Projection() {
    AssembleProjection(model, potential, x, acting, layout, team, workspace, values);
    return values;
  }
  BlockValues Plain(bool is_change) { return PlainStiffness(model, potential, x, acting, pattern, is_change); }

  IncrementalPotential potential;
  std::vector<double> acting;
  ThreadTeam team{1};
  ForceWorkspace workspace;
  BlockPattern pattern = model.VisitElement([&]<class Element>(Element) {
    return PatternOfElements(model.nodes(), model.elements(), [&](std::size_t e) { return model.NodesOf<Element>(e); });
  });
  StiffnessLayout layout{model, pattern};
  // Previous contents do not affect the result.
  BlockValues values = BlockValues(pattern.blocks(), Mat3::Constant(1e30));
};

double LargestOf(const BlockValues& values) {
  double largest = 0;
  for (const Mat3& v : values) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  return largest;
}

// Energy density and stress of a point under the potential, from the law and the equations of potential.h.
template <class Element, class Law>
struct PointOracle {
  PointOracle(const IncrementalPotential& potential, const TetModel& model, const TetBody& body, const Law& of_point,
              std::size_t tet, int q)
      : law(of_point), fibre(FibreAt<Element>(model, tet, potential.drive, q)) {
    if (potential.viscous_rate == 0) return;
    mu = body.damping_mu * potential.viscous_rate;
    lambda = body.damping_lambda * potential.viscous_rate;
    const Mat3 F = GradientAt<Element>(model, tet, ValuesOf<Element>(model, tet, *potential.previous), q);
    previous_C = F.transpose() * F;
  }
  Mat3 StrainChange(const Mat3& F) const { return 0.5 * (F.transpose() * F - previous_C); }
  double Energy(const Mat3& F) const {
    const Mat3 dE = StrainChange(F);
    return law.Energy(F, fibre) + mu * dE.squaredNorm() + 0.5 * lambda * dE.trace() * dE.trace();
  }
  Mat3 Stress(const Mat3& F) const {
    const Mat3 dE = StrainChange(F);
    return law.Stress(F, fibre) + F * (2 * mu * dE + lambda * dE.trace() * Mat3::Identity());
  }

  const Law& law;
  FibreState fibre;
  double mu = 0, lambda = 0;
  Mat3 previous_C = Mat3::Identity();
};

using Case = std::tuple<int, ElementOrder, VolumeForm>;
class ElementMatricesTest : public ::testing::TestWithParam<Case> {
 protected:
  LoadedMatrix s_{LawsOfKernels()[std::get<0>(GetParam())], std::get<1>(GetParam()), std::get<2>(GetParam()), 3};
};

TEST_P(ElementMatricesTest, EvaluationIsThatOfThePotentialAtEveryPoint) {
  double energy = 0, smallest = 1, squares = 0;
  NodalVector expected(s_.x.size(), Vec3::Zero()), force;
  const TetModel& model = s_.model;
  model.VisitElement([&]<class Element>(Element) {
    for (const TetGroup& group : model.groups()) {
      const TetBody& body = model.bodies()[group.body];
      std::visit(
          [&]<class Law>(const std::vector<Law>& laws) {
            for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
              std::array<Vec3, Element::kNodes> forces;
              forces.fill(Vec3::Zero());
              for (int q = 0; q < Element::kPoints; ++q) {
                const std::size_t at = Element::kPoints * e + q;
                const Mat3 F = GradientAt<Element>(model, e, ValuesOf<Element>(model, e, s_.x), q);
                const PointOracle<Element, Law> point(s_.potential, model, body, laws[model.law_of()[e]], e, q);
                energy += model.rest_volume()[at] * point.Energy(F);
                smallest = std::min(smallest, Determinant(F));
                const Mat3 P = point.Stress(F) + PatchPressure<Element>(model.patches(), s_.acting, e, q) * Cofactor(F);
                CornerValues corners;
                SetCornerForces(P, model.Dm_inverse()[at], model.rest_volume()[at], corners);
                Element::AddCorners(corners, q, forces);
              }
              const auto nodes = model.NodesOf<Element>(e);
              for (int a = 0; a < Element::kNodes; ++a) {
                expected[nodes[a]] += forces[a];
                squares += forces[a].squaredNorm();
              }
            }
          },
          group.laws);
    }
  });
  const ElementEvaluation evaluation = s_.Evaluate(s_.x, force);
  EXPECT_TRUE(evaluation.finite);
  EXPECT_NEAR(evaluation.energy, energy, 1e-12 * std::abs(energy));
  EXPECT_NEAR(evaluation.smallest_ratio, smallest, 1e-14);
  EXPECT_NEAR(evaluation.squares, squares, 1e-12 * squares);
  EXPECT_LT(LargestDifference(force, expected), 1e-12 * LargestNorm(expected));
}

TEST_P(ElementMatricesTest, SideBySideAsPointByPoint) {
  const BlockValues plain = s_.Plain(false);
  const double largest = LargestOf(plain);
  BlockValues first;
  for (const InstructionSet set : kInstructionSets) {
    if (!IsAvailable(set)) continue;
    s_.workspace.kernels = &KernelsFor(set);
    const BlockValues lanes = s_.Stiffness();
    for (std::size_t i = 0; i < plain.size(); ++i) {
      ASSERT_LT((lanes[i] - plain[i]).cwiseAbs().maxCoeff(), 1e-13 * largest) << i;
    }
    if (first.empty()) first = lanes;
    EXPECT_EQ(first, lanes);
  }
  const BlockValues change = s_.Plain(true), projection = s_.Projection();
  for (std::size_t i = 0; i < plain.size(); ++i) {
    ASSERT_LT((projection[i] - change[i]).cwiseAbs().maxCoeff(), 1e-12 * largest) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, ElementMatricesTest,
                         ::testing::Combine(::testing::Range(0, kLawsOfKernels), ::testing::ValuesIn(kEveryElement),
                                            ::testing::Values(VolumeForm::kNodal, VolumeForm::kElement)));

NodalVector Product(LoadedMatrix& s, const NodalVector& p) {
  NodalVector product;
  Multiply(s.pattern, s.Stiffness(), p, s.team, product);
  return product;
}

class DerivativesTest : public ::testing::TestWithParam<std::tuple<ElementOrder, bool>> {};

TEST_P(DerivativesTest, BlocksAreThoseOfTheForce) {
  const auto [element, untangling] = GetParam();
  LoadedMatrix s(LawsOfKernels()[5], element, VolumeForm::kNodal, 3);
  s.potential.untangling = untangling;
  if (untangling) std::fill(s.acting.begin(), s.acting.end(), 0.0);
  const NodalVector p = RandomVectors(s.x.size(), 11), product = Product(s, p);
  const double h = 1e-8;
  NodalVector ahead = s.x, behind = s.x, force_ahead, difference;
  for (std::size_t n = 0; n < p.size(); ++n) {
    ahead[n] += h * p[n];
    behind[n] -= h * p[n];
  }
  const double energy_ahead = s.Evaluate(ahead, force_ahead).energy;
  const double energy_behind = s.Evaluate(behind, difference).energy;
  for (std::size_t n = 0; n < p.size(); ++n) difference[n] = (difference[n] - force_ahead[n]) / (2 * h);
  EXPECT_LT(LargestDifference(product, difference), 1e-6 * LargestNorm(product));
  if (!untangling) return;
  // Without pressures, whose energy is not included here, the force is the gradient of the energy.
  NodalVector force;
  s.Evaluate(s.x, force);
  EXPECT_NEAR((energy_ahead - energy_behind) / (2 * h), -Dot(s.team, force, p), 1e-6 * LargestNorm(force));
}
INSTANTIATE_TEST_SUITE_P(Potentials, DerivativesTest,
                         ::testing::Combine(::testing::ValuesIn(kEveryElement), ::testing::Bool()));

// In several chunks: the matrix is symmetric, its product equals the matrix-free one, and its bits do not depend on the
// number of threads.
class AssembleStiffnessTest : public ::testing::TestWithParam<ElementOrder> {};

TEST_P(AssembleStiffnessTest, AddsEveryBlockInItsPlace) {
  LoadedMatrix s(LawsOfKernels()[5], GetParam(), VolumeForm::kElement,
                 std::array{11, 6, 11, 6}[static_cast<std::size_t>(GetParam())]);
  ASSERT_GT(s.model.chunks().chunks.size(), 1u);
  std::vector<BlockValues> results;
  for (const int threads : {1, 2, 3}) {
    ThreadTeam team(threads);
    results.push_back(s.Stiffness(team));
    EXPECT_EQ(results.front(), results.back()) << threads;
  }
  const BlockValues plain = s.Plain(false);
  const double largest = LargestOf(plain);
  for (std::size_t row = 0; row < s.pattern.rows(); ++row) {
    for (std::int32_t k = s.pattern.begin[row]; k < s.pattern.begin[row + 1]; ++k) {
      ASSERT_LT((results[0][k] - plain[k]).cwiseAbs().maxCoeff(), 1e-13 * largest) << k;
      const std::int32_t mirrored = s.pattern.PlaceOf(s.pattern.column[k], static_cast<std::int32_t>(row));
      if (static_cast<std::size_t>(s.pattern.column[k]) != row) {
        ASSERT_EQ(results[0][k], results[0][mirrored].transpose()) << k;
      }
    }
  }
  // Every element counts once: the sum over the elements' own tangents along a displacement.
  const NodalVector p = RandomVectors(s.x.size(), 2), product = Product(s, p);
  NodalVector expected(p.size(), Vec3::Zero());
  s.model.VisitElement([&]<class Element>(Element) {
    for (const TetGroup& group : s.model.groups()) {
      std::visit(
          [&]<class Law>(const std::vector<Law>& laws) {
            for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
              const auto nodes = s.model.NodesOf<Element>(e);
              for (int q = 0; q < Element::kPoints; ++q) {
                const Mat3 F = GradientAt<Element>(s.model, e, ValuesOf<Element>(s.model, e, s.x), q);
                const Mat3 dF = GradientAt<Element>(s.model, e, ValuesOf<Element>(s.model, e, p), q);
                const PointTangent<Element, Law> tangent(s.potential, s.model, s.model.bodies()[group.body],
                                                         laws[s.model.law_of()[e]], e, q);
                const Vec9 dP = tangent.At(F) * Flatten(dF);
                const Mat3 dP_matrix = Eigen::Map<const Mat3>(dP.data());
                const auto G = ShapeGradients<Element>(s.model, e, q);
                for (int a = 0; a < Element::kNodes; ++a) {
                  expected[nodes[a]] += s.model.rest_volume()[Element::kPoints * e + q] * (dP_matrix * G.col(a));
                }
              }
            }
          },
          group.laws);
    }
  });
  EXPECT_LT(LargestDifference(product, expected), 1e-12 * LargestNorm(expected));
}
INSTANTIATE_TEST_SUITE_P(Elements, AssembleStiffnessTest, ::testing::ValuesIn(kEveryElement));

}  // namespace
}  // namespace fascicle
