// Force and tangent of a neo-Hookean box of linear tetrahedra, one thread, compared with GetFEM's finite-strain brick
// on the same mesh. Checks that forces and the products of both matrices agree, then prints both figures and `ratio
// NAME VALUE`.
//   tet_tangent_bench [PART]    only the rows whose name contains PART
#include <cstdlib>
#include <string>

#include "core_tangent.h"
#include "ratio.h"
#include "scalar_reference.h"
#include "tests/support/tet_box.h"
#ifdef FASCICLE_WITH_GETFEM
#include "getfem_box.h"
#endif

namespace fascicle::bench {
namespace {

using namespace fascicle::testing;

constexpr std::array<double, 1> kNoActivation = {0};

#ifdef FASCICLE_WITH_GETFEM
void CheckAgreement(const char* what, const NodalVector& ours, const NodalVector& theirs, double tolerance) {
  const double difference = RelativeDifference<double>(theirs, ours);
  std::printf("%s agree to %.2g of the largest\n", what, difference);
  if (difference <= tolerance) return;
  std::fprintf(stderr, "%s must agree to %.0e\n", what, tolerance);
  std::exit(1);
}

void CompareWithGetfem(const std::string& row, const TetBox& box) {
  ThreadTeam team(1);
  CoreTangent ours(box.model, team);
  const IsotropicModuli moduli(kNeoHookean);
  GetfemBox getfem(box.scene.bodies[0].tet().mesh, moduli.mu, moduli.lambda);
  const NodalVector x = box.Bent();
  ours.Evaluate(kNoActivation, x);
  getfem.SetPositions(x);
  getfem.Assemble();
  CheckAgreement("forces", ours.force(), getfem.Forces(), 1e-10);
  CheckAgreement("products", ours.Product(x), getfem.Product(x), 1e-9);
  MedianRatio(
      row, kRounds, [&] { ours.Evaluate(kNoActivation, x); }, [&] { getfem.Assemble(); }, {box.Megatets(), "Mtets"});
}
#else
void CompareWithGetfem(const std::string& row, const TetBox& box) {
  ThreadTeam team(1);
  CoreTangent ours(box.model, team);
  const NodalVector x = box.Bent();
  std::vector<double> times;
  for (int i = 0; i < kRounds; ++i) times.push_back(SecondsOf([&] { ours.Evaluate(kNoActivation, x); }));
  std::printf("%s: A %.4g Mtets/s; B left out (install libgetfem-dev and build again)\n", row.c_str(),
              box.Megatets() / Median(times));
}
#endif

void CompareAll(const std::string& wanted) {
  for (const BoxSize& size : kBoxSizes) {
    const std::string row = std::string("tet_tangent_vs_getfem") + size.suffix;
    if (row.find(wanted) == std::string::npos) continue;
    CompareWithGetfem(row, TetBox(size.divisions, NeoHookean(kNeoHookean), VolumeForm::kElement));
  }
}

}  // namespace
}  // namespace fascicle::bench

int main(int argc, char** argv) { fascicle::bench::CompareAll(argc > 1 ? argv[1] : ""); }
