// y = K x of 64^3 bricks: matrix-free, and by Eigen's product with the assembled matrix.
#include <cstdio>
#include <cstdlib>

#include "ratio.h"
#include "roofs.h"
#include "tests/support/voxel_scenes.h"
#include "voxel_matrix.h"

namespace fascicle::bench {
namespace {

constexpr std::int32_t kSide = 64;
// Work per voxel in double precision: additions as compiled (82 multiplications can overlap), and the memory of a node:
// three numbers read, three read and written.
constexpr double kAdditions = 145, kBytes = 72;

// Mvoxels/s, the median over some rounds.
template <class S>
void PrintSpeed(const char* name, const VoxelStiffness& stiffness, int threads) {
  const VoxelMesh& mesh = *stiffness.mesh;
  ThreadTeam team(threads);
  const VoxelOperator<S> K(stiffness);
  const VoxelField<S> x = testing::RandomField<S>(mesh.nodes());
  VoxelField<S> y(mesh.nodes());
  std::vector<double> times;
  for (int round = 0; round < 50; ++round) times.push_back(SecondsOf([&] { K.Apply(x, team, y); }));
  std::printf("%s, %d threads: %.0f Mvoxels/s\n", name, threads, 1e-6 * mesh.voxels() / Median(times));
}

void PrintRoofs() {
  const double additions = AdditionsPerSecond(), bytes = TriadBytesPerSecond();
  std::printf("roofs of double, 1 thread: %.1f G additions/s, %.0f Mvoxels/s; memory %.1f GB/s, %.0f Mvoxels/s\n",
              1e-9 * additions, 1e-6 * additions / kAdditions, 1e-9 * bytes, 1e-6 * bytes / kBytes);
}

int Main() {
  PrintRoofs();
  const VoxelMesh mesh(testing::BoxGrid({kSide, kSide, kSide}, Vec3::Constant(1e-3)));
  const VoxelMaterial muscle = {3e4, 0.45};
  const VoxelStiffness stiffness(mesh, {muscle}, Dilatation::kFull);
  for (const int threads : {1, 2}) {
    PrintSpeed<double>("double", stiffness, threads);
    PrintSpeed<float>("float", stiffness, threads);
  }

  const auto matrix = AssembleVoxels<Eigen::SparseMatrix<double, Eigen::RowMajor>>(mesh, muscle);
  const VoxelOperator<double> K(stiffness);
  const VoxelField<double> x = testing::RandomField<double>(mesh.nodes());
  VoxelField<double> y(mesh.nodes());
  Eigen::VectorXd x_vector(matrix.rows()), y_vector(matrix.rows());
  for (std::int32_t n = 0; n < mesh.nodes(); ++n) x_vector.segment<3>(3 * static_cast<Eigen::Index>(n)) = x.At(n);
  ThreadTeam team(1);
  const auto ours = [&] { K.Apply(x, team, y); };
  const auto theirs = [&] { y_vector.noalias() = matrix * x_vector; };
  ours();
  theirs();
  double difference = 0;
  for (std::int32_t n = 0; n < mesh.nodes(); ++n) {
    difference = std::max(difference, (y.At(n) - y_vector.segment<3>(3 * static_cast<Eigen::Index>(n))).norm());
  }
  if (!(difference < 1e-12 * y_vector.cwiseAbs().maxCoeff())) {
    std::printf("the products differ by %g\n", difference);
    return EXIT_FAILURE;
  }
  MedianRatio("voxel_operator_vs_csr", 21, ours, theirs, {1e-6 * mesh.voxels(), "Mvoxels"});
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace fascicle::bench

int main() { return fascicle::bench::Main(); }
