// Error and time of linear, quadratic and hexahedral elements on the nearly incompressible reference problems:
// quasi-static steps, one thread, default settings. Prints a table, and for each problem the ratio of the least
// products of error and time.
#include <cmath>
#include <functional>
#include <vector>

#include "ratio.h"
#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

struct Problem {
  const char* name;
  double reference;  // finest meshes of FEBio 4.11
  std::function<Body(int, Cells)> body;
  std::function<double(SteppedRun&)> answer;
  std::vector<int> linear_sizes, quadratic_sizes, hexahedral_sizes;
};

struct Row {
  std::size_t components = 0;
  double seconds = 0;
  double error = 0;  // relative
};

Row Measure(const Problem& problem, int size, ElementOrder element) {
  Row row;
  row.seconds = bench::SecondsOf([&] {
    SteppedRun run(StaticScene(problem.body(size, CellsOf(element)), element));
    if (!run.To(1)) std::printf("%s did not converge\n", problem.name);
    row.components = run.FreeComponents();
    row.error = std::abs(problem.answer(run) / problem.reference - 1);
  });
  return row;
}

const char* NameOf(ElementOrder element) {
  return element == ElementOrder::kLinear ? "linear" : element == ElementOrder::kQuadratic ? "quadratic" : "hexahedral";
}

double LeastProduct(const Problem& problem, ElementOrder element, const std::vector<int>& sizes) {
  double least = INFINITY;
  for (const int size : sizes) {
    const Row row = Measure(problem, size, element);
    std::printf("%-34s %-10s %9zu %9.2f s %9.3f %%\n", problem.name, NameOf(element), row.components, row.seconds,
                100 * row.error);
    std::fflush(stdout);
    least = std::min(least, row.seconds * row.error);
  }
  return least;
}

void Compare(const Problem& problem) {
  const double linear = LeastProduct(problem, ElementOrder::kLinear, problem.linear_sizes);
  const double quadratic = LeastProduct(problem, ElementOrder::kQuadratic, problem.quadratic_sizes);
  LeastProduct(problem, ElementOrder::kHexahedral, problem.hexahedral_sizes);
  std::printf("ratio error_per_second_%c %.3f\n", problem.name[0], linear / quadratic);
}

int Main() {
  std::printf("%-34s %-10s %9s %11s %11s\n", "problem", "element", "free", "time", "error");
  Compare({"b: clamped block, K/mu = 1000",
           9.21,
           [](int n, Cells cells) { return ClampedCube(n, NearlyIncompressible(), Ramp(0.005), cells); },
           [](SteppedRun& run) { return run.Reaction(1)[2]; },
           {4, 8, 12},
           {2, 4, 6, 8},
           {4, 8, 12, 16}});
  Compare({"d: isometric muscle, activation 1",
           70.0,
           [](int n, Cells cells) { return ReferenceMuscle(n, Ramp(1), cells); },
           [](SteppedRun& run) { return run.Reaction(1)[2]; },
           {4, 6, 8},
           {2, 4},
           {4, 8, 12}});
  Compare({"f: bending, K/mu = 1000",
           -5.534e-3,
           [](int n, Cells cells) { return LockingCantilever(n, Ramp(1), cells); },
           [](SteppedRun& run) { return run.DisplacementAt(kCantileverTip)[2]; },
           {2, 4, 6},
           {1, 2, 3},
           {2, 4, 6}});
  return 0;
}

}  // namespace
}  // namespace fascicle

int main() { return fascicle::Main(); }
