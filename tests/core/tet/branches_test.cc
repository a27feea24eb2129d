// Maxwell branches at the points: their stresses against the law point by point, the tangent against differences, and
// the recurrence against its exact solution.
#include "core/tet/branches.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>

#include "core/tet/element_matrices.h"
#include "core/tet/points.h"
#include "mixed_scene.h"
#include "plain_stiffness.h"
#include "tests/support/tet_stepper.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kStepLength = 0.02;  // [s]

Scene ViscoelasticMix(const Material& law, ElementOrder element) {
  Scene scene = MixedScene(law, element, VolumeForm::kNodal, 3);
  scene.bodies[0].viscoelasticity = {{{0.7, 0.05}, {0.4, 0.3}}};
  // One part of the second body is elastic, another viscoelastic.
  TetShape& shape = scene.bodies[1].tet();
  shape.materials = {{law, law}, {}};
  for (std::size_t t = 0; t < shape.mesh.tetrahedra.size(); ++t) {
    shape.materials.of.push_back(static_cast<std::int32_t>(t * 3 / shape.mesh.tetrahedra.size()));
  }
  shape.viscoelasticity = {{{}}, {{{1.5, 0.01}}}};
  return scene;
}

struct Branched {
  Branched(const Material& law, ElementOrder element) : scene(ViscoelasticMix(law, element)), model(scene) {
    x = Shaken(model.rest_positions(), 2e-4, 7);
    for (Vec3& position : x) position += 0.05 * Vec3(position.x(), position.z(), 0.3 * position.y());
    before = x;
    for (Vec3& position : before) position.y() *= 1.01;
    // A history of two steps.
    const std::vector<double> relaxed = RelaxedBranches(model, model.rest_positions(), team, workspace);
    AdvanceBranches(model, relaxed, Shaken(before, 1e-4, 3), 0.04, team, workspace, state);
    AdvanceBranches(model, std::vector<double>(state), before, 0.01, team, workspace, state);
    SetStepDrive(model, state, kStepLength, team, branches);
    drive.branches = &branches;
  }

  Scene scene;
  TetModel model;
  ThreadTeam team{2};
  ForceWorkspace workspace;
  NodalVector x, before;
  std::vector<double> state;
  BranchDrive branches;
  std::array<double, 4> activation = {0.6, 0.3, 0.9, 0.1};
  FibreDrive drive{activation};
};

// The step's form of the stress, S_e + factor S_p + B, is the sum of the law and the branches at its end.
TEST(BranchesTest, StepEndsWithTheStressesOfItsBranches) {
  for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    for (const Material& law : EveryLaw()) {
      if (std::holds_alternative<LinearElastic>(law)) continue;
      Branched s(law, element);
      NodalVector by_step, by_state, elastic;
      ElasticForce(s.model, s.drive, s.x, s.team, s.workspace, by_step);
      std::vector<double> next;
      AdvanceBranches(s.model, s.state, s.x, kStepLength, s.team, s.workspace, next);
      BranchDrive at_end;
      SetStateDrive(s.model, next, s.team, at_end);
      FibreDrive drive = s.drive;
      drive.branches = &at_end;
      ElasticForce(s.model, drive, s.x, s.team, s.workspace, by_state);
      ElasticForce(s.model, FibreDrive{s.activation}, s.x, s.team, s.workspace, elastic);
      EXPECT_LT(LargestDifference(by_step, by_state), 1e-11 * LargestNorm(by_state));
      EXPECT_GT(LargestDifference(by_step, elastic), 1e-2 * LargestNorm(by_state));
    }
  }
}

// At every point: S_p by its definition, and H by the sum over the history of the steps.
TEST(BranchesTest, StateIsThatOfTheRecurrence) {
  Branched s(EveryLaw()[5], ElementOrder::kQuadratic);  // muscle
  const PronySeries& series = s.scene.bodies[0].viscoelasticity;
  const NodalVector steps[] = {s.model.rest_positions(), Shaken(s.before, 1e-4, 3), s.before};
  const double lengths[] = {0, 0.04, 0.01};
  const Muscle law = std::get<Muscle>(s.scene.bodies[0].material).WithVolumeModulus(0);
  BranchDrive drive;
  SetStateDrive(s.model, s.state, s.team, drive);
  double worst = 0, largest = 0;
  for (std::size_t e = 0; e < s.model.bodies()[0].tet_end; e += 5) {
    for (int q = 0; q < 4; ++q) {
      Mat3 stress[3];
      for (int n = 0; n < 3; ++n) {
        const auto at = ValuesOf<QuadraticElement>(s.model, e, steps[n]);
        const Mat3 F = GradientAt<QuadraticElement>(s.model, e, at, q);
        stress[n] = F.inverse() * law.Stress(F, {s.model.fibres()[e], 0});
      }
      Mat3 expected = Mat3::Zero();
      for (const PronyTerm& term : series.terms) {
        Mat3 H = Mat3::Zero();
        for (int n = 1; n < 3; ++n) {
          const double ratio = lengths[n] / term.time;
          H = std::exp(-ratio) * H + term.strength * (1 - std::exp(-ratio)) / ratio * (stress[n] - stress[n - 1]);
        }
        expected += H;
      }
      worst = std::max(worst, (BranchStressAt(s.model, drive, e, q) - expected).norm());
      largest = std::max(largest, expected.norm());
    }
  }
  EXPECT_GT(largest, 10);
  EXPECT_LT(worst, 1e-11 * largest);
}

