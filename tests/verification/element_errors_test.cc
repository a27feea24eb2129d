// The FEBio reference problems with every element at the sizes of every FEBio run, against converged answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "tests/support/reference_file.h"
#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// Answers extrapolated from the three finest meshes of hexahedra of 27 nodes; those of quadratic tetrahedra agree
// within a tenth of a percent (d: 0.5 %, from above, as of all elements).
constexpr double kConvergedA = -3.501, kConvergedB = 9.170, kConvergedD = 68.9, kConvergedF = -5.557;

// A problem whose meshes have `n` elements of eight nodes, or half as many of 10 or 27 nodes, across.
struct ErrorProblem {
  std::string letter, file, runs;
  double converged;  // from finer meshes, see README.md
  std::vector<int> sizes;
  Scene (*scene)(int n, ElementOrder element);
  double (*answer)(SteppedRun& run);
  std::optional<double> (*of_reference)(const nlohmann::json& run);
};

double Tip(SteppedRun& run) { return 1e3 * run.DisplacementAt(kCantileverTip)[2]; }  // [mm]
double Pull(SteppedRun& run) { return run.Reaction(1)[2]; }                          // [N]

std::optional<double> ReferenceTip(const nlohmann::json& run) {
  return run.at("tip_center_displacement")[2].get<double>();
}
// The force at the end of a path that was followed to its end.
std::optional<double> LastForce(const nlohmann::json& run, const char* path) {
  const auto found = run.find(path);
  if (found == run.end() || found->empty() || found->back()[0].get<double>() != 1) return std::nullopt;
  return found->back()[1].get<double>();
}

const std::vector<ErrorProblem>& ErrorProblems() {
  static const std::vector<ErrorProblem> kProblems = {
      {"a",
       "a_cantilever_neohookean",
       "runs",
       kConvergedA,
       {2, 4, 8},
       [](int n, ElementOrder e) { return StaticScene(NeoHookeanCantilever(n, Ramp(1), CellsOf(e)), e); },
       &Tip,
       &ReferenceTip},
      {"b",
       "b_uniaxial_mooney_rivlin",
       "runs_clamped",
       kConvergedB,
       {4, 8, 16},
       [](int n, ElementOrder e) {
         return StaticScene(ClampedCube(n, NearlyIncompressible(), Ramp(0.005), CellsOf(e)), e);
       },
       &Pull,
       [](const nlohmann::json& run) { return LastForce(run, "path_t_Fz"); }},
      {"d",
       "d_fusiform_isometric",
       "runs",
       kConvergedD,
       {4, 8, 12},
       [](int n, ElementOrder e) {
         return StaticScene(ReferenceMuscle(n, n % 3 == 0 ? 10 * n / 3 : 4 * n, Ramp(1), CellsOf(e)), e);
       },
       &Pull,
       [](const nlohmann::json& run) { return LastForce(run, "path_activation_Fz_at_z1_Fz_at_z0"); }},
      {"f",
       "f_bending_locking",
       "runs",
       kConvergedF,
       {2, 4, 6},
       [](int n, ElementOrder e) { return StaticScene(LockingCantilever(n, Ramp(1), CellsOf(e)), e); },
       &Tip,
       &ReferenceTip}};
  return kProblems;
}

// |error| of each of FEBio's runs with so many nodes [%].
std::map<std::string, double> ReferenceErrors(const nlohmann::json& runs, const ErrorProblem& problem,
                                              std::size_t nodes) {
  std::map<std::string, double> errors;
  for (const nlohmann::json& run : runs) {
    if (run.at("nodes").get<std::size_t>() != nodes || !run.at("normal_termination").get<bool>()) continue;
    const std::optional<double> answer = problem.of_reference(run);
    if (answer) errors[run.at("name")] = 100 * std::abs(*answer / problem.converged - 1);
  }
  return errors;
}

bool HasMiddles(ElementOrder element) {
  return element == ElementOrder::kQuadratic || element == ElementOrder::kHexahedralQuadratic;
}

