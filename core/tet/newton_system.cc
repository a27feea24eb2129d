#include "core/tet/newton_system.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/check.h"
#include "core/materials/spd.h"
#include "core/tet/floor_contact.h"

namespace fascicle {
namespace {

constexpr std::int32_t kNone = -1;

// Entries of the lower triangle of a matrix of n rows.
constexpr std::size_t EntriesOf(std::size_t n) { return n * (n + 1) / 2; }

// Element forces at a strain of 1e-5: a body at rest has none to compare with.
double ForceFloor(const TetModel& model) {
  constexpr double kSmallStrain = 1e-5;
  double squares = 0;
  for (const TetGroup& group : model.groups()) {
    const Material& material = model.bodies()[group.body].source->material;
    const double modulus = std::visit([](const auto& law) { return law.ShearModulus() + law.BulkModulus(); }, material);
    for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
      const double force =
          kSmallStrain * modulus * std::pow(model.rest_volume()[e * model.points_per_element()], 2.0 / 3);
      squares += force * force;
    }
  }
  return std::sqrt(squares);
}

}  // namespace

NewtonSystem::NewtonSystem(const TetModel& model) : model_(model) {
  unknown_of_node_.resize(model.nodes());
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    for (int c = 0; c < 3; ++c) unknown_of_node_[n][c] = model.inverse_mass()[n][c] == 0 ? kNone : unknowns_++;
  }
  unknown_of_patch_.resize(model.patches().size());
  for (std::int32_t& unknown : unknown_of_patch_) unknown = unknowns_++;
  model.VisitElement([&]<class Element>(Element) { FindPattern<Element>(); });
  values_.resize(rows_.size());
  compliance_.resize(unknown_of_patch_.size());
  right_side_.resize(unknowns_);
  force_floor_ = ForceFloor(model);
  FASCICLE_CHECK(unknowns_ == 0 || solver_.Analyze(unknowns_, rows_, columns_), "memory for the analysis");
}

// The patches whose theta the corners of an element take part in, ascending, with the part of each corner.
std::vector<NewtonSystem::PatchShare> NewtonSystem::SharesOf(std::size_t tet) const {
  const VolumePatches& patches = model_.patches();
  std::map<std::int32_t, std::array<double, 4>> shares;
  if (!patches.empty() && patches.of_element[tet][0] != VolumePatches::kNone) {
    for (int c = 0; c < 4; ++c) {
      const std::int32_t n = patches.of_element[tet][c];
      if (patches.row.empty()) {
        shares[n][c] = 1;
        continue;
      }
      for (std::int32_t k = patches.row[n]; k < patches.row[n + 1]; ++k) {
        shares[patches.neighbour[k]][c] = patches.weight[k];
      }
    }
  }
  std::vector<PatchShare> list;
  for (const auto& [patch, weights] : shares) list.push_back({patch, weights});
  return list;
}

template <class Element>
void NewtonSystem::FindPattern() {
  constexpr int kComponents = 3 * Element::kNodes;
  // Sorted by row and column: an entry's key and where it is used.
  struct Use {
    std::uint64_t key;
    std::size_t at;
  };
  std::vector<Use> uses;
  std::size_t at = 0;
  const auto use = [&](std::int32_t i, std::int32_t j) {
    if (i != kNone && j != kNone) {
      const auto [low, high] = std::minmax(i, j);
      uses.push_back({static_cast<std::uint64_t>(high) << 32 | static_cast<std::uint64_t>(low), at});
    }
    ++at;
  };
  share_begin_.push_back(0);
  for (std::size_t e = 0; e < model_.tetrahedra(); ++e) {
    const auto unknowns = UnknownsOf<Element>(e);
    for (int i = 0; i < kComponents; ++i) {
      for (int j = 0; j <= i; ++j) use(unknowns[i], unknowns[j]);
    }
    for (const PatchShare& share : SharesOf(e)) {
      shares_.push_back(share);
      for (int j = 0; j < kComponents; ++j) use(unknown_of_patch_[share.patch], unknowns[j]);
    }
    share_begin_.push_back(shares_.size());
  }
  node_blocks_begin_ = at;
  if (!model_.contact_nodes().empty()) {
    for (const auto& unknowns : unknown_of_node_) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j <= i; ++j) use(unknowns[i], unknowns[j]);
      }
    }
  }
  places_.assign(at, kNone);
  constexpr std::size_t kDiagonal = static_cast<std::size_t>(-1);
  for (std::int32_t k = 0; k < unknowns_; ++k) {
    at = kDiagonal;
    use(k, k);
  }
  std::stable_sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return a.key < b.key; });
  diagonal_.resize(unknowns_);
  for (std::size_t k = 0; k < uses.size(); ++k) {
    if (k == 0 || uses[k].key != uses[k - 1].key) {
      rows_.push_back(static_cast<std::int32_t>(uses[k].key >> 32));
      columns_.push_back(static_cast<std::int32_t>(uses[k].key & 0xffffffffu));
    }
    const auto place = static_cast<std::int32_t>(rows_.size() - 1);
    if (uses[k].at == kDiagonal) {
      diagonal_[rows_.back()] = place;
    } else {
      places_[uses[k].at] = place;
    }
  }
}

