// Forces of linear tetrahedra on boxes of three sizes, compared with the straightforward scalar loop and with Bullet,
// and with two threads compared with one. Each comparison first checks that both sides compute the same, then prints
// both figures and `ratio NAME VALUE`.
//   tet_force_bench [PART]    only the rows whose name contains PART
#include <cstdlib>
#include <string>

#include "core/materials/tensor_algebra.h"
#include "ratio.h"
#include "scalar_reference.h"
#include "tests/support/tet_box.h"
#ifdef FASCICLE_WITH_BULLET
#include "bullet_box.h"
#endif

namespace fascicle::bench {
namespace {

using namespace fascicle::testing;

// Calls that together take some ten milliseconds.
int CallsFor(const TetBox& box) { return std::max(1, static_cast<int>(0.3 / box.Megatets())); }

std::string wanted;

bool IsWanted(const std::string& row) { return row.find(wanted) != std::string::npos; }

void CheckAgreement(const std::string& row, double difference, double tolerance) {
  std::printf("%s: forces agree to %.2g of the largest\n", row.c_str(), difference);
  if (difference <= tolerance) return;
  std::fprintf(stderr, "%s: they must agree to %.0e\n", row.c_str(), tolerance);
  std::exit(1);
}

// The loops of the core on a box, with scratch memory for each team.
class CoreForce {
 public:
  CoreForce(const TetBox& box, int threads) : box_(box), team_(threads), x_(box.Bent()) {}

  void Evaluate() {
    if (!ElasticForce(box_.model, activation_, x_, team_, workspace_, force_).valid) std::abort();
  }
  const NodalVector& force() const { return force_; }

