#include "core/geometry/bspline_fit.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/stop.h"

namespace fascicle {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;
using Index = Eigen::Index;

Index ControlCount(const BsplineSolid::Bases& bases) {
  return Index{bases[0].size()} * bases[1].size() * bases[2].size();
}

int ControlIndex(const BsplineSolid::Bases& bases, int i, int j, int k) {
  return i + bases[0].size() * (j + bases[1].size() * k);
}

// One row for each sample: the values of the basis functions there.
SparseMatrix SampleMatrix(const BsplineSolid::Bases& bases, std::span<const SolidSample> samples) {
  Entries entries;
  const auto count = [&](int direction) { return bases[static_cast<std::size_t>(direction)].degree() + 1; };
  entries.reserve(samples.size() * static_cast<std::size_t>(count(0) * count(1) * count(2)));
  for (std::size_t s = 0; s < samples.size(); ++s) {
    std::array<BsplineBasis::Local, 3> local;
    for (std::size_t d = 0; d < 3; ++d) local[d] = bases[d].At(samples[s].parameters[static_cast<Index>(d)]);
    const auto value = [&](std::size_t direction, int i) {
      return local[direction].value[static_cast<std::size_t>(i)];
    };
    for (int k = 0; k < count(2); ++k) {
      for (int j = 0; j < count(1); ++j) {
        for (int i = 0; i < count(0); ++i) {
          entries.emplace_back(static_cast<int>(s),
                               ControlIndex(bases, local[0].first + i, local[1].first + j, local[2].first + k),
                               value(0, i) * value(1, j) * value(2, k));
        }
      }
    }
  }
  SparseMatrix matrix(static_cast<Index>(samples.size()), ControlCount(bases));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Weights of control points i - 1, i, i + 1 in the second difference at i.
std::array<double, 3> SecondDifference(const BsplineBasis& basis, int i) {
  const double mean = (basis.back() - basis.front()) / (basis.size() - 1);
  const double before = basis.Greville(i) - basis.Greville(i - 1), after = basis.Greville(i + 1) - basis.Greville(i);
  return {mean / before, -mean / before - mean / after, mean / after};
}

// One row for each second difference along each direction.
SparseMatrix DifferenceMatrix(const BsplineSolid::Bases& bases) {
  Entries entries;
  int row = 0;
  for (int direction = 0; direction < 3; ++direction) {
    const BsplineBasis& basis = bases[static_cast<std::size_t>(direction)];
    std::array<int, 3> first = {0, 0, 0}, last = {bases[0].size(), bases[1].size(), bases[2].size()};
    ++first[static_cast<std::size_t>(direction)];
    --last[static_cast<std::size_t>(direction)];
    const int stride = direction == 0 ? 1 : direction == 1 ? bases[0].size() : bases[0].size() * bases[1].size();
    for (int k = first[2]; k < last[2]; ++k) {
      for (int j = first[1]; j < last[1]; ++j) {
        for (int i = first[0]; i < last[0]; ++i, ++row) {
          const int center = ControlIndex(bases, i, j, k);
          const auto [before, here, after] =
              SecondDifference(basis, std::array{i, j, k}[static_cast<std::size_t>(direction)]);
          entries.emplace_back(row, center - stride, before);
          entries.emplace_back(row, center, here);
          entries.emplace_back(row, center + stride, after);
        }
      }
    }
  }
  SparseMatrix matrix(row, ControlCount(bases));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

std::optional<SolidFit> FitBsplineSolid(BsplineSolid::Bases bases, std::span<const SolidSample> samples,
                                        double smoothing, const std::stop_token& stop) {
  if (samples.empty()) return std::nullopt;
  ThrowIfStopped(stop);
  const SparseMatrix functions = SampleMatrix(bases, samples), differences = DifferenceMatrix(bases);
  ThrowIfStopped(stop);
  const double per_sample = 1 / static_cast<double>(samples.size());
  const double per_control = smoothing / static_cast<double>(ControlCount(bases));
  const SparseMatrix normal = per_sample * SparseMatrix(functions.transpose() * functions) +
                              per_control * SparseMatrix(differences.transpose() * differences);
  Eigen::MatrixX3d positions(static_cast<Index>(samples.size()), 3);
  for (std::size_t s = 0; s < samples.size(); ++s) positions.row(static_cast<Index>(s)) = samples[s].position;
  // Subtracts the mean first: coordinates may be large compared with the body.
  const Eigen::RowVector3d mean = positions.colwise().mean();
  positions.rowwise() -= mean;

  ThrowIfStopped(stop);
  const Eigen::SimplicialLDLT<SparseMatrix> solver(normal);
  ThrowIfStopped(stop);
  if (solver.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixX3d net = solver.solve(per_sample * (functions.transpose() * positions));
  if (!net.allFinite()) return std::nullopt;

  const Eigen::VectorXd distances = (functions * net - positions).rowwise().norm();
  std::vector<Vec3> controls;
  for (Index c = 0; c < net.rows(); ++c) controls.emplace_back((net.row(c) + mean).transpose());
  return SolidFit{BsplineSolid(std::move(bases), std::move(controls)), std::sqrt(distances.squaredNorm() * per_sample),
                  distances.maxCoeff()};
}

}  // namespace fascicle