NewtonSystem::Evaluation NewtonSystem::Evaluate(const IncrementalPotential& potential, const NodalVector& x,
                                                std::span<const double> pressure, ThreadTeam& team,
                                                NodalVector& force) {
  forces_.element_forces.resize(model_.nodes_per_element() * model_.tetrahedra());
  const bool patches_valid = UpdatePatches(model_, x, team, forces_);
  Smooth(potential, pressure);
  Evaluation total =
      model_.VisitElement([&]<class Element>(Element) { return EvaluateElements<Element>(potential, x, team); });
  total.valid = potential.untangling || (total.smallest_ratio > 0 && patches_valid);
  GatherForces(model_, forces_.element_forces, team, force);
  const NodalVector& load = *potential.load;
  total.energy += SumOverNodes(team, model_.nodes(), [&](std::size_t n) {
    force[n] += load[n];
    double energy = -load[n].dot(x[n] - model_.rest_positions()[n]);
    if (!potential.inertia.empty()) {
      const Vec3 distance = x[n] - potential.inertia_centre[n];
      force[n] -= potential.inertia[n] * distance;
      energy += 0.5 * potential.inertia[n] * distance.squaredNorm();
    }
    return energy;
  });
  if (!potential.untangling) {
    AddFloorForce(model_, x, force);
    total.energy += FloorEnergy(model_, x);
  }
  total.valid &= std::isfinite(total.energy);
  const double loads = SumOverNodes(team, model_.nodes(), [&](std::size_t n) { return load[n].squaredNorm(); });
  total.force_scale = std::hypot(total.force_scale, force_floor_, std::sqrt(loads));
  if (!potential.inertia.empty()) {
    const double squares =
        SumOverNodes(team, model_.nodes(), [&](std::size_t n) { return (potential.inertia[n] * x[n]).squaredNorm(); });
    total.rounding = 4 * std::numeric_limits<double>::epsilon() * std::sqrt(squares);
  }
  return total;
}

template <class Element>
NewtonSystem::Evaluation NewtonSystem::EvaluateElements(const IncrementalPotential& potential, const NodalVector& x,
                                                        ThreadTeam& team) {
  Evaluation total;
  std::atomic<double> smallest = 1;
  double squares = 0;
  for (const TetGroup& group : model_.groups()) {
    const TetBody& body = model_.bodies()[group.body];
    std::visit(
        [&]<class Law>(const std::vector<Law>& laws) {
          total.energy += team.Sum(group.tet_end - group.tet_begin, [&](std::size_t begin, std::size_t end) {
            double energy = 0;
            for (std::size_t e = group.tet_begin + begin; e < group.tet_begin + end; ++e) {
              const auto values = ValuesOf<Element>(model_, e, x);
              std::array<Vec3, Element::kNodes> forces;
              forces.fill(Vec3::Zero());
              for (int q = 0; q < Element::kPoints; ++q) {
                const Mat3 F = GradientAt<Element>(model_, e, values, q);
                const double volume = model_.rest_volume()[Element::kPoints * e + q];
                TakeLeast(smallest, Determinant(F));
                const PointPotential<Element, Law> point(potential, model_, body, laws[model_.law_of()[e]], e, q);
                energy += volume * point.Energy(F);
                const Mat3 P = point.Stress(F) + PatchPressure<Element>(model_.patches(), acting_, e, q) * Cofactor(F);
                CornerValues corners;
                SetCornerForces(P, model_.Dm_inverse()[Element::kPoints * e + q], volume, corners);
                Element::AddCorners(corners, q, forces);
              }
              std::copy(forces.begin(), forces.end(), &forces_.element_forces[Element::kNodes * e]);
            }
            return energy;
          });
          squares += team.Sum(group.tet_end - group.tet_begin, [&](std::size_t begin, std::size_t end) {
            double sum = 0;
            for (std::size_t k = Element::kNodes * (group.tet_begin + begin);
                 k < Element::kNodes * (group.tet_begin + end); ++k) {
              sum += forces_.element_forces[k].squaredNorm();
            }
            return sum;
          });
        },
        group.laws);
  }
  total.force_scale = std::sqrt(squares);
  total.smallest_ratio = smallest.load();
  return total;
}

