// What Newton's method is told of the elements, against the laws point by point and against differences.
#include "core/tet/element_matrices.h"

#include <gtest/gtest.h>

#include <cstring>

#include "mixed_scene.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// A potential with all that the kernels know: activation, rate, viscous increment, pressures of patches.
struct Loaded : Setting {
  Loaded(const Material& law, ElementOrder element, VolumeForm volume, int divisions)
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
  // All blocks, then all volume changes.
  std::vector<double> Matrices(double projection) {
    const std::size_t nodes = model.nodes_per_element(), pairs = nodes * (nodes + 1) / 2;
    std::vector<double> all((9 * pairs + 12 * nodes) * model.tetrahedra());
    const auto keep = [&](const ElementMatrices& m) {
      std::copy_n(m.blocks, 9 * pairs * m.count, &all[9 * pairs * m.begin]);
      std::copy_n(m.volumes, 12 * nodes * m.count, &all[9 * pairs * model.tetrahedra() + 12 * nodes * m.begin]);
    };
    ForElementMatrices(model, potential, x, acting, projection, team, workspace, keep);
    return all;
  }

  IncrementalPotential potential;
  std::vector<double> acting;
  ThreadTeam team{1};
  ForceWorkspace workspace;
};

double LargestOf(const std::vector<double>& values) {
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

using Case = std::tuple<int, ElementOrder, VolumeForm>;
class ElementMatricesTest : public ::testing::TestWithParam<Case> {
 protected:
  Loaded s_{LawsOfKernels()[std::get<0>(GetParam())], std::get<1>(GetParam()), std::get<2>(GetParam()), 3};
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
                const PointPotential<Element, Law> point(s_.potential, model, body, laws[model.law_of()[e]], e, q);
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

// The same matrices element by element (a projection that takes part of 1e-300) and side by side.
TEST_P(ElementMatricesTest, SideBySideAsElementByElement) {
  const std::vector<double> plain = s_.Matrices(1e-300);
  const std::size_t blocks = plain.size() - 12 * s_.model.nodes_per_element() * s_.model.tetrahedra();
  const double largest = LargestOf({plain.begin(), plain.begin() + static_cast<std::ptrdiff_t>(blocks)});
  const double largest_volume = LargestOf({plain.begin() + static_cast<std::ptrdiff_t>(blocks), plain.end()});
  std::vector<double> first;
  for (const InstructionSet set : kInstructionSets) {
    if (!IsAvailable(set)) continue;
    s_.workspace.kernels = &KernelsFor(set);
    const std::vector<double> lanes = s_.Matrices(0);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      ASSERT_NEAR(lanes[i], plain[i], 1e-13 * (i < blocks ? largest : largest_volume)) << i;
    }
    if (first.empty()) first = lanes;
    EXPECT_EQ(first, lanes);
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, ElementMatricesTest,
                         ::testing::Combine(::testing::Range(0, kLawsOfKernels),
                                            ::testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic),
                                            ::testing::Values(VolumeForm::kNodal, VolumeForm::kElement)));

// The matrix of all elements times a displacement, from their blocks.
NodalVector Product(Loaded& s, const NodalVector& p) {
  NodalVector product(p.size(), Vec3::Zero());
  const auto add = [&](const ElementMatrices& m) {
    s.model.VisitElement([&]<class Element>(Element) {
      for (std::size_t k = 0; k < m.count; ++k) {
        const auto nodes = s.model.NodesOf<Element>(m.begin + k);
        for (int a = 0; a < Element::kNodes; ++a) {
          for (int b = 0; b <= a; ++b) {
            const Eigen::Map<const Mat3> block(m.Block(k, a, b));
            product[nodes[a]] += block * p[nodes[b]];
            if (a != b) product[nodes[b]] += block.transpose() * p[nodes[a]];
          }
        }
      }
    });
  };
  ForElementMatrices(s.model, s.potential, s.x, s.acting, 0, s.team, s.workspace, add);
  return product;
}

class DerivativesTest : public ::testing::TestWithParam<std::tuple<ElementOrder, bool>> {};

TEST_P(DerivativesTest, BlocksAreThoseOfTheForce) {
  const auto [element, untangling] = GetParam();
  Loaded s(LawsOfKernels()[5], element, VolumeForm::kNodal, 3);
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
  // Without pressures, which have no energy here, the force is that of the energy.
  NodalVector force;
  s.Evaluate(s.x, force);
  EXPECT_NEAR((energy_ahead - energy_behind) / (2 * h), -Dot(s.team, force, p), 1e-6 * LargestNorm(force));
}
INSTANTIATE_TEST_SUITE_P(Potentials, DerivativesTest,
                         ::testing::Combine(::testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic),
                                            ::testing::Bool()));

// Into a matrix of blocks with every third row left out: what the blocks say, and the same bits for any number of
// threads.
class AddStiffnessTest : public ::testing::TestWithParam<ElementOrder> {};

TEST_P(AddStiffnessTest, AddsEveryBlockInItsPlace) {
  Loaded s(LawsOfKernels()[5], GetParam(), VolumeForm::kNodal, GetParam() == ElementOrder::kLinear ? 8 : 4);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> place_of;
  std::vector<std::int32_t> places;
  const auto is_out = [](std::int32_t n) { return n % 3 == 0; };
  s.model.VisitElement([&]<class Element>(Element) {
    for (std::size_t e = 0; e < s.model.tetrahedra(); ++e) {
      const auto nodes = s.model.NodesOf<Element>(e);
      for (int a = 0; a < Element::kNodes; ++a) {
        for (int b = 0; b <= a; ++b) {
          const auto [low, high] = std::minmax(nodes[a], nodes[b]);
          const auto next = static_cast<std::int32_t>(place_of.size());
          if (is_out(low) || is_out(high)) {
            places.push_back(kNoBlock);
            continue;
          }
          const std::int32_t place = place_of.try_emplace({high, low}, next).first->second;
          places.push_back(nodes[a] >= nodes[b] ? place : ~place);
        }
      }
    }
  });
  NodalVector p = RandomVectors(s.x.size(), 2);
  for (std::size_t n = 0; n < p.size(); n += 3) p[n].setZero();
  const NodalVector expected = Product(s, p);
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    ThreadTeam team(threads);
    std::vector<double> values(9 * place_of.size(), 0.0);
    AddStiffness(s.model, s.potential, s.x, s.acting, 0, places, team, s.workspace, values);
    if (first.empty()) first = values;
    EXPECT_EQ(first, values) << threads;
  }
  NodalVector product(p.size(), Vec3::Zero());
  for (const auto& [nodes, place] : place_of) {
    const Eigen::Map<const Mat3> block(&first[9 * place]);
    product[nodes.first] += block * p[nodes.second];
    if (nodes.first != nodes.second) product[nodes.second] += block.transpose() * p[nodes.first];
  }
  for (std::size_t n = 0; n < p.size(); ++n) {
    if (!is_out(static_cast<std::int32_t>(n))) {
      EXPECT_LT((product[n] - expected[n]).norm(), 1e-12 * LargestNorm(expected));
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Elements, AddStiffnessTest,
                         ::testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic));

}  // namespace
}  // namespace fascicle
