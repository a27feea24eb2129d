// Steps of a ball on its grid with volume preservation: cells per second [a public reference map code, RMT3D: 142 to
// 160 thousand per core], and two threads compared with one.
#include <cstdlib>

#include "ratio.h"
#include "tests/support/solids.h"

namespace fascicle::bench {
namespace {

using testing::MakeSolid;

constexpr int kSteps = 3;

class Ball {
 public:
  Ball(int cells, int threads)
      : team_(threads), body_(MakeSolid(cells, true, 2e4, 0.3, team_)), run_(body_, team_, &profile_) {
    body_.volume = VolumeTreatment::kPreserved;
    const Vec3 stretch(1.1, 1 / std::sqrt(1.1), 1 / std::sqrt(1.1));
    run_.Begin(0, [&](const Vec3& x) { return Vec3(x.cwiseQuotient(stretch)); });
    start_ = run_.state;
  }
  void Run() {
    run_.state = start_;
    for (int k = 0; k < kSteps; ++k) {
      const std::int64_t before = run_.state.iterations;
      if (run_.Step(1).problem != StepProblem::kNone) std::abort();
      iterations_ = run_.state.iterations - before;
    }
  }
  // Wall time of each stage of a step [ms].
  void PrintStages(int cells) const {
    std::printf("one step at %d^3, ms:", cells);
    std::int64_t steps = 0;
    for (const ProfileStage& stage : profile_.Stages()) steps = std::max(steps, stage.calls);
    for (const ProfileStage& stage : profile_.Stages()) {
      std::printf(" %s %.1f;", stage.name.c_str(), 1e3 * stage.seconds / static_cast<double>(steps));
    }
    std::printf(" MINRES iterations %lld\n", static_cast<long long>(iterations_));
  }
  double Kilocells() const { return 1e-3 * kSteps * static_cast<double>(body_.grid.cell_count()); }

 private:
  Profile profile_;
  ThreadTeam team_;
  std::int64_t iterations_ = 0;
  EulerianBody body_;
  testing::SolidRun run_;
  EulerianWorldState start_;
};

int Main() {
  for (const int cells : {32, 64, 128}) {
    Ball two(cells, 2), one(cells, 1);
    const std::string name = cells == 64 ? "eulerian_threads_2" : "eulerian_threads_2_" + std::to_string(cells);
    MedianRatio(
        name, cells < 128 ? kRounds : 3, [&] { two.Run(); }, [&] { one.Run(); }, {two.Kilocells(), "kcells"});
    one.PrintStages(cells);
    two.PrintStages(cells);
  }
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace fascicle::bench

int main() { return fascicle::bench::Main(); }
