// Error and time of every element with every stepping, in motion: bodies released from a static equilibrium swing, and
// frequency and amplitude of a point are compared with those of a fine mesh of hexahedra of 27 nodes. One thread,
// meshes of as many nodes for each element. A tool for development; prints a table.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "ratio.h"
#include "tests/support/isometric_muscle.h"
#include "tests/support/released_run.h"

namespace fascicle::bench {
namespace {

using namespace fascicle::testing;

struct Problem {
  const char* name;
  const char* what;
  // With n elements of eight nodes across; rest of the arguments as in CellsOf.
  std::function<Body(int n, Cells cells)> body;
  std::function<void(Body& body)> hold;  // what the release takes away
  Vec3 place;                            // of the point, at rest [m]
  Vec3 along;                            // its displacement that is measured, unit
  double period;                         // about [s]
};

const Vec3 kBar(0.04, 0.01, 0.01);  // [m]

void Push(Body& body, Side side, const Vec3& traction) {
  body.loads.push_back({side, Traction{traction}, Ramp(1), {}});
}

Body RubberBar(int n, Cells cells) {
  Body bar = BoxBody(kBar, {4 * n, n, n}, MooneyRivlin(std::array{3e4, 1e4, 8e6}), cells);  // K/mu = 100
  bar.density = 1060;
  bar.constraints = {Fix(kX0)};
  return bar;
}

void Twist(Body& body) {
  Constraint end = Fix(kX1);
  end.motion.rotation = Rotation{Vec3(0, 0.005, 0.005), Vec3::UnitX(), Ramp(0.5)};
  body.constraints.push_back(end);
}

const std::vector<Problem>& Problems() {
  static const std::vector<Problem> kProblems = {
      {"bending", "cantilever of rubber, K/mu = 100, released from a deflection", RubberBar,
       [](Body& body) { Push(body, kX1, Vec3(0, 0, -300)); }, Vec3(0.04, 0.005, 0.005), -Vec3::UnitZ(), 0.077},
      {"torsion", "the same, released from a twist of half a radian", RubberBar, Twist, Vec3(0.04, 0.01, 0.005),
       Vec3::UnitZ(), 0.03},
      {"bent", "bent passive muscle, one end fixed, released from a pull on the other",
       [](int n, Cells cells) {
         Body body = BentMuscleBody({n, 3 * n}, cells);
         body.constraints.pop_back();
         body.activation = Curve::Constant(0);
         return body;
       },
       [](Body& body) { Push(body, kZ1, Vec3(300, 0, 0)); }, Vec3(-0.0716, 0, 0.0413), Vec3::UnitX(), 0.5},
      {"ring", "quarter of a ring of muscle, activation 0.1, released from an inner pressure",
       [](int n, Cells cells) {
         Body body = MuscleRingBody({n, 2 * n}, cells);
         body.activation = Curve::Constant(0.1);
         return body;
       },
       [](Body& body) { Push(body, kZ1, Vec3(0, 0, 2e3)); }, Vec3(0.01, 0, 0.01), Vec3::UnitZ(), 0.01},
      {"block", "block of rubber, K/mu = 1000, fixed below, released from a pull above",
       [](int n, Cells cells) {
         Body body = ClampedCube(n, NearlyIncompressible(), Curve::Constant(0), cells);
         body.constraints.pop_back();
         body.density = 1060;
         return body;
       },
       [](Body& body) { Push(body, kZ1, Vec3(0, 0, 1e4)); }, Vec3(0.005, 0.005, 0.01), Vec3::UnitZ(), 0.006}};
  return kProblems;
}

bool HasMiddles(ElementOrder element) {
  return element == ElementOrder::kQuadratic || element == ElementOrder::kHexahedralQuadratic;
}

Scene SceneOf(const Problem& problem, int n, ElementOrder element, bool held) {
  Body body = problem.body(HasMiddles(element) ? n / 2 : n, CellsOf(element));
  if (held) problem.hold(body);
  Scene scene = StaticScene(std::move(body), element);
  scene.duration = 1000;
  return scene;
}

struct Swing {
  std::size_t components = 0;
  double frequency = 0;  // [Hz]
  double amplitude = 0;  // [m]
  double cpu = 0;        // a period [s]
  int steps = 0;         // a period
  bool failed = false;
};

// Crossings of `level` by a signal that is beyond a fifth of its amplitude on both sides of each [s].
std::vector<double> Crossings(const std::vector<double>& times, const std::vector<double>& values, double level,
                              double amplitude) {
  std::vector<double> crossings;
  double last = 0;
  int side = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double now = values[k] - level;
    if (k > 0 && (values[k - 1] - level) * now <= 0 && now != values[k - 1] - level) {
      last = times[k] - (times[k] - times[k - 1]) * now / (values[k] - values[k - 1]);
    }
    if (std::abs(now) < 0.2 * amplitude) continue;
    const int reached = now > 0 ? 1 : -1;
    if (side != 0 && reached != side) crossings.push_back(last);
    side = reached;
  }
  return crossings;
}

// Moves for two periods and a half.
Swing Measure(const Problem& problem, int n, ElementOrder element, Stepping stepping, double time_step) {
  Swing swing;
  SteppedRun held(SceneOf(problem, n, element, true)), free(SceneOf(problem, n, element, false));
  if (!held.To(1) || !free.To(1)) {
    swing.failed = true;
    return swing;
  }
  Scene scene = SceneOf(problem, n, element, false);
  scene.tet.stepping = stepping;
  if (stepping != Stepping::kExplicit && stepping != Stepping::kMixed) scene.tet.time_step = time_step;
  SteppedRun run(std::move(scene));
  const std::size_t node = run.NodeAt(problem.place);
  const double level = free.Displacement(node).dot(problem.along);
  StartAtRest(run, held.state.positions, held.state.pressures);
  swing.components = run.FreeComponents();
  std::vector<double> times = {0}, values = {run.Displacement(node).dot(problem.along)};
  const double periods = 2.5, start = static_cast<double>(std::clock());
  while (run.state.time < periods * problem.period && !swing.failed) {
    swing.failed = run.solver.Advance(run.state, periods * problem.period).problem != StepProblem::kNone;
    times.push_back(run.state.time);
    values.push_back(run.Displacement(node).dot(problem.along));
  }
  swing.cpu = (static_cast<double>(std::clock()) - start) / CLOCKS_PER_SEC / periods;
  swing.steps = static_cast<int>(static_cast<double>(times.size() - 1) / periods);
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  swing.amplitude = (*highest - *lowest) / 2;
  const std::vector<double> crossings = Crossings(times, values, level, swing.amplitude);
  const std::size_t halves = crossings.size() < 2 ? 0 : std::min<std::size_t>(crossings.size() - 1, 4) / 2 * 2;
  if (halves == 0) {
    swing.failed = true;
    return swing;
  }
  swing.frequency = static_cast<double>(halves) / 2 / (crossings[halves] - crossings[0]);
  return swing;
}

struct NamedStepping {
  const char* name;
  Stepping stepping;
};
constexpr NamedStepping kSteppings[] = {{"explicit", Stepping::kExplicit},
                                        {"mixed", Stepping::kMixed},
                                        {"newmark", Stepping::kNewmark},
                                        {"bdf2", Stepping::kBdf2},
                                        {"backward Euler", Stepping::kBackwardEuler}};
// Implicit steps of a period.
constexpr double kSteps = 50, kFineSteps = 200;

void MeasureAll(const Problem& problem, const std::vector<int>& sizes, int fine, const std::string& only) {
  const Swing best =
      Measure(problem, fine, ElementOrder::kHexahedralQuadratic, Stepping::kNewmark, problem.period / kFineSteps);
  std::printf("%s: %s\n  converged (%zu components): %.5g Hz, amplitude %.5g mm%s\n", problem.name, problem.what,
              best.components, best.frequency, 1e3 * best.amplitude, best.failed ? " FAILED" : "");
  std::printf("  %-21s %-15s %8s %8s %12s %11s %11s\n", "element", "stepping", "free", "steps", "CPU s/period",
              "frequency", "amplitude");
  for (const auto& [name, stepping] : kSteppings) {
    if (!only.empty() && only != name) continue;
    for (const ElementOrder element : kEveryElement) {
      for (const int n : sizes) {
        const Swing swing = Measure(problem, n, element, stepping, problem.period / kSteps);
        std::printf("  %-21s %-15s %8zu %8d %12.4f", ElementNameOf(element).c_str(), name, swing.components,
                    swing.steps, swing.cpu);
        if (swing.failed) {
          std::printf(" failed\n");
        } else {
          std::printf(" %+9.2f %% %+9.2f %%\n", 100 * (swing.frequency / best.frequency - 1),
                      100 * (swing.amplitude / best.amplitude - 1));
        }
        std::fflush(stdout);
      }
    }
  }
}

// motion_bench [PROBLEM|all [STEPPING]]
int Main(int argc, char** argv) {
  const std::string problem = argc > 1 ? argv[1] : "all", stepping = argc > 2 ? argv[2] : "";
  for (const Problem& p : Problems()) {
    if (problem == "all" || problem == p.name) MeasureAll(p, {2, 4, 8}, 8, stepping);
  }
  return 0;
}

}  // namespace
}  // namespace fascicle::bench

int main(int argc, char** argv) { return fascicle::bench::Main(argc, argv); }