// Forces are minus the derivative of the energy, and the assembled matrix is minus that of the forces.
TEST(BranchesTest, TangentIsTheDerivativeOfTheForces) {
  for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    for (const int kind : {3, 5, 10}) {  // neo-Hookean, muscle, Fung-type fibres
      Branched s(EveryLaw()[kind], element);
      IncrementalPotential potential;
      potential.drive = s.drive;
      const std::vector<double> acting(s.model.patches().size(), 0.0);
      const auto evaluate = [&](const NodalVector& at, NodalVector& force) {
        return EvaluateElements(s.model, potential, at, acting, s.team, s.workspace, force).energy;
      };
      const NodalVector direction = RandomVectors(s.model.nodes(), 11);
      const auto moved = [&](double by) {
        NodalVector at = s.x;
        for (std::size_t n = 0; n < at.size(); ++n) at[n] += by * direction[n];
        return at;
      };
      constexpr double kMove = 1e-8;
      NodalVector force, above, below;
      const double high = evaluate(moved(kMove), above), low = evaluate(moved(-kMove), below);
      evaluate(s.x, force);
      double work = 0, size = 0;
      for (std::size_t n = 0; n < force.size(); ++n) {
        work += force[n].dot(direction[n]);
        size += force[n].norm();
      }
      EXPECT_NEAR((high - low) / (2 * kMove), -work, 1e-5 * size);

      const BlockPattern pattern = s.model.VisitElement([&]<class Element>(Element) {
        return PatternOfElements(s.model.nodes(), s.model.elements(),
                                 [&](std::size_t e) { return s.model.NodesOf<Element>(e); });
      });
      const StiffnessLayout layout(s.model, pattern);
      BlockValues values(pattern.blocks(), Mat3::Zero());
      AssembleStiffness(s.model, potential, s.x, acting, layout, s.team, s.workspace, values);
      for (const BlockValues& matrix :
           {values, PlainStiffness(s.model, potential, s.x, acting, pattern, /*is_change=*/false)}) {
        NodalVector product(s.model.nodes());
        Multiply(pattern, matrix, direction, s.team, product);
        NodalVector difference(s.model.nodes());
        for (std::size_t n = 0; n < difference.size(); ++n) difference[n] = (below[n] - above[n]) / (2 * kMove);
        EXPECT_LT(LargestDifference(product, difference), 1e-5 * LargestNorm(difference)) << kind;
      }
    }
  }
}

// A step that is rejected leaves no trace: the shorter one after it has the same bits as without.
TEST(BranchesTest, RejectedStepsLeaveNoTrace) {
  for (const Stepping stepping :
       {Stepping::kExplicit, Stepping::kMixed, Stepping::kBackwardEuler, Stepping::kQuasiStatic}) {
    Body body = BoxBody(Vec3(0.02, 0.01, 0.01), {2, 1, 1}, NeoHookean(std::array{1e4, 0.3}));
    body.viscoelasticity = {{{0.8, 0.01}}};
    Constraint pull = Fix(kX1);
    pull.motion.translation[0] = Curve{{0, 0.1}, {0, 0.004}, Curve::Interpolation::kLinear};
    body.constraints = {Fix(kX0), pull};
    Scene scene = OneBody(body);
    scene.tet.stepping = stepping;
    const TetModel model(scene);
    ThreadTeam team(1);
    TetStepper plain(model, team), disturbed(model, team);
    TetState a = plain.InitialState(), b = disturbed.InitialState(), made = b;
    for (int step = 1; step <= 5; ++step) {
      const double time = 1e-5 * step;
      TetState next = a;
      ASSERT_EQ(plain.Attempt(a, time, next).problem, StepProblem::kNone);
      a = next;
      // As the step that will be rejected, one of ten times the length.
      disturbed.Attempt(b, b.time + 1e-4, made);
      next = b;
      ASSERT_EQ(disturbed.Attempt(b, time, next).problem, StepProblem::kNone);
      b = next;
      EXPECT_EQ(a.branches, b.branches);
      EXPECT_EQ(LargestDifference(a.positions, b.positions), 0);
    }
    EXPECT_FALSE(a.branches.empty());
  }
}

TEST(BranchesTest, ElasticModelsHaveNone) {
  const Scene scene = MixedScene(EveryLaw()[3], ElementOrder::kLinear, VolumeForm::kNodal, 2);
  const TetModel model(scene);
  ThreadTeam team(1);
  EXPECT_EQ(model.branch_points(), 0u);
  EXPECT_TRUE(TetStepper(model, team).InitialState().branches.empty());
}

}  // namespace
}  // namespace fascicle
