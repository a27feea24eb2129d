#include "core/tet/forces.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/tet/points.h"

namespace fascicle {
namespace {

// Forces of the elements of one group; `v` may be null for no viscous stress.
template <class Element, bool kViscous, class Law>
ForceReport GroupForces(const std::vector<Law>& laws, const TetModel& model, const TetGroup& group,
                        const FibreDrive& drive, const NodalVector& x, const NodalVector* v, ThreadTeam& team,
                        ForceWorkspace& workspace) {
  const TetBody& body = model.bodies()[group.body];
  std::atomic<bool> valid = true;
  std::atomic<double> smallest_ratio = 1;
  ForceReport report;
  report.dissipated_power = team.Sum(group.tet_end - group.tet_begin, [&](std::size_t begin, std::size_t end) {
    double power = 0;
    double smallest = 1;
    bool all_valid = true;
    for (std::size_t e = group.tet_begin + begin; e < group.tet_begin + end; ++e) {
      const Law& law = laws[model.law_of()[e]];
      const auto values = ValuesOf<Element>(model, e, x);
      std::array<Vec3, Element::kNodes> forces;
      forces.fill(Vec3::Zero());
      for (int q = 0; q < Element::kPoints; ++q) {
        const double volume = model.rest_volume()[Element::kPoints * e + q];
        const Mat3 F = GradientAt<Element>(model, e, values, q);
        Mat3 P = law.Stress(F, FibreAt<Element>(model, e, drive, q));
        const double J = Determinant(F);
        const double pressure = PatchPressure<Element>(model.patches(), workspace.pressure, e, q);
        if (pressure != 0) P += pressure * Cofactor(F);
        smallest = std::min(smallest, J);
        all_valid &= J > 0 && std::isfinite(P.sum());
        if constexpr (kViscous) {
          const Mat3 F_rate = GradientAt<Element>(model, e, ValuesOf<Element>(model, e, *v), q);
          const ViscousStress viscous(F, F_rate, body.damping_mu, body.damping_lambda);
          P += F * viscous.S;
          power += volume * viscous.power;
        }
        CornerValues corners;
        SetCornerForces(P, model.Dm_inverse()[Element::kPoints * e + q], volume, corners);
        Element::AddCorners(corners, q, forces);
      }
      std::copy(forces.begin(), forces.end(), &workspace.element_forces[Element::kNodes * e]);
    }
    TakeLeast(smallest_ratio, smallest);
    if (!all_valid) valid.store(false, std::memory_order_relaxed);
    return power;
  });
  report.valid = valid.load();
  report.smallest_ratio = smallest_ratio.load();
  return report;
}

ForceReport AllForces(const TetModel& model, const FibreDrive& drive, const NodalVector& x, const NodalVector* v,
                      ThreadTeam& team, ForceWorkspace& workspace, NodalVector& force) {
  workspace.element_forces.resize(model.nodes_per_element() * model.tetrahedra());
  ForceReport total;
  total.valid = UpdatePatches(model, x, team, workspace);
  model.VisitElement([&]<class Element>(Element) {
    for (const TetGroup& group : model.groups()) {
      const bool viscous = v != nullptr && model.bodies()[group.body].HasStrainDamping();
      const ForceReport report = std::visit(
          [&](const auto& laws) {
            return viscous ? GroupForces<Element, true>(laws, model, group, drive, x, v, team, workspace)
                           : GroupForces<Element, false>(laws, model, group, drive, x, nullptr, team, workspace);
          },
          group.laws);
      total.valid &= report.valid;
      total.dissipated_power += report.dissipated_power;
      total.smallest_ratio = std::min(total.smallest_ratio, report.smallest_ratio);
    }
  });
  GatherForces(model, workspace.element_forces, team, force);
  return total;
}

template <class Visit>
void ForElements(ThreadTeam& team, const TetBody& body, const Visit& visit) {
  team.For(body.tet_end - body.tet_begin, kElementGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = body.tet_begin + begin; e < body.tet_begin + end; ++e) visit(e);
  });
}

