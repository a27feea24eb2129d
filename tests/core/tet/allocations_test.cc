// After its first step a solver allocates no more memory, however long the run is.
#include <gtest/gtest.h>
#include <malloc.h>

#include <Eigen/Dense>
#include <cstdio>

#include "allocation_count.h"
#include "tests/support/tet_box.h"
#include "tests/support/tet_stepper.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// Bodies of each law with everything that a scene can apply: loads, gravity, a moved and rotated support, activation
// that rises fast enough to require searches for the stable step, and every kind of damping. Together they have more
// nodes and elements than a thread takes at a time.
Scene BusyScene(Stepping stepping) {
  Scene scene;
  for (const Material& material : EveryLaw()) {
    Body body = BoxBody(Vec3(0.02, 0.02, 0.02), {6, 6, 6}, material);
    body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3(1, 0.3, 0.2));
    body.activation = Curve{{0, 0.02}, {0, 1}, Curve::Interpolation::kSmooth};
    Constraint moved = Fix(kX1);
    moved.motion.translation[0] = Curve{{0, 0.02}, {0, 1e-3}, Curve::Interpolation::kSmooth};
    moved.motion.rotation =
        Rotation{Vec3(0.02, 0.01, 0.01), Vec3::UnitX(), Curve{{0, 0.02}, {0, 0.1}, Curve::Interpolation::kLinear}};
    body.constraints = {Fix(kX0), moved};
    body.loads = {Load{kY1, Traction{Vec3(0, 50, 0)}, Curve::Constant(1), {}},
                  Load{kZ1, NodalForce{Vec3(0, 0, 0.01)}, Curve::Constant(1), {}}};
    body.damping = {20, 1e-5, 1};
    scene.bodies.push_back(std::move(body));
  }
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.tet.stepping = stepping;
  scene.duration = 1;
  return scene;
}

class AllocationsTest : public ::testing::TestWithParam<std::tuple<Stepping, int>> {};

TEST_P(AllocationsTest, NoneAfterTheFirstStep) {
  const auto [stepping, threads] = GetParam();
  const Scene scene = BusyScene(stepping);
  const TetModel model(scene);
  ThreadTeam team(threads);
  Profile profile;
  TetStepper solver(model, team, &profile);
  TetState state = solver.InitialState();
  ASSERT_EQ(solver.Advance(state, scene.duration).problem, StepProblem::kNone);

  const std::int64_t first_search = state.stable.found_at;
  int iterations = 0;
  const long before = AllocationCount();
  for (int step = 0; step < 300; ++step) {
    const StepReport report = solver.Advance(state, scene.duration);
    ASSERT_EQ(report.problem, StepProblem::kNone) << "step " << step;
    iterations += report.iterations;
    ASSERT_EQ(AllocationCount() - before, 0) << "in step " << step;
  }
  EXPECT_GT(state.stable.found_at, first_search) << "no search for the stable step was among them";
  EXPECT_EQ(iterations > 0, stepping == Stepping::kMixed) << "solves";
}

INSTANTIATE_TEST_SUITE_P(Steppings, AllocationsTest,
                         ::testing::Combine(::testing::Values(Stepping::kExplicit, Stepping::kMixed),
                                            ::testing::Values(1, 2)));

// Bytes in use of the heap.
std::size_t BytesInUse() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

// Memory of model, state and step without the scene: linear elements of a nearly incompressible muscle, stepped
// explicitly, including the search for the stable step.
TEST(MemoryTest, LessThan400BytesForATetrahedron) {
  for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
    const Scene scene = TetBox::MakeScene(26, Muscle(kMuscle), VolumeForm::kNodal, precision);
    const std::size_t before = BytesInUse();
    const TetModel model(scene);
    ThreadTeam team(1);
    TetStepper solver(model, team);
    TetState state = solver.InitialState();
    ASSERT_EQ(solver.Advance(state, scene.duration).problem, StepProblem::kNone);
    const double bytes = static_cast<double>(BytesInUse() - before) / static_cast<double>(model.elements());
    RecordProperty(precision == Precision::kDouble ? "bytes" : "bytes_single", std::to_string(bytes));
    std::printf("%s: %.0f bytes a tetrahedron\n", precision == Precision::kDouble ? "double" : "single", bytes);
    EXPECT_LT(bytes, precision == Precision::kDouble ? 400 : 350);
    EXPECT_GT(bytes, 100);
  }
}

// A count that misses allocations would pass any test. Called by name, operator new may not be optimized away.
TEST(AllocationCountTest, SeesEveryKind) {
  struct alignas(64) Aligned {
    double value = 0;
  };
  const auto count = [](const auto& allocate) {
    const long before = AllocationCount();
    allocate();
    return AllocationCount() - before;
  };
  EXPECT_EQ(count([] { ::operator delete(::operator new(8)); }), 1);
  EXPECT_EQ(count([] { std::vector<double> several(100); }), 1);
  EXPECT_EQ(count([] { std::vector<Aligned> several(100); }), 1);
  EXPECT_EQ(count([] { Eigen::VectorXd vector = Eigen::VectorXd::Random(100); }), 1);
}

}  // namespace
}  // namespace fascicle
