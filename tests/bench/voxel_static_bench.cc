// Static solutions of voxels compared with CHOLMOD (one thread), and beside ParOSol's figures.
//   voxel_static_bench [SIDE] [ROUNDS]    a cube of SIDE^3 voxels, and the biceps with voxels of 2 mm
#include <cholmod.h>

#include <cstdio>
#include <cstdlib>

#include "core/voxel/static_solver.h"
#include "ratio.h"
#include "tests/support/label_volume.h"
#include "voxel_matrix.h"

namespace fascicle::bench {
namespace {

// A body clamped at the bottom whose top is displaced.
struct Body {
  Body(VoxelGrid solid, const VoxelMaterial& m, std::int32_t layers, const Vec3& top)
      : grid(std::move(solid)), material(m), model(grid, {m}, Dilatation::kFull), largest(top.norm()) {
    const std::int32_t all = 1 << 20, first = model.mesh().node_runs().front().k,
                       last = model.mesh().node_runs().back().k;
    supports = {{NodesInBox(model.mesh(), {0, 0, 0}, {all, all, first + layers})},
                {NodesInBox(model.mesh(), {0, 0, last - layers}, {all, all, all}), {true, true, true}, top}};
  }
  VoxelGrid grid;
  VoxelMaterial material;
  VoxelModel model;
  double largest;  // displacement prescribed [m]
  std::vector<VoxelSupport> supports;
};

VoxelGrid FullGrid(std::int32_t side) {
  VoxelGrid grid = MakeVoxelGrid({side, side, side}, Vec3::Constant(64.0 / side));
  grid.material.assign(grid.voxels(), 1);
  return grid;
}

// K of the free components, solved by CHOLMOD's supernodal L L^T with METIS's ordering. Its assembly is not timed.
class Direct {
 public:
  explicit Direct(const Body& body) : scale_(body.largest) {
    const VoxelMesh& mesh = body.model.mesh();
    const auto K = AssembleVoxels<Eigen::SparseMatrix<double>>(mesh, body.material);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(K.rows());
    std::vector<std::int32_t> unknown(K.rows(), 0);
    for (const VoxelSupport& support : body.supports) {
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
    most_bytes_ = static_cast<double>(common_.memory_usage);
    cholmod_free_dense(&x, &common_);
    cholmod_free_factor(&factor, &common_);
  }

  std::size_t size() const { return b_.size(); }
  double entries() const { return entries_; }
  double most_bytes() const { return most_bytes_; }
  // Relative to the largest displacement.
  double DifferenceTo(const VoxelField<double>& u) const {
    double difference = 0;
    for (std::size_t k = 0; k < x_.size(); ++k) {
      difference = std::max(difference, std::abs(x_[k] - u(first_component_[k] / 3, first_component_[k] % 3)));
    }
    return difference / scale_;
  }

 private:
  cholmod_common common_;
  std::vector<std::int32_t> begin_, rows_, first_component_;
  std::vector<double> values_, b_, x_;
  double scale_, entries_ = 0, most_bytes_ = 0;
};

// tolerance: of the residual, such that displacements agree to 1e-6; thin tendons need a smaller one than a cube.
bool Compare(const std::string& name, const Body& body, double tolerance, int rounds) {
  Direct direct(body);
  StaticSolution solution;
  std::size_t bytes = 0;
  // Includes levels, their stiffness and the coarsest factorization.
  const auto ours = [&] {
    ThreadTeam team(1);
    VoxelStaticSolver solver(body.model, body.supports, team);
    solution = solver.Solve({}, {.tolerance = tolerance});
    bytes = solver.bytes();
  };
  const std::int32_t voxels = body.model.mesh().voxels();
  MedianRatio(name, rounds, ours, [&] { direct.Solve(); }, {1e-6 * voxels, "Mvoxels"});
  const double difference = direct.DifferenceTo(solution.displacement);
  std::printf(
      "%d voxels, %zu free components: A %d iterations, %.0f bytes a voxel; B L of %.3g entries, %.2f GB, %.0f bytes a "
      "voxel; they agree to %.2g\n",
      voxels, direct.size(), solution.iterations.iterations, static_cast<double>(bytes) / voxels, direct.entries(),
      1e-9 * direct.most_bytes(), direct.most_bytes() / voxels, difference);
  return solution.iterations.converged && difference < 1e-6;
}

int Main(std::int32_t side, int rounds) {
  bool good = Compare("voxel_static_vs_cholmod", Body(FullGrid(side), {1, 0.3}, 0, Vec3(0, 0, 0.64)), 1e-8, rounds);
  // The finest level of the biceps of 1 mm whose L fits into some GB.
  std::optional<VoxelGrid> label = testing::ReadLabel(testing::LabelVolumePath(), 1);
  if (!label) {
    std::printf("voxel_static_vs_cholmod_biceps left out: %s is not there; set FASCICLE_DATA\n",
                testing::LabelVolumePath().c_str());
  } else {
    VoxelGrid grid = Coarsen(CropToSolid(*label), 0.5);
    KeepLargestIsland(grid);
    good &= Compare("voxel_static_vs_cholmod_biceps", Body(std::move(grid), {3e4, 0.45}, 5, Vec3(0, 0, 3e-3)), 1e-9,
                    rounds);
  }
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace fascicle::bench

int main(int argc, char** argv) {
  // L of 40^3 takes 3 GB and minutes; of 64^3, more than most machines have.
  const int side = argc > 1 ? std::atoi(argv[1]) : 32;
  return fascicle::bench::Main(side, argc > 2 ? std::atoi(argv[2]) : 3);
}
