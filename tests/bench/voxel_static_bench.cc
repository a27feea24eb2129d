// Static solutions of voxels over CHOLMOD (one thread), and beside the figures of ParOSol.
//   voxel_static_bench [SIDE] [ROUNDS]    a cube of SIDE^3 voxels
#include <cholmod.h>

#include <cstdio>
#include <cstdlib>

#include "core/voxel/static_solver.h"
#include "ratio.h"
#include "voxel_matrix.h"

namespace fascicle::bench {
namespace {

// A cube clamped at the bottom, whose top is moved by a hundredth.
struct Cube {
  explicit Cube(std::int32_t side)
      : grid(FullGrid(side)),
        model(grid, {{1, 0.3}}, Dilatation::kFull),
        supports({{NodesInBox(model.mesh(), {0, 0, 0}, {side, side, 0})},
                  {NodesInBox(model.mesh(), {0, 0, side}, {side, side, side}), {true, true, true}, Vec3(0, 0, 0.64)}}) {
  }
  static VoxelGrid FullGrid(std::int32_t side) {
    VoxelGrid grid = MakeVoxelGrid({side, side, side}, Vec3::Constant(64.0 / side));
    grid.material.assign(grid.voxels(), 1);
    return grid;
  }
  VoxelGrid grid;
  VoxelModel model;
  std::vector<VoxelSupport> supports;
};

// K of the free components by CHOLMOD's supernodal L L^T with METIS's ordering. Assembled outside of the comparison.
class Direct {
 public:
  explicit Direct(const Cube& cube) {
    const VoxelMesh& mesh = cube.model.mesh();
    const auto K = AssembleVoxels<Eigen::SparseMatrix<double>>(mesh, {1, 0.3});
    Eigen::VectorXd u = Eigen::VectorXd::Zero(K.rows());
    std::vector<std::int32_t> unknown(K.rows(), 0);
    for (const VoxelSupport& support : cube.supports) {
      for (const GridIndex& at : support.nodes) {
        for (int d = 0; d < 3; ++d) {
          unknown[3 * mesh.NodeAt(at) + d] = -1;
          u[3 * mesh.NodeAt(at) + d] = support.displacement[d];
        }
      }
    }
    std::int32_t size = 0;
    for (std::int32_t& number : unknown) number = number < 0 ? -1 : size++;
    const Eigen::VectorXd Ku = K * u;
    b_.resize(size);
    first_component_.assign(size, 0);
    begin_.assign(1, 0);
    for (std::int32_t column = 0; column < K.cols(); ++column) {
      if (unknown[column] < 0) continue;
      b_[unknown[column]] = -Ku[column];
      first_component_[unknown[column]] = column;
      for (Eigen::SparseMatrix<double>::InnerIterator entry(K, column); entry; ++entry) {
        if (entry.row() < column || unknown[entry.row()] < 0) continue;
        rows_.push_back(unknown[entry.row()]);
        values_.push_back(entry.value());
      }
      begin_.push_back(static_cast<std::int32_t>(rows_.size()));
    }
    cholmod_start(&common_);
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_METIS;
    common_.print = 0;
  }
  ~Direct() { cholmod_finish(&common_); }

  // Analysis, factorization and solution.
  void Solve() {
    cholmod_sparse A = {};
    A.nrow = A.ncol = b_.size();
    A.nzmax = values_.size();
    A.stype = -1;
    A.itype = CHOLMOD_INT;
    A.xtype = CHOLMOD_REAL;
    A.dtype = CHOLMOD_DOUBLE;
    A.sorted = A.packed = 1;
    A.p = begin_.data();
    A.i = rows_.data();
    A.x = values_.data();
    cholmod_factor* factor = cholmod_analyze(&A, &common_);
    cholmod_factorize(&A, factor, &common_);
    if (common_.status != CHOLMOD_OK) std::abort();
    cholmod_dense b = {};
    b.nrow = b.nzmax = b.d = b_.size();
    b.ncol = 1;
    b.x = b_.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor, &b, &common_);
    const auto* const values = static_cast<const double*>(x->x);
    x_.assign(values, values + b_.size());
    entries_ = common_.lnz;
    cholmod_free_dense(&x, &common_);
    cholmod_free_factor(&factor, &common_);
  }

  std::size_t size() const { return b_.size(); }
  double entries() const { return entries_; }
  // Of the largest displacement.
  double DifferenceTo(const VoxelField<double>& u) const {
    double difference = 0;
    for (std::size_t k = 0; k < x_.size(); ++k) {
      difference = std::max(difference, std::abs(x_[k] - u(first_component_[k] / 3, first_component_[k] % 3)));
    }
    return difference / 0.64;
  }

 private:
  cholmod_common common_;
  std::vector<std::int32_t> begin_, rows_, first_component_;
  std::vector<double> values_, b_, x_;
  double entries_ = 0;
};

int Main(std::int32_t side, int rounds) {
  const Cube cube(side);
  Direct direct(cube);
  StaticSolution solution;
  std::size_t bytes = 0;
  // Everything counts: levels, their stiffness, the coarsest factorization.
  const auto ours = [&] {
    ThreadTeam team(1);
    VoxelStaticSolver solver(cube.model, cube.supports, team);
    solution = solver.Solve({}, {.tolerance = 1e-8});
    bytes = solver.bytes();
  };
  MedianRatio("voxel_static_vs_cholmod", rounds, ours, [&] { direct.Solve(); },
              {1e-6 * cube.model.mesh().voxels(), "Mvoxels"});
  const double difference = direct.DifferenceTo(solution.displacement);
  std::printf(
      "%zu free components: A %d iterations, %.0f bytes a voxel; B L of %.3g entries, %.0f bytes a voxel; they agree "
      "to %.2g\n",
      direct.size(), solution.iterations.iterations, static_cast<double>(bytes) / cube.model.mesh().voxels(),
      direct.entries(), 8 * direct.entries() / cube.model.mesh().voxels(), difference);
  return solution.iterations.converged && difference < 1e-6 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace fascicle::bench

int main(int argc, char** argv) {
  // L of 40^3 takes 3 GB and minutes, of 64^3 more than most machines have.
  const int side = argc > 1 ? std::atoi(argv[1]) : 32;
  return fascicle::bench::Main(side, argc > 2 ? std::atoi(argv[2]) : 3);
}
