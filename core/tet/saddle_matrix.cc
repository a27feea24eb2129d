#include "core/tet/saddle_matrix.h"

#include <algorithm>

#include "core/materials/spd.h"
#include "core/tet/floor_contact.h"

namespace fascicle {
namespace {

constexpr std::size_t kBlock = 1024;  // elements
constexpr std::size_t kRowGrain = 1024;

// What an element contributes: blocks (a, b), b <= a, of A, then the derivatives of the integrals of L_c J, c by node.
template <class Element>
struct ElementMatrices {
  static constexpr int kBlocks = Element::kNodes * (Element::kNodes + 1) / 2;
  static constexpr std::size_t kSize = 9 * kBlocks + 3 * 4 * Element::kNodes;
  static constexpr int BlockOf(int a, int b) { return a * (a + 1) / 2 + b; }

  explicit ElementMatrices(double* values) : values_(values) { std::fill(values, values + kSize, 0.0); }
  explicit ElementMatrices(const double* values) : values_(const_cast<double*>(values)) {}

  Eigen::Map<Mat3> A(int a, int b) const { return Eigen::Map<Mat3>(values_ + 9 * BlockOf(a, b)); }
  Eigen::Map<Vec3> B(int c, int a) const {
    return Eigen::Map<Vec3>(values_ + 9 * kBlocks + 3 * (Element::kNodes * c + a));
  }