bool NewtonSystem::Factor(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> pressure,
                          double projection, ThreadTeam& team) {
  std::fill(values_.begin(), values_.end(), 0.0);
  untangling_ = potential.untangling;
  Smooth(potential, pressure);
  model_.VisitElement([&]<class Element>(Element) {
    SetElementMatrices<Element>(potential, x, projection, team);
    AddElementMatrices<Element>(potential.untangling);
  });
  if (!potential.inertia.empty()) {
    for (std::size_t n = 0; n < model_.nodes(); ++n) {
      for (const std::int32_t unknown : unknown_of_node_[n]) {
        if (unknown != kNone) values_[diagonal_[unknown]] += potential.inertia[n];
      }
    }
  }
  if (!potential.untangling) AddFloorMatrices(x);
  const VolumePatches& patches = model_.patches();
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const double slope = PatchEnergy{patches.modulus[n]}.ConvexSlope(forces_.ratio[n]);
    compliance_[n] = potential.untangling ? 1 : patches.rest_volume[n] / slope;
    values_[diagonal_[unknown_of_patch_[n]]] = -compliance_[n];
  }
  const DirectSolver::Factored factored = solver_.Factor(values_);
  return factored.ok && factored.negative_pivots == static_cast<std::int32_t>(patches.size());
}

// Of every element: the lower triangle of A, then the derivatives of the integrals of L_c J, a row for each corner.
template <class Element>
void NewtonSystem::SetElementMatrices(const IncrementalPotential& potential, const NodalVector& x, double projection,
                                      ThreadTeam& team) {
  constexpr int kComponents = 3 * Element::kNodes;
  constexpr std::size_t kSize = EntriesOf(kComponents) + 4 * kComponents;
  element_matrices_.resize(kSize * model_.tetrahedra());
  for (const TetGroup& group : model_.groups()) {
    const TetBody& body = model_.bodies()[group.body];
    ForElementsOfGroup(model_, group, team, [&]<class Law>(const Law& law, std::size_t e) {
      const auto values = ValuesOf<Element>(model_, e, x);
      Eigen::Matrix<double, kComponents, kComponents> A = Eigen::Matrix<double, kComponents, kComponents>::Zero();
      Eigen::Matrix<double, 4, kComponents> B = Eigen::Matrix<double, 4, kComponents>::Zero();
      for (int q = 0; q < Element::kPoints; ++q) {
        const double volume = model_.rest_volume()[Element::kPoints * e + q];
        const Mat3 F = GradientAt<Element>(model_, e, values, q);
        Mat9 H = PointPotential<Element, Law>(potential, model_, body, law, e, q).Tangent(F);
        AddCofactorTangent(PatchPressure<Element>(model_.patches(), acting_, e, q), F, H);
        if (projection > 0) H += projection * (NearestPositive(H) - H);
        const auto G = ShapeGradients<Element>(model_, e, q);
        const Mat3 cofactor = Cofactor(F);
        for (int b = 0; b < Element::kNodes; ++b) {
          // Change of P with each component of node b.
          Eigen::Matrix<double, 9, 3> change = G(0, b) * H.template leftCols<3>();
          change += G(1, b) * H.template middleCols<3>(3);
          change += G(2, b) * H.template rightCols<3>();
          change *= volume;
          for (int a = b; a < Element::kNodes; ++a) {
            A.template block<3, 3>(3 * a, 3 * b) += G(0, a) * change.template topRows<3>() +
                                                    G(1, a) * change.template middleRows<3>(3) +
                                                    G(2, a) * change.template bottomRows<3>();
          }
          const Vec3 volume_change = volume * (cofactor * G.col(b));
          for (int c = 0; c < 4; ++c) {
            B.template block<1, 3>(c, 3 * b) += Element::Barycentric(q, c) * volume_change.transpose();
          }
        }
      }
      double* entry = &element_matrices_[kSize * e];
      for (int i = 0; i < kComponents; ++i) {
        for (int j = 0; j <= i; ++j) *entry++ = A(i, j);
      }
      for (int c = 0; c < 4; ++c) {
        for (int j = 0; j < kComponents; ++j) *entry++ = B(c, j);
      }
    });
  }
}