// What one corner of rest shape gradient g contributes to the diagonal of -D, for unit volume: twice the dissipation
// of unit velocity of that corner along each axis i, where Edot = sym(F_i x g) with F_i row i of F.
Vec3 CornerDiagonal(const Mat3& F, const Vec3& g, double mu, double lambda) {
  const Vec3 rate = F * g;  // F_i . g for each i
  Vec3 diagonal;
  for (int i = 0; i < 3; ++i) {
    diagonal[i] = mu * (F.row(i).squaredNorm() * g.squaredNorm() + rate[i] * rate[i]) + lambda * rate[i] * rate[i];
  }
  return diagonal;
}

template <class Element>
void UpdateCornerVolumes(const TetModel& model, const NodalVector& x, ThreadTeam& team, ForceWorkspace& workspace) {
  const VolumePatches& patches = model.patches();
  team.For(patches.of_element.size(), kElementGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      if (patches.of_element[e][0] == VolumePatches::kNone) continue;
      const auto values = ValuesOf<Element>(model, e, x);
      std::array<double, 4> volumes = {};
      for (int q = 0; q < Element::kPoints; ++q) {
        const double J = Determinant(GradientAt<Element>(model, e, values, q));
        const double volume = model.rest_volume()[Element::kPoints * e + q] * J;
        for (int c = 0; c < 4; ++c) volumes[c] += Element::Barycentric(q, c) * volume;
      }
      workspace.corner_volume[e] = volumes;
    }
  });
}

// An element's share of the patches' energy [J]: the energy density of each, times the volume at its corner.
template <class Element>
double PatchEnergyOf(const TetModel& model, const ForceWorkspace& workspace, std::size_t e) {
  const VolumePatches& patches = model.patches();
  if (patches.empty() || patches.of_element[e][0] == VolumePatches::kNone) return 0;
  double energy = 0;
  for (int c = 0; c < 4; ++c) {
    const std::int32_t n = patches.of_element[e][c];
    energy += model.CornerVolume<Element>(e, c) * PatchEnergy{patches.modulus[n]}.Value(workspace.ratio[n]);
  }
  return energy;
}

}  // namespace

ForceReport ElasticForce(const TetModel& model, const FibreDrive& drive, const NodalVector& x, ThreadTeam& team,
                         ForceWorkspace& workspace, NodalVector& force) {
  return AllForces(model, drive, x, nullptr, team, workspace, force);
}

ForceReport ElasticAndViscousForce(const TetModel& model, const FibreDrive& drive, const NodalVector& x,
                                   const NodalVector& v, ThreadTeam& team, ForceWorkspace& workspace,
                                   NodalVector& force) {
  return AllForces(model, drive, x, &v, team, workspace, force);
}

void ViscousForce(const TetModel& model, const NodalVector& x, const NodalVector& v, ThreadTeam& team,
                  ForceWorkspace& workspace, NodalVector& force) {
  workspace.element_forces.resize(model.nodes_per_element() * model.tetrahedra());
  model.VisitElement([&]<class Element>(Element) {
    for (const TetBody& body : model.bodies()) {
      const bool damped = body.HasStrainDamping();
      ForElements(team, body, [&](std::size_t e) {
        std::array<Vec3, Element::kNodes> forces;
        forces.fill(Vec3::Zero());
        if (damped) {
          const auto positions = ValuesOf<Element>(model, e, x), velocities = ValuesOf<Element>(model, e, v);
          for (int q = 0; q < Element::kPoints; ++q) {
            const Mat3 F = GradientAt<Element>(model, e, positions, q);
            const ViscousStress viscous(F, GradientAt<Element>(model, e, velocities, q), body.damping_mu,
                                        body.damping_lambda);
            CornerValues corners;
            SetCornerForces(F * viscous.S, model.Dm_inverse()[Element::kPoints * e + q],
                            model.rest_volume()[Element::kPoints * e + q], corners);
            Element::AddCorners(corners, q, forces);
          }
        }
        std::copy(forces.begin(), forces.end(), &workspace.element_forces[Element::kNodes * e]);
      });
    }
  });
  GatherForces(model, workspace.element_forces, team, force);
}

