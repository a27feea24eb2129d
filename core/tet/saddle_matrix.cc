#include "core/tet/saddle_matrix.h"

#include <algorithm>

#include "core/tet/floor_contact.h"

namespace fascicle {
namespace {

// Least number of patch rows that a thread takes at a time.
constexpr std::size_t kPatchGrain = 64;

}  // namespace

void SaddleMatrix::Multiply(const NodalVector& dx, std::span<const double> dp, ThreadTeam& team, NodalVector& force,
                            std::span<double> volume) const {
  fascicle::Multiply(pattern, A, dx, team, force);
  AddPressureForce(dp, 1, team, force);
  team.For(patches(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) volume[n] = VolumeOf(n, dx) - C[n] * dp[n];
  });
}

void SaddleMatrix::AddPressureForce(std::span<const double> dp, double scale, ThreadTeam& team,
                                    NodalVector& force) const {
  if (C.empty()) return;
  const BlockPattern& of_node = volume_of_node.pattern;
  ForNodes(team, nodes(), [&](std::size_t n) {
    Vec3 sum = Vec3::Zero();
    for (std::int32_t k = of_node.begin[n]; k < of_node.begin[n + 1]; ++k) {
      sum += dp[of_node.column[k]] * B[volume_of_node.source[k]];
    }
    force[n] += scale * sum;
  });
}

void SaddleMatrix::IsolatePrescribed(ThreadTeam& team) {
  fascicle::IsolatePrescribed(pattern, free, team, A);
  for (std::size_t k = 0; k < B.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      if (!free[volume_pattern.column[k]][c]) B[k][c] = 0;
    }
  }
}

SaddleAssembly::SaddleAssembly(const TetModel& model, const std::stop_token& stop) : model_(model) {
  for (const Vec3& m : model.inverse_mass()) matrix_.free.push_back({m[0] != 0, m[1] != 0, m[2] != 0});
  model.VisitElement([&]<class Element>(Element) { FindPattern<Element>(stop); });
}

template <class Element>
void SaddleAssembly::FindPattern(const std::stop_token& stop) {
  constexpr int kNodes = Element::kNodes;
  const VolumePatches& patches = model_.patches();
  const auto of_element = [&](std::size_t e) {
    ThrowIfStopped(stop);
    return model_.NodesOf<Element>(e);
  };
  const std::vector<LineSpringLoad>& lines = model_.position_loads().line_springs;
  if (lines.empty()) {
    matrix_.pattern = PatternOfElements(model_.nodes(), model_.elements(), of_element);
  } else {
    // A line spring couples its nodes as if they were those of one element.
    std::vector<std::vector<std::int32_t>> coupled;
    for (const LineSpringLoad& line : lines) coupled.push_back(fascicle::NodesOf(line));
    matrix_.pattern = PatternOfElements(model_.nodes(), model_.elements() + coupled.size(), [&](std::size_t e) {
      if (e >= model_.elements()) return coupled[e - model_.elements()];
      const auto nodes = of_element(e);
      return std::vector<std::int32_t>(nodes.begin(), nodes.end());
    });
  }
  layout_.emplace(model_, matrix_.pattern, stop);
  matrix_.A.resize(matrix_.pattern.blocks());

  matrix_.C.resize(patches.size());
  corner_begin_.assign(patches.size() + 1, 0);
  const auto for_corners = [&](const auto& visit) {
    for (std::size_t e = 0; e < patches.of_element.size(); ++e) {
      if (patches.of_element[e][0] == VolumePatches::kNone) continue;
      for (int c = 0; c < Element::kPatches; ++c) {
        visit(patches.of_element[e][c], static_cast<std::int32_t>(4 * e + c));
      }
    }
  };
  for_corners([&](std::int32_t n, std::int32_t) { ++corner_begin_[n + 1]; });
  for (std::size_t n = 0; n < patches.size(); ++n) corner_begin_[n + 1] += corner_begin_[n];
  corners_.resize(corner_begin_.back());
  std::vector<std::int32_t> next(corner_begin_.begin(), corner_begin_.end() - 1);
  for_corners([&](std::int32_t n, std::int32_t corner) { corners_[next[n]++] = corner; });

  PatternBuilder raw;
  std::vector<std::int32_t> columns;
  for (std::size_t n = 0; n < patches.size(); ++n) {
    ThrowIfStopped(stop);
    columns.clear();
    for (std::int32_t k = corner_begin_[n]; k < corner_begin_[n + 1]; ++k) {
      const auto nodes = model_.NodesOf<Element>(corners_[k] / 4);
      columns.insert(columns.end(), nodes.begin(), nodes.end());
    }
    raw.AddRow(columns);
  }
  raw_pattern_ = raw.Take();
  raw_B_.resize(raw_pattern_.blocks());
  volume_places_.resize(kNodes * corners_.size());
  for (std::size_t n = 0; n < patches.size(); ++n) {
    for (std::int32_t k = corner_begin_[n]; k < corner_begin_[n + 1]; ++k) {
      const auto nodes = model_.NodesOf<Element>(corners_[k] / 4);
      for (int a = 0; a < kNodes; ++a) {
        volume_places_[kNodes * static_cast<std::size_t>(k) + a] =
            raw_pattern_.PlaceOf(static_cast<std::int32_t>(n), nodes[a]);
      }
    }
  }
  FindSmoothedPattern();
}