 private:
  double* values_;
};

template <class Element>
void AddPoint(const Mat9& H, const Mat3& cofactor, const Eigen::Matrix<double, 3, Element::kNodes>& G, double volume,
              int q, const ElementMatrices<Element>& matrices) {
  for (int b = 0; b < Element::kNodes; ++b) {
    // Change of P with each component of node b.
    Eigen::Matrix<double, 9, 3> change = G(0, b) * H.leftCols<3>();
    change += G(1, b) * H.middleCols<3>(3);
    change += G(2, b) * H.rightCols<3>();
    change *= volume;
    for (int a = b; a < Element::kNodes; ++a) {
      matrices.A(a, b) += G(0, a) * change.template topRows<3>() + G(1, a) * change.template middleRows<3>(3) +
                          G(2, a) * change.template bottomRows<3>();
    }
    const Vec3 volume_change = volume * (cofactor * G.col(b));
    for (int c = 0; c < 4; ++c) matrices.B(c, b) += Element::Barycentric(q, c) * volume_change;
  }
}

}  // namespace

void SaddleMatrix::Multiply(const NodalVector& dx, std::span<const double> dp, ThreadTeam& team, NodalVector& force,
                            std::span<double> volume) const {
  fascicle::Multiply(pattern, A, dx, team, force);
  AddPressureForce(dp, 1, team, force);
  team.For(patches(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      double sum = 0;
      for (std::int32_t k = volume_pattern.begin[n]; k < volume_pattern.begin[n + 1]; ++k) {
        sum += B[k].dot(dx[volume_pattern.column[k]]);
      }
      volume[n] = sum - C[n] * dp[n];
    }
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

SaddleAssembly::SaddleAssembly(const TetModel& model) : model_(model) {
  for (const Vec3& m : model.inverse_mass()) matrix_.free.push_back({m[0] != 0, m[1] != 0, m[2] != 0});
  model.VisitElement([&]<class Element>(Element) { FindPattern<Element>(); });
}

template <class Element>
void SaddleAssembly::FindPattern() {
  const VolumePatches& patches = model_.patches();
  const auto has_patches = [&](std::size_t e) {
    return !patches.empty() && patches.of_element[e][0] != VolumePatches::kNone;
  };
  matrix_.pattern =
      PatternOfElements(model_.nodes(), model_.tetrahedra(), [&](std::size_t e) { return model_.NodesOf<Element>(e); });
  matrix_.A.resize(matrix_.pattern.blocks());
  matrix_.C.resize(patches.size());

  // Nodes of all elements around each patch.
  PatternBuilder raw;
  std::vector<std::int32_t> columns;
  for (std::size_t n = 0; n < patches.size(); ++n) {
    columns.clear();
    for (std::int32_t k = patches.begin[n]; k < patches.begin[n + 1]; ++k) {
      const auto nodes = model_.NodesOf<Element>(patches.corners[k] / 4);
      columns.insert(columns.end(), nodes.begin(), nodes.end());
    }
    raw.AddRow(columns);
  }
  raw_pattern_ = raw.Take();
  raw_B_.resize(raw_pattern_.blocks());
  if (patches.row.empty()) {
    matrix_.volume_pattern = raw_pattern_;
  } else {
    PatternBuilder smoothed;
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

  block_places_.reserve(Element::kNodes * Element::kNodes * model_.tetrahedra());
  volume_places_.reserve(4 * Element::kNodes * (patches.empty() ? 0 : model_.tetrahedra()));
  for (std::size_t e = 0; e < model_.tetrahedra(); ++e) {
    const auto nodes = model_.NodesOf<Element>(e);
    for (const std::int32_t a : nodes) {
      for (const std::int32_t b : nodes) block_places_.push_back(matrix_.pattern.PlaceOf(a, b));
    }
    if (patches.empty()) continue;
    for (int c = 0; c < 4; ++c) {
      for (const std::int32_t a : nodes) {
        volume_places_.push_back(has_patches(e) ? raw_pattern_.PlaceOf(patches.of_element[e][c], a) : -1);
      }
    }
  }
}

void SaddleAssembly::Assemble(const IncrementalPotential& potential, const NodalVector& x,
                              std::span<const double> acting, std::span<const double> ratio, ThreadTeam& team) {
  std::fill(matrix_.A.begin(), matrix_.A.end(), Mat3::Zero());
  std::fill(raw_B_.begin(), raw_B_.end(), Vec3::Zero());
  model_.VisitElement(
      [&]<class Element>(Element) { AssembleElements<Element>(potential, x, acting, Part::kExact, team); });
  SmoothVolumes(team);
  const auto diagonal = [&](std::size_t n) -> Mat3& {
    const auto i = static_cast<std::int32_t>(n);
    return matrix_.A[matrix_.pattern.PlaceOf(i, i)];
  };
  for (std::size_t n = 0; n < potential.inertia.size(); ++n) diagonal(n).diagonal().array() += potential.inertia[n];
  if (!potential.untangling) {
    ForFloorStiffness(model_, x, [&](std::size_t n, const Mat3& stiffness) { diagonal(n) += stiffness; });
  }
  const VolumePatches& patches = model_.patches();
  for (std::size_t n = 0; n < patches.size(); ++n) {
    matrix_.C[n] =
        potential.untangling ? 1 : patches.rest_volume[n] / PatchEnergy{patches.modulus[n]}.ConvexSlope(ratio[n]);
  }
  if (potential.untangling) std::fill(matrix_.B.begin(), matrix_.B.end(), Vec3::Zero());
}

void SaddleAssembly::AssembleProjection(const IncrementalPotential& potential, const NodalVector& x,
                                        std::span<const double> acting, ThreadTeam& team) {
  projection_.assign(matrix_.pattern.blocks(), Mat3::Zero());
  model_.VisitElement(
      [&]<class Element>(Element) { AssembleElements<Element>(potential, x, acting, Part::kProjection, team); });
}

template <class Element>
void SaddleAssembly::AssembleElements(const IncrementalPotential& potential, const NodalVector& x,
                                      std::span<const double> acting, Part part, ThreadTeam& team) {
  using Matrices = ElementMatrices<Element>;
  element_matrices_.resize(Matrices::kSize * std::min(kBlock, model_.tetrahedra()));
  for (const TetGroup& group : model_.groups()) {
    const TetBody& body = model_.bodies()[group.body];
    std::visit(
        [&]<class Law>(const std::vector<Law>& laws) {
          for (std::size_t begin = group.tet_begin; begin < group.tet_end; begin += kBlock) {
            const std::size_t end = std::min(begin + kBlock, group.tet_end);
            team.For(end - begin, 64, [&](std::size_t first, std::size_t last) {
              for (std::size_t e = begin + first; e < begin + last; ++e) {
                const Matrices matrices(&element_matrices_[Matrices::kSize * (e - begin)]);
                const auto values = ValuesOf<Element>(model_, e, x);
                for (int q = 0; q < Element::kPoints; ++q) {
                  const Mat3 F = GradientAt<Element>(model_, e, values, q);
                  Mat9 H =
                      PointPotential<Element, Law>(potential, model_, body, laws[model_.law_of()[e]], e, q).Tangent(F);
                  AddCofactorTangent(PatchPressure<Element>(model_.patches(), acting, e, q), F, H);
                  if (part == Part::kProjection) H = NearestPositive(H) - H;
                  AddPoint<Element>(H, Cofactor(F), ShapeGradients<Element>(model_, e, q),
                                    model_.rest_volume()[Element::kPoints * e + q], q, matrices);
                }
              }
            });
            AddBlock<Element>(begin, end, part, team);
          }
        },
        group.laws);
  }
}

template <class Element>
void SaddleAssembly::AddBlock(std::size_t begin, std::size_t end, Part part, ThreadTeam& team) {
  using Matrices = ElementMatrices<Element>;
  constexpr int kNodes = Element::kNodes;
  const auto matrices_of = [&](std::size_t e) {
    return Matrices(static_cast<const double*>(&element_matrices_[Matrices::kSize * (e - begin)]));
  };
  BlockValues& values = part == Part::kExact ? matrix_.A : projection_;
  team.For(model_.nodes(), kRowGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t e = begin; e < end; ++e) {
      const auto nodes = model_.NodesOf<Element>(e);
      const Matrices matrices = matrices_of(e);
      const std::int32_t* const places = &block_places_[kNodes * kNodes * e];
      for (int a = 0; a < kNodes; ++a) {
        const auto row = static_cast<std::size_t>(nodes[a]);
        if (row < first || row >= last) continue;
        for (int b = 0; b <= a; ++b) values[places[kNodes * a + b]] += matrices.A(a, b);
        for (int b = a + 1; b < kNodes; ++b) values[places[kNodes * a + b]] += matrices.A(b, a).transpose();
      }
    }
  });
  const VolumePatches& patches = model_.patches();
  if (patches.empty() || part == Part::kProjection) return;
  team.For(patches.size(), kRowGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t e = begin; e < end; ++e) {
      if (patches.of_element[e][0] == VolumePatches::kNone) continue;
      const Matrices matrices = matrices_of(e);
      for (int c = 0; c < 4; ++c) {
        const auto row = static_cast<std::size_t>(patches.of_element[e][c]);
        if (row < first || row >= last) continue;
        const std::int32_t* const places = &volume_places_[(4 * e + c) * kNodes];
        for (int a = 0; a < kNodes; ++a) raw_B_[places[a]] += matrices.B(c, a);
      }
    }
  });
}

// B = V W V^-1 of what it is before smoothing, V the patches' volumes at rest.
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