void ViscousDiagonal(const TetModel& model, const NodalVector& x, ThreadTeam& team, ForceWorkspace& workspace,
                     NodalVector& diagonal) {
  workspace.element_forces.resize(model.nodes_per_element() * model.tetrahedra());
  model.VisitElement([&]<class Element>(Element) {
    for (const TetBody& body : model.bodies()) {
      ForElements(team, body, [&](std::size_t e) {
        const auto positions = ValuesOf<Element>(model, e, x);
        std::array<Vec3, Element::kNodes> sums;
        sums.fill(Vec3::Zero());
        for (int q = 0; q < Element::kPoints; ++q) {
          const Mat3 F = GradientAt<Element>(model, e, positions, q);
          const auto gradients = ShapeGradients<Element>(model, e, q);
          const double volume = model.rest_volume()[Element::kPoints * e + q];
          for (int a = 0; a < Element::kNodes; ++a) {
            sums[a] += volume * CornerDiagonal(F, gradients.col(a), body.damping_mu, body.damping_lambda);
          }
        }
        std::copy(sums.begin(), sums.end(), &workspace.element_forces[Element::kNodes * e]);
      });
    }
  });
  GatherForces(model, workspace.element_forces, team, diagonal);
}

double ElasticEnergy(const TetModel& model, std::size_t body, const FibreDrive& drive, const NodalVector& x,
                     ThreadTeam& team) {
  ForceWorkspace workspace;
  UpdatePatches(model, x, team, workspace);
  return model.VisitElement([&]<class Element>(Element) {
    double total = 0;
    for (const TetGroup& group : model.groups()) {
      if (group.body != body) continue;
      total += std::visit(
          [&](const auto& laws) {
            return team.Sum(group.tet_end - group.tet_begin, [&](std::size_t begin, std::size_t end) {
              double energy = 0;
              for (std::size_t e = group.tet_begin + begin; e < group.tet_begin + end; ++e) {
                const auto values = ValuesOf<Element>(model, e, x);
                for (int q = 0; q < Element::kPoints; ++q) {
                  const Mat3 F = GradientAt<Element>(model, e, values, q);
                  const double density = laws[model.law_of()[e]].Energy(F, FibreAt<Element>(model, e, drive, q));
                  energy += model.rest_volume()[Element::kPoints * e + q] * density;
                }
                energy += PatchEnergyOf<Element>(model, workspace, e);
              }
              return energy;
            });
          },
          group.laws);
    }
    return total;
  });
}

bool UpdatePatches(const TetModel& model, const NodalVector& x, ThreadTeam& team, ForceWorkspace& workspace) {
  const VolumePatches& patches = model.patches();
  if (patches.empty()) return true;
  workspace.corner_volume.resize(patches.of_element.size());
  for (auto* values : {&workspace.raw_ratio, &workspace.ratio, &workspace.own_pressure, &workspace.pressure}) {
    values->resize(patches.size());
  }
  model.VisitElement([&]<class Element>(Element) { UpdateCornerVolumes<Element>(model, x, team, workspace); });
  GatherCornerVolumes(model, team, workspace, workspace.raw_ratio);
  patches.Smooth(workspace.raw_ratio, workspace.ratio);
  bool valid = true;
  for (std::size_t n = 0; n < patches.size(); ++n) {
    workspace.own_pressure[n] = PatchEnergy{patches.modulus[n]}.Pressure(workspace.ratio[n]);
    valid &= workspace.ratio[n] > 0;
  }
  patches.Smooth(workspace.own_pressure, workspace.pressure);
  return valid;
}

void GatherCornerVolumes(const TetModel& model, ThreadTeam& team, const ForceWorkspace& workspace,
                         std::vector<double>& sums) {
  const VolumePatches& patches = model.patches();
  team.For(patches.size(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      double volume = 0;
      for (std::int32_t k = patches.begin[n]; k < patches.begin[n + 1]; ++k) {
        volume += workspace.corner_volume[patches.corners[k] / 4][patches.corners[k] % 4];
      }
      sums[n] = volume / patches.rest_volume[n];
    }
  });
}

void GatherForces(const TetModel& model, const NodalVector& element_forces, ThreadTeam& team, NodalVector& sums) {
  const auto& begin = model.node_use_begin();
  const auto& uses = model.node_uses();
  sums.resize(model.nodes());
  ForNodes(team, model.nodes(), [&](std::size_t n) {
    Vec3 sum = Vec3::Zero();
    for (std::int32_t k = begin[n]; k < begin[n + 1]; ++k) sum += element_forces[uses[k]];
    sums[n] = sum;
  });
}

}  // namespace fascicle