 private:
  const TetBox& box_;
  ThreadTeam team_;
  const NodalVector x_;
  const std::array<double, 1> activation_ = {kActivation};
  ForceWorkspace workspace_;
  NodalVector force_;
};

// The law defines the scalar type of the reference.
template <class Law>
void CompareWithScalar(const std::string& row, const TetBox& box, const Law& law, double tolerance) {
  CoreForce ours(box, 1);
  ScalarReference<Law> reference(box.model, law, kActivation);
  const auto x = CastAll<typename Law::Scalar>(box.Bent());
  auto force = x;
  ours.Evaluate();
  reference.Force(x, force);
  CheckAgreement(row, RelativeDifference<typename Law::Scalar>(force, ours.force()), tolerance);
  const int calls = CallsFor(box);
  MedianRatio(
      row, kRounds,
      [&] {
        for (int i = 0; i < calls; ++i) ours.Evaluate();
      },
      [&] {
        for (int i = 0; i < calls; ++i) reference.Force(x, force);
      },
      {calls * box.Megatets(), "Mtets"});
}

// The full muscle law in double; each element has its own volume ratio.
void CompareWithEigen(const BoxSize& size) {
  const std::string row = std::string("tet_force_vs_eigen") + size.suffix;
  if (!IsWanted(row)) return;
  const TetBox box(size.divisions, Muscle(kMuscle), VolumeForm::kElement);
  CompareWithScalar(row, box, PlainMuscle<double>(kMuscle), 1e-10);
}

// The same in single precision on both sides.
void CompareFloatWithEigen(const BoxSize& size) {
  const std::string row = std::string("tet_force_float_vs_eigen") + size.suffix;
  if (!IsWanted(row)) return;
  const TetBox box(size.divisions, Muscle(kMuscle), VolumeForm::kElement, Precision::kSingle);
  CompareWithScalar(row, box, PlainMuscle<float>(kMuscle), 1e-4);
}

// As the first, with volume ratios averaged around nodes on both sides.
void CompareNodalWithEigen(const BoxSize& size) {
  const std::string row = std::string("tet_force_nodal_vs_eigen") + size.suffix;
  if (!IsWanted(row)) return;
  const TetBox box(size.divisions, Muscle(kMuscle), VolumeForm::kNodal);
  // The part of K that remains with each element.
  const auto& laws = std::get<std::vector<Muscle>>(box.model.groups().at(0).laws);
  std::array<double, 8> values = kMuscle;
  values[2] = laws.at(0).VolumeModulus();
  CompareWithScalar(row, box, PlainMuscle<double>(values), 1e-10);
}

#ifdef FASCICLE_WITH_BULLET
// What BulletBox is documented to compute, element by element in double.
NodalVector StableNeoHookeanForce(const TetBox& box, double mu, double lambda) {
  struct Law {
    using Scalar = double;
    double mu, lambda;
    Mat3 Stress(const Mat3& F, const Vec3&, double) const {
      return mu * (1 - 1 / (F.squaredNorm() + 1)) * F + (lambda * (F.determinant() - 1) - 0.75 * mu) * Cofactor(F);
    }
  };
  NodalVector force;
  ScalarReference<Law>(box.model, {mu, lambda}, 0).Force(box.Bent(), force);
  return force;
}

void CompareWithBullet(const std::string& row, const BoxSize& size, const Material& material) {
  if (!IsWanted(row)) return;
  const TetBox box(size.divisions, material, VolumeForm::kElement);
  const IsotropicModuli moduli(kNeoHookean);
  CoreForce ours(box, 1);
  BulletBox bullet(box.scene.bodies[0].tet().mesh, moduli.mu, moduli.lambda);
  bullet.SetPositions(box.Bent());
  bullet.Evaluate();
  CheckAgreement(row + " (Bullet and its own law)",
                 RelativeDifference<double>(bullet.Forces(), StableNeoHookeanForce(box, moduli.mu, moduli.lambda)),
                 1e-3);
  const int calls = CallsFor(box);
  MedianRatio(
      row, kRounds,
      [&] {
        for (int i = 0; i < calls; ++i) ours.Evaluate();
      },
      [&] {
        for (int i = 0; i < calls; ++i) bullet.Evaluate();
      },
      {calls * box.Megatets(), "Mtets"});
}

void CompareLawsWithBullet(const BoxSize& size) {
  CompareWithBullet(std::string("tet_force_vs_bullet") + size.suffix, size, NeoHookean(kNeoHookean));
  CompareWithBullet(std::string("tet_force_muscle_vs_bullet") + size.suffix, size, Muscle(kMuscle));
}
#else
void CompareLawsWithBullet(const BoxSize&) {}
#endif

// Two threads compared with one, full muscle law; 0 if not requested.
double CompareThreads(const BoxSize& size) {
  const std::string row = std::string("tet_threads_2") + (*size.suffix == '\0' ? "_105k" : size.suffix);
  if (!IsWanted(row)) return 0;
  const TetBox box(size.divisions, Muscle(kMuscle), VolumeForm::kElement);
  CoreForce two(box, 2), one(box, 1);
  two.Evaluate();
  one.Evaluate();
  if (two.force() != one.force()) std::abort();
  const int calls = CallsFor(box);
  return MedianRatio(
      row, kRounds,
      [&] {
        for (int i = 0; i < calls; ++i) two.Evaluate();
      },
      [&] {
        for (int i = 0; i < calls; ++i) one.Evaluate();
      },
      {calls * box.Megatets(), "Mtets"});
}

void CompareAll() {
#ifndef FASCICLE_WITH_BULLET
  std::printf("left out: tet_force_vs_bullet (install libbullet-dev and build again)\n");
#endif
  double threads = INFINITY;
  for (const BoxSize& size : kBoxSizes) {
    CompareWithEigen(size);
    CompareFloatWithEigen(size);
    CompareNodalWithEigen(size);
    CompareLawsWithBullet(size);
    const double ratio = CompareThreads(size);
    if (size.divisions >= 26 && ratio > 0) threads = std::min(threads, ratio);
  }
  // The smaller of 105k and 1M tetrahedra.
  if (std::isfinite(threads)) std::printf("ratio tet_threads_2 %.3f\n", threads);
}

}  // namespace
}  // namespace fascicle::bench

int main(int argc, char** argv) {
  if (argc > 1) fascicle::bench::wanted = argv[1];
  fascicle::bench::CompareAll();
}