// The pattern of B after smoothing.
void SaddleAssembly::FindSmoothedPattern() {
  const VolumePatches& patches = model_.patches();
  matrix_.volume_pattern = raw_pattern_;
  if (!patches.row.empty()) {
    PatternBuilder smoothed;
    std::vector<std::int32_t> columns;
    for (std::size_t n = 0; n < patches.size(); ++n) {
      columns.clear();
      for (std::int32_t k = patches.row[n]; k < patches.row[n + 1]; ++k) {
        const std::int32_t m = patches.neighbour[k];
        columns.insert(columns.end(), raw_pattern_.column.begin() + raw_pattern_.begin[m],
                       raw_pattern_.column.begin() + raw_pattern_.begin[m + 1]);
      }
      smoothed.AddRow(columns);
    }
    matrix_.volume_pattern = smoothed.Take();
  }
  matrix_.B.resize(matrix_.volume_pattern.blocks());
  matrix_.volume_of_node = TransposedPattern(matrix_.volume_pattern, model_.nodes());
}

void SaddleAssembly::Assemble(const IncrementalPotential& potential, const NodalVector& x,
                              const PressuresAndTouches& at, ThreadTeam& team, ForceWorkspace& workspace) {
  AssembleStiffness(model_, potential, x, at.acting, *layout_, team, workspace, matrix_.A);
  model_.VisitElement([&]<class Element>(Element) { AssembleVolumes<Element>(x, team); });
  SmoothVolumes(team);
  const auto diagonal = [&](std::size_t n) -> Mat3& {
    const auto i = static_cast<std::int32_t>(n);
    return matrix_.A[matrix_.pattern.PlaceOf(i, i)];
  };
  for (std::size_t n = 0; n < potential.inertia.size(); ++n) diagonal(n).diagonal().array() += potential.inertia[n];
  if (!potential.untangling) {
    ForFloorStiffness(model_, x, potential.floor_start,
                      [&](std::size_t n, const Mat3& stiffness) { diagonal(n) += stiffness; });
  }
  ForContactStiffness(at.touches, false, [&](std::int32_t row, std::int32_t column, const Mat3& block) {
    matrix_.A[matrix_.pattern.PlaceOf(row, column)] += block;
  });
  if (potential.expansion != nullptr) {
    for (const auto& [row, column, block] : potential.expansion->stiffness) {
      matrix_.A[matrix_.pattern.PlaceOf(row, column)] += block;
    }
  }
  matrix_.least_eigenvalue = potential.inertia.empty() ? 0 : 1;
  for (std::size_t n = 0; n < potential.inertia.size(); ++n) {
    const double largest = diagonal(n).cwiseAbs().rowwise().sum().maxCoeff();  // Gershgorin
    matrix_.least_eigenvalue = std::min(matrix_.least_eigenvalue, potential.inertia[n] / largest);
  }
  const VolumePatches& patches = model_.patches();
  for (std::size_t n = 0; n < patches.size(); ++n) {
    matrix_.C[n] =
        potential.untangling ? 1 : patches.rest_volume[n] / PatchEnergy{patches.modulus[n]}.ConvexSlope(at.ratio[n]);
  }
  if (potential.untangling) std::fill(matrix_.B.begin(), matrix_.B.end(), Vec3::Zero());
}

void SaddleAssembly::AssembleProjection(const IncrementalPotential& potential, const NodalVector& x,
                                        const PressuresAndTouches& at, ThreadTeam& team, ForceWorkspace& workspace) {
  projection_.resize(matrix_.pattern.blocks());
  fascicle::AssembleProjection(model_, potential, x, at.acting, *layout_, team, workspace, projection_);
  ForContactStiffness(at.touches, true, [&](std::int32_t row, std::int32_t column, const Mat3& block) {
    projection_[matrix_.pattern.PlaceOf(row, column)] -= block;
  });
}

// B before smoothing, row by row.
template <class Element>
void SaddleAssembly::AssembleVolumes(const NodalVector& x, ThreadTeam& team) {
  constexpr int kNodes = Element::kNodes;
  std::fill(raw_B_.begin(), raw_B_.end(), Vec3::Zero());
  team.For(raw_pattern_.rows(), kPatchGrain, [&](std::size_t first, std::size_t last) {
    for (std::int32_t k = corner_begin_[first]; k < corner_begin_[last]; ++k) {
      const std::size_t e = corners_[k] / 4;
      const auto values = ValuesOf<Element>(model_, e, x);
      for (int q = 0; q < Element::kPoints; ++q) {
        const Mat3 cofactor = Cofactor(GradientAt<Element>(model_, e, values, q));
        const auto G = ShapeGradients<Element>(model_, e, q);
        const double weight = Element::PatchWeight(q, corners_[k] % 4) * model_.rest_volume()[Element::kPoints * e + q];
        for (int a = 0; a < kNodes; ++a) {
          raw_B_[volume_places_[kNodes * static_cast<std::size_t>(k) + a]] += weight * (cofactor * G.col(a));
        }
      }
    }
  });
}

// B = V W V^-1 B_raw, with the rest volumes V of the patches.
void SaddleAssembly::SmoothVolumes(ThreadTeam& team) {
  const VolumePatches& patches = model_.patches();
  if (patches.row.empty()) {
    matrix_.B = raw_B_;
    return;
  }
  team.For(patches.size(), 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) {
      const BlockPattern& rows = matrix_.volume_pattern;
      std::fill(matrix_.B.begin() + rows.begin[n], matrix_.B.begin() + rows.begin[n + 1], Vec3::Zero());
      for (std::int32_t k = patches.row[n]; k < patches.row[n + 1]; ++k) {
        const std::int32_t m = patches.neighbour[k];
        const double weight = patches.weight[k] * patches.rest_volume[n] / patches.rest_volume[m];
        for (std::int32_t i = raw_pattern_.begin[m]; i < raw_pattern_.begin[m + 1]; ++i) {
          matrix_.B[rows.PlaceOf(static_cast<std::int32_t>(n), raw_pattern_.column[i])] += weight * raw_B_[i];
        }
      }
    }
  });
}

}  // namespace fascicle