void NewtonSystem::AddFloorMatrices(const NodalVector& x) {
  ForFloorStiffness(model_, x, [&](std::size_t n, const Mat3& stiffness) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) {
        const std::int32_t place = places_[node_blocks_begin_ + 6 * n + EntriesOf(i) + j];
        if (place != kNone) values_[place] += stiffness(i, j);
      }
    }
  });
}

template <class Element>
void NewtonSystem::AddElementMatrices(bool without_patches) {
  constexpr int kComponents = 3 * Element::kNodes;
  constexpr std::size_t kTriangle = EntriesOf(kComponents), kSize = kTriangle + 4 * kComponents;
  const std::int32_t* place = places_.data();
  const auto add = [&](double value) {
    if (*place != kNone) values_[*place] += value;
    ++place;
  };
  for (std::size_t e = 0; e < model_.tetrahedra(); ++e) {
    const double* const A = &element_matrices_[kSize * e];
    for (std::size_t k = 0; k < kTriangle; ++k) add(A[k]);
    const double* const B = A + kTriangle;
    for (std::size_t k = share_begin_[e]; k < share_begin_[e + 1]; ++k) {
      for (int j = 0; j < kComponents; ++j) {
        add(without_patches ? 0 : VolumeChange<kComponents>(shares_[k], B, j));
      }
    }
  }
}

void NewtonSystem::Solve(const NodalVector& force, const NodalVector& prescribed, std::span<const double> pressure,
                         NodalVector& dx, std::vector<double>& dp) {
  const VolumePatches& patches = model_.patches();
  for (std::size_t n = 0; n < model_.nodes(); ++n) {
    for (int c = 0; c < 3; ++c) {
      if (unknown_of_node_[n][c] != kNone) right_side_[unknown_of_node_[n][c]] = force[n][c];
    }
  }
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const double law = PatchEnergy{patches.modulus[n]}.Pressure(forces_.ratio[n]);
    right_side_[unknown_of_patch_[n]] = untangling_ ? 0 : compliance_[n] * (pressure[n] - law);
  }
  model_.VisitElement([&]<class Element>(Element) { MovePrescribed<Element>(prescribed); });
  solver_.Solve(right_side_);
  dx = prescribed;
  for (std::size_t n = 0; n < model_.nodes(); ++n) {
    for (int c = 0; c < 3; ++c) {
      if (unknown_of_node_[n][c] != kNone) dx[n][c] = right_side_[unknown_of_node_[n][c]];
    }
  }
  dp.resize(patches.size());
  for (std::size_t n = 0; n < patches.size(); ++n) dp[n] = right_side_[unknown_of_patch_[n]];
}

// Takes to the right side what the element matrices of the last Factor say of the prescribed change.
template <class Element>
void NewtonSystem::MovePrescribed(const NodalVector& prescribed) {
  constexpr int kComponents = 3 * Element::kNodes;
  constexpr std::size_t kTriangle = EntriesOf(kComponents), kSize = kTriangle + 4 * kComponents;
  for (std::size_t e = 0; e < model_.tetrahedra(); ++e) {
    const auto nodes = model_.NodesOf<Element>(e);
    const auto unknowns = UnknownsOf<Element>(e);
    const double* const A = &element_matrices_[kSize * e];
    const double* const B = A + kTriangle;
    for (int j = 0; j < kComponents; ++j) {
      const double move = prescribed[nodes[j / 3]][j % 3];
      if (unknowns[j] != kNone || move == 0) continue;
      for (int i = 0; i < kComponents; ++i) {
        if (unknowns[i] == kNone) continue;
        right_side_[unknowns[i]] -= A[EntriesOf(std::max(i, j)) + std::min(i, j)] * move;
      }
      for (std::size_t k = share_begin_[e]; k < share_begin_[e + 1]; ++k) {
        right_side_[unknown_of_patch_[shares_[k].patch]] -= VolumeChange<kComponents>(shares_[k], B, j) * move;
      }
    }
  }
}

template <class Element>
std::array<std::int32_t, 3 * Element::kNodes> NewtonSystem::UnknownsOf(std::size_t tet) const {
  const auto nodes = model_.NodesOf<Element>(tet);
  std::array<std::int32_t, 3 * Element::kNodes> unknowns;
  for (int i = 0; i < 3 * Element::kNodes; ++i) unknowns[i] = unknown_of_node_[nodes[i / 3]][i % 3];
  return unknowns;
}

// The pressures that act on elements.
void NewtonSystem::Smooth(const IncrementalPotential& potential, std::span<const double> pressure) {
  acting_.assign(pressure.size(), 0.0);
  if (potential.untangling) return;
  model_.patches().Smooth(pressure, acting_);
}

}  // namespace fascicle
