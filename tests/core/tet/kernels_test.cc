// The vectorized loops over chunks of elements against the laws themselves, element by element, and against each other:
// all instruction sets of this machine, any number of threads.
#include "core/tet/kernels.h"

#include <gtest/gtest.h>

#include <cstring>

#include "core/tet/points.h"
#include "core/tet/potential.h"
#include "core/tet/stable_step.h"
#include "mixed_scene.h"
#include "tests/support/tet_stepper.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// A plain version of ElasticAndViscousForce: one element after another, with Eigen's matrices, and theta and pressure
// summed from the elements.
struct PlainForces {
  PlainForces(const Setting& s, bool viscous) : force(s.x.size(), Vec3::Zero()) {
    s.model.VisitElement([&]<class Element>(Element) { Add<Element>(s, viscous); });
  }
  template <class Element>
  void Add(const Setting& s, bool viscous) {
    const TetModel& model = s.model;
    const VolumePatches& patches = model.patches();
    std::vector<double> theta(patches.size(), 0.0), smooth(patches.size()), own(patches.size()), acting(patches.size());
    for (std::size_t e = 0; e < model.elements() && !patches.empty(); ++e) {
      if (patches.of_element[e][0] == VolumePatches::kNone) continue;
      for (int q = 0; q < Element::kPoints; ++q) {
        const double J = Determinant(GradientAt<Element>(model, e, ValuesOf<Element>(model, e, s.x), q));
        for (int c = 0; c < Element::kPatches; ++c) {
          const std::int32_t n = patches.of_element[e][c];
          theta[n] +=
              Element::PatchWeight(q, c) * model.rest_volume()[Element::kPoints * e + q] * J / patches.rest_volume[n];
        }
      }
    }
    patches.Smooth(theta, smooth);
    for (std::size_t n = 0; n < patches.size(); ++n) own[n] = PatchEnergy{patches.modulus[n]}.Pressure(smooth[n]);
    patches.Smooth(own, acting);
    for (const TetGroup& group : model.groups()) {
      const TetBody& body = model.bodies()[group.body];
      std::visit(
          [&](const auto& laws) {
            for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
              std::array<Vec3, Element::kNodes> forces;
              forces.fill(Vec3::Zero());
              for (int q = 0; q < Element::kPoints; ++q) {
                const Mat3 F = GradientAt<Element>(model, e, ValuesOf<Element>(model, e, s.x), q);
                const double volume = model.rest_volume()[Element::kPoints * e + q];
                const auto& law = laws[model.law_of()[e]];
                const FibreState fibre = FibreAt<Element>(model, e, s.drive, q);
                Mat3 P = law.Stress(F, fibre);
                P += PatchPressure<Element>(patches, acting, e, q) * Cofactor(F);
                smallest = std::min(smallest, Determinant(F));
                energy[group.body] += volume * law.Energy(F, fibre);
                if (viscous) {
                  const Mat3 rate = GradientAt<Element>(model, e, ValuesOf<Element>(model, e, s.v), q);
                  const ViscousStress stress(F, rate, body.damping_mu, body.damping_lambda);
                  P += F * stress.S;
                  power += volume * stress.power;
                }
                CornerValues corners;
                SetCornerForces(P, model.Dm_inverse()[Element::kPoints * e + q], volume, corners);
                Element::AddCorners(corners, q, forces);
              }
              const auto nodes = model.NodesOf<Element>(e);
              for (int a = 0; a < Element::kNodes; ++a) force[nodes[a]] += forces[a];
            }
          },
          group.laws);
    }
    for (std::size_t e = 0; e < model.elements() && !patches.empty(); ++e) {
      if (patches.of_element[e][0] == VolumePatches::kNone) continue;
      const std::size_t body = e >= model.bodies()[1].tet_begin;
      for (int c = 0; c < Element::kPatches; ++c) {
        const std::int32_t n = patches.of_element[e][c];
        energy[body] += model.CornerVolume<Element>(e, c) * PatchEnergy{patches.modulus[n]}.Value(smooth[n]);
      }
    }
  }

  NodalVector force;
  double smallest = 1, power = 0;
  std::array<double, 2> energy = {};
};

using Case = std::tuple<int, ElementOrder, VolumeForm>;

class KernelsTest : public ::testing::TestWithParam<Case> {
 protected:
  const Material law_ = LawsOfKernels()[std::get<0>(GetParam())];
  const Setting s_{law_, std::get<1>(GetParam()), std::get<2>(GetParam()), 4};
  ThreadTeam team_{1};
};

TEST_P(KernelsTest, ForcesAreThoseOfTheLaws) {
  const PlainForces plain(s_, true);
  for (const InstructionSet set : kInstructionSets) {
    if (!IsAvailable(set)) continue;
    ForceWorkspace workspace;
    workspace.kernels = &KernelsFor(set);
    NodalVector force;
    const ForceReport report = ElasticAndViscousForce(s_.model, s_.drive, s_.x, s_.v, team_, workspace, force);
    EXPECT_TRUE(report.valid);
    EXPECT_NEAR(report.smallest_ratio, plain.smallest, 1e-14);
    EXPECT_NEAR(report.dissipated_power, plain.power, 1e-13 * plain.power);
    // Forces of neighbouring elements nearly cancel: to the round-off of the summands.
    EXPECT_LT(LargestDifference(force, plain.force), 1e-12 * LargestNorm(plain.force));
  }
}