// At each size, the best element is closer than every one of FEBio's.
TEST(ElementErrorsTest, TheBestElementBeatsEveryColumn) {
  for (const ErrorProblem& problem : ErrorProblems()) {
    const auto reference = ReadReference(problem.file);
    if (!reference) GTEST_SKIP() << NoReference();
    for (const int n : problem.sizes) {
      double best = 1e9;
      std::size_t nodes = 0;
      std::string line;
      for (const ElementOrder element : kEveryElement) {
        SteppedRun run(problem.scene(HasMiddles(element) ? n / 2 : n, element));
        nodes = run.model.nodes();
        ASSERT_TRUE(run.To(1)) << problem.letter << " " << ElementNameOf(element);
        const double answer = problem.answer(run), error = 100 * std::abs(answer / problem.converged - 1);
        best = std::min(best, error);
        char text[100];
        std::snprintf(text, sizeof(text), "  %s %.5g (%.3g %%)", ElementNameOf(element).c_str(), answer, error);
        line += text;
      }
      std::printf("%s, %zu nodes:%s; FEBio", problem.letter.c_str(), nodes, line.c_str());
      double best_reference = 1e9;
      for (const auto& [name, error] : ReferenceErrors(reference->at(problem.runs), problem, nodes)) {
        std::printf("  %s %.3g %%", name.c_str(), error);
        best_reference = std::min(best_reference, error);
      }
      std::printf("\n");
      ASSERT_LT(best_reference, 1e9) << "no run of FEBio has " << nodes << " nodes";
      EXPECT_LT(best, best_reference) << problem.letter << " at " << nodes << " nodes";
    }
  }
}

// The forces at 20 and 40 % of compression of a cube of 10 mm between rough plates, by an eighth of it with n hexahedra
// along each side [N]. Its side surface is not in contact with the plates that it bulges beyond.
std::array<double, 2> ForcesOfCube(ElementOrder element, VolumeForm volume, int n) {
  constexpr double kHalf = 0.005, kPart = 0.4;
  Body body = BoxBody(Vec3::Constant(kHalf), {n, n, n}, NearlyIncompressible(), CellsOf(element));
  Constraint plate = Fix(kZ1);
  plate.motion.translation[2] = Ramp(-kPart * kHalf);
  body.constraints = {Fix(kZ0, {false, false, true}), plate, Fix(kX0, {true, false, false}),
                      Fix(kY0, {false, true, false})};
  Scene scene = StaticScene(std::move(body), element);
  scene.tet.volume = volume;
  SteppedRun run(std::move(scene));
  std::array<double, 2> forces = {};
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(run.To(0.25 * (i + 1)));
    if (i % 2 == 1) forces[static_cast<std::size_t>(i / 2)] = -4 * run.Reaction(1)[2];
  }
  return forces;
}

// Nodal volumes and volumes of elements approach each other.
TEST(StrongCompressionTest, VolumesOfNodesAndElementsApproachEachOther) {
  double gap_before = 0;
  for (const int n : {2, 4}) {
    const auto print = [n](const char* what, const std::array<double, 2>& forces) {
      std::printf("n = %d, %s: %.2f and %.2f N at 20 and 40 %%\n", n, what, forces[0], forces[1]);
    };
    const auto nodal = ForcesOfCube(ElementOrder::kQuadratic, VolumeForm::kNodal, n);
    const auto of_elements = ForcesOfCube(ElementOrder::kQuadratic, VolumeForm::kElement, n);
    print("quadratic, nodal volumes", nodal);
    print("quadratic, volumes of elements", of_elements);
    print("hexahedral, twice as many", ForcesOfCube(ElementOrder::kHexahedral, VolumeForm::kNodal, 2 * n));
    print("hexahedral_quadratic", ForcesOfCube(ElementOrder::kHexahedralQuadratic, VolumeForm::kNodal, n));
    const double gap = of_elements[0] - nodal[0];
    EXPECT_GT(gap, 0);
    if (gap_before != 0) {
      EXPECT_LT(gap, 0.7 * gap_before);
    }
    gap_before = gap;
  }
}

}  // namespace
}  // namespace fascicle
