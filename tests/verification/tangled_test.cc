// Tangled initial meshes: inverted elements in a body that should come to rest.
#include <gtest/gtest.h>

#include "core/tet/diagnostics.h"
#include "core/tet/points.h"
#include "tests/support/tet_scenes.h"
#include "tests/support/tet_stepper.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kSize = 0.01;
constexpr int kDivisions = 3;

// A block fixed at one end, its nodes displaced at random by up to 0.8 of their distance along each axis.
Scene TangledBlock(unsigned seed, ElementOrder element) {
  Body body = BoxBody(Vec3::Constant(kSize), {kDivisions, kDivisions, kDivisions},
                      MooneyRivlin(std::array{3e4, 1e4, 8e7}), CellsOf(element));
  body.constraints = {Fix(kZ0)};
  const NodalVector moved = Shaken(body.tet().mesh.nodes, 0.8 * kSize / kDivisions, seed);
  for (std::size_t n = 0; n < moved.size(); ++n)
    body.tet().initial_displacement.push_back(moved[n] - body.tet().mesh.nodes[n]);
  Scene scene = OneBody(std::move(body));
  scene.tet.stepping = Stepping::kQuasiStatic;
  scene.tet.element = element;
  scene.output.frame_interval = scene.duration;
  return scene;
}

int InvertedElements(const TetModel& model, const NodalVector& x) {
  int inverted = 0;
  for (const Tetrahedron& tet : model.corners()) inverted += Determinant(EdgeMatrix(x, tet)) <= 0;
  if (!IsHexahedral(model.order())) return inverted;
  model.VisitElement([&]<class Element>(Element) {
    for (std::size_t e = 0; e < model.elements(); ++e) {
      const auto nodes = ValuesOf<Element>(model, e, x);
      bool any = false;
      for (int q = 0; q < Element::kPoints; ++q) any |= GradientAt<Element>(model, e, nodes, q).determinant() <= 0;
      inverted += any;
    }
  });
  return inverted;
}

class TangledTest : public ::testing::TestWithParam<ElementOrder> {};

TEST_P(TangledTest, FiftyStartsRecoverToRest) {
  constexpr int kNodes[] = {4, 10, 8, 27};
  const int elements = IsHexahedral(GetParam()) ? 27 : 162;
  int recovered = 0, least_inverted = 1 << 20, most_iterations = 0;
  std::int64_t iterations = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Scene scene = TangledBlock(seed, GetParam());
    const TetModel model(scene);
    ThreadTeam team(1);
    TetStepper solver(model, team);
    TetState state = solver.InitialState();
    least_inverted = std::min(least_inverted, InvertedElements(model, state.positions));
    const StepReport report = solver.Advance(state, scene.duration);
    iterations += state.iterations;
    most_iterations = std::max(most_iterations, static_cast<int>(state.iterations));
    const bool at_rest = report.problem == StepProblem::kNone &&
                         LargestDifference(state.positions, model.rest_positions()) < 1e-6 * kSize;
    EXPECT_TRUE(at_rest) << "seed " << seed << ", problem " << static_cast<int>(report.problem) << ", "
                         << state.iterations << " iterations, off by "
                         << LargestDifference(state.positions, model.rest_positions()) / kSize << ", least J "
                         << state.smallest_ratio << ", inverted " << InvertedElements(model, state.positions);
    recovered += at_rest;
  }
  std::printf(
      "tangled starts (%d nodes an element): %d of 50 recover; at least %d of %d elements inverted; Newton "
      "iterations %.1f on average, at most %d\n",
      kNodes[static_cast<int>(GetParam())], recovered, least_inverted, elements, static_cast<double>(iterations) / 50,
      most_iterations);
  EXPECT_GE(least_inverted, elements / 17);
}

INSTANTIATE_TEST_SUITE_P(Elements, TangledTest, ::testing::ValuesIn(kEveryElement),
                         [](const auto& element) { return ElementNameOf(element.param); });

}  // namespace
}  // namespace fascicle