TEST_P(KernelsTest, EnergyIsThatOfTheLaws) {
  const PlainForces plain(s_, false);
  for (std::size_t body = 0; body < 2; ++body) {
    const double energy = ElasticEnergy(s_.model, body, s_.drive, s_.x, team_);
    EXPECT_NEAR(energy, plain.energy[body], 1e-12 * std::abs(plain.energy[body])) << body;
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, KernelsTest,
                         ::testing::Combine(::testing::Range(0, kLawsOfKernels), ::testing::ValuesIn(kEveryElement),
                                            ::testing::Values(VolumeForm::kNodal, VolumeForm::kElement)));

// All instruction sets and any number of threads: the same bits.
class SameBitsTest : public ::testing::TestWithParam<std::tuple<int, ElementOrder>> {};

TEST_P(SameBitsTest, AnySetAnyThreads) {
  const auto [law, element] = GetParam();
  constexpr std::array kAcross = {9, 8, 14, 8};  // for several chunks
  const Setting s(LawsOfKernels()[law], element, VolumeForm::kNodal, kAcross[static_cast<std::size_t>(element)]);
  ASSERT_GT(s.model.chunks().chunks.size(), 5u);
  NodalVector first, first_product;
  double power = 0;
  for (const InstructionSet set : kInstructionSets) {
    if (!IsAvailable(set)) continue;
    for (const int threads : {1, 2, 4}) {
      ThreadTeam team(threads);
      ForceWorkspace workspace;
      workspace.kernels = &KernelsFor(set);
      NodalVector force, product;
      const ForceReport report = ElasticAndViscousForce(s.model, s.drive, s.x, s.v, team, workspace, force);
      TetStiffness stiffness;
      stiffness.Set(s.model, s.drive, s.x, team, workspace);
      stiffness.Apply(s.model, s.v, team, workspace, product);
      if (first.empty()) {
        first = force;
        first_product = product;
        power = report.dissipated_power;
      }
      EXPECT_EQ(std::memcmp(first.data(), force.data(), sizeof(Vec3) * force.size()), 0) << threads;
      EXPECT_EQ(std::memcmp(first_product.data(), product.data(), sizeof(Vec3) * force.size()), 0) << threads;
      EXPECT_EQ(power, report.dissipated_power) << threads;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, SameBitsTest,
                         ::testing::Combine(::testing::Range(0, kLawsOfKernels), ::testing::ValuesIn(kEveryElement)));

// In single precision: forces to six digits of the largest, the same bits with any set and threads.
class SingleTest : public ::testing::TestWithParam<std::tuple<int, ElementOrder>> {};

TEST_P(SingleTest, ForcesToSixDigits) {
  const auto [law, element] = GetParam();
  const Setting s(LawsOfKernels()[law], element, VolumeForm::kNodal, element == ElementOrder::kLinear ? 9 : 6);
  Scene scene = s.scene;
  scene.tet.precision = Precision::kSingle;
  const TetModel model(scene);
  const auto evaluate = [&](const TetModel& m, InstructionSet set, int threads, NodalVector& force) {
    ThreadTeam team(threads);
    ForceWorkspace workspace;
    workspace.kernels = &KernelsFor(set);
    return ElasticAndViscousForce(m, s.drive, s.x, s.v, team, workspace, force);
  };
  NodalVector expected, first, force;
  const ForceReport exact = evaluate(s.model, InstructionSet::kBaseline, 1, expected);
  const ForceReport single = evaluate(model, InstructionSet::kBaseline, 1, first);
  EXPECT_TRUE(single.valid);
  EXPECT_LT(LargestDifference(first, expected), 2e-5 * LargestNorm(expected));
  // Positions relative to the chunk, ten edges wide, to 6e-8 of that; J is cubic in the edges.
  EXPECT_NEAR(single.smallest_ratio, exact.smallest_ratio, 3 * 10 * 6e-8);
  EXPECT_NEAR(single.dissipated_power, exact.dissipated_power, 1e-5 * exact.dissipated_power);
  for (const InstructionSet set : kInstructionSets) {
    if (!IsAvailable(set)) continue;
    for (const int threads : {1, 3}) {
      evaluate(model, set, threads, force);
      EXPECT_EQ(std::memcmp(first.data(), force.data(), sizeof(Vec3) * force.size()), 0) << threads;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Laws, SingleTest,
                         ::testing::Combine(::testing::Range(0, kLawsOfKernels), ::testing::ValuesIn(kEveryElement)));

// A muscle between fixed ends that contracts to full activation and vibrates: single precision against double.
TEST(SingleTest, ContractionFollowsDouble) {
  const auto run = [](Precision precision) {
    Body body =
        BoxBody(Vec3(0.04, 0.01, 0.01), {12, 3, 3}, Muscle(std::array{5e2, 5e2, 1e6, 3e5, 1.2, 0.05, 6.6, 1.4}));
    body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3(1, 0.2, 0));
    body.constraints = {Fix(kX0), Fix(kX1)};
    body.activation = Curve{{0, 0.02}, {0, 1}, Curve::Interpolation::kSmooth};
    body.damping.mass_proportional = 50;
    Scene scene = OneBody(std::move(body));
    scene.tet.precision = precision;
    const TetModel model(scene);
    ThreadTeam team(1);
    TetStepper solver(model, team);
    TetState state = solver.InitialState();
    while (state.time < 0.03) EXPECT_EQ(solver.Advance(state, 0.03).problem, StepProblem::kNone);
    NodalVector displacement = state.positions;
    for (std::size_t n = 0; n < displacement.size(); ++n) displacement[n] -= model.rest_positions()[n];
    return displacement;
  };
  const NodalVector exact = run(Precision::kDouble), single = run(Precision::kSingle);
  const double error = LargestDifference(exact, single) / LargestNorm(exact);
  RecordProperty("error", std::to_string(error));
  EXPECT_GT(LargestNorm(exact), 5e-4);
  EXPECT_LT(error, 1e-4);
  EXPECT_GT(error, 0);
}

}  // namespace
}  // namespace fascicle
