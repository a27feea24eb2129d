#include "core/tet/newton_system.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/tet/floor_contact.h"

namespace fascicle {
namespace {

// Systems with more unknowns are solved iteratively.
constexpr std::size_t kMostDirectUnknowns = 6000;
// Up to this size, a step whose iterative solves fail is repeated with factorizations.
constexpr std::size_t kMostFallbackUnknowns = 60000;
// After this many failures of the iterative solver, the rest of the time step uses factorizations.
constexpr int kMostFailures = 2;

double ModulusOf(const Material& material) {
  return std::visit([](const auto& law) { return law.ShearModulus() + law.BulkModulus(); }, material);
}

// The modulus of an element's material [Pa].
double ModulusOf(const TetModel& model, const Body& body, std::size_t element) {
  const Parts<Material>& parts = body.tet().materials;
  if (parts.of.empty()) return ModulusOf(body.material);
  const std::int32_t part = parts.of[static_cast<std::size_t>(model.source_element()[element])];
  return ModulusOf(part == 0 ? body.material : parts.more[static_cast<std::size_t>(part - 1)]);
}

// That of its law alone, without what patches carry [Pa].
double ModulusOfLaw(const TetModel& model, const TetGroup& group, std::size_t element) {
  return std::visit(
      [&](const auto& laws) {
        const auto& law = laws[static_cast<std::size_t>(model.law_of()[element])];
        return law.ShearModulus() + law.BulkModulus();
      },
      group.laws);
}

// The least modulus of a body's materials [Pa].
double LeastModulus(const Body& body) {
  double least = ModulusOf(body.material);
  for (const Material& material : body.tet().materials.more) least = std::min(least, ModulusOf(material));
  return least;
}

// Rounding error of the elastic energy [J]: at every point a small difference of terms of the modulus' size.
double EnergyRounding(const TetModel& model) {
  double sum = 0;
  for (const TetGroup& group : model.groups()) {
    for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
      const double modulus = ModulusOf(model, *model.bodies()[group.body].source, e);
      for (int q = 0; q < model.points_per_element(); ++q) {
        sum += modulus * model.rest_volume()[static_cast<std::size_t>(model.points_per_element()) * e + q];
      }
    }
  }
  return std::numeric_limits<double>::epsilon() * sum;
}

// Element forces at a strain of 1e-5 of the softest material, as a scale for bodies at rest, which have no forces.
double ForceFloor(const TetModel& model) {
  constexpr double kSmallStrain = 1e-5;
  double squares = 0;
  for (const TetGroup& group : model.groups()) {
    const double modulus = LeastModulus(*model.bodies()[group.body].source);
    for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
      const double force =
          kSmallStrain * modulus * std::pow(model.rest_volume()[e * model.points_per_element()], 2.0 / 3);
      squares += force * force;
    }
  }
  return std::sqrt(squares);
}

// Rounding error of the elastic force on each node [N]. Strains are differences of positions, whose rounding error
// grows with the distance from the origin; stresses are small differences of terms of the modulus' size.
std::vector<double> ForceRounding(const TetModel& model) {
  constexpr double kOperations = 4;  // errors of several operations, added at random
  std::vector<double> squares(model.nodes());
  model.VisitElement([&]<class Element>(Element) {
    for (const TetGroup& group : model.groups()) {
      for (std::size_t e = group.tet_begin; e < group.tet_end; ++e) {
        const double modulus = ModulusOfLaw(model, group, e);
        const auto nodes = model.NodesOf<Element>(e);
        double volume = 0, reach = 0;
        for (int q = 0; q < Element::kPoints; ++q) volume += model.rest_volume()[Element::kPoints * e + q];
        for (const std::int32_t n : nodes) reach = std::max(reach, model.rest_positions()[n].norm());
        const double size = std::cbrt(volume);
        const double error = kOperations * std::numeric_limits<double>::epsilon() * modulus * size * (size + reach);
        for (const std::int32_t n : nodes) squares[n] += error * error;
      }
    }
  });
  for (double& square : squares) square = std::sqrt(square);
  return squares;
}

}  // namespace

NewtonSystem::NewtonSystem(const TetModel& model, Profile* profile, const std::stop_token& stop)
    : model_(model),
      profile_(profile),
      assembly_(model, stop),
      force_floor_(ForceFloor(model)),
      force_rounding_(ForceRounding(model)),
      energy_rounding_(EnergyRounding(model)),
      contact_(model) {
  unknowns_ = model.patches().size();
  for (const auto& free : assembly_.matrix().free) unknowns_ += std::count(free.begin(), free.end(), true);
  const LinearSolver choice = model.scene().tet.linear_solver;
  prefers_iterative_ =
      choice == LinearSolver::kIterative || (choice == LinearSolver::kAutomatic && unknowns_ > kMostDirectUnknowns);
  is_iterative_ = prefers_iterative_;
}

bool NewtonSystem::SolveDirectly() {
  if (!is_iterative_ || unknowns_ > kMostFallbackUnknowns) return false;
  is_iterative_ = false;
  return true;
}

void NewtonSystem::StartStep() {
  is_iterative_ = prefers_iterative_;
  solves_ = {};
  if (iterative_) iterative_->ForgetAggregation();
}

NewtonSystem::Evaluation NewtonSystem::Evaluate(const IncrementalPotential& potential, const NodalVector& x,
                                                std::span<const double> pressure, ThreadTeam& team,
                                                NodalVector& force) {
  const StageTimer timer(profile_, "evaluation");
  const bool patches_valid = UpdatePatches(model_, x, team, forces_);
  Smooth(potential, pressure);
  const ElementEvaluation elements = EvaluateElements(model_, potential, x, acting_, team, forces_, force);
  Evaluation total;
  total.energy_rounding = energy_rounding_;
  total.energy = elements.energy;
  total.smallest_ratio = elements.smallest_ratio;
  total.valid = potential.untangling || (total.smallest_ratio > 0 && patches_valid);
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
  if (potential.expansion != nullptr) {
    potential.expansion->Multiply(x, expansion_force_);
    total.energy += 0.5 * SumOverNodes(team, model_.nodes(), [&](std::size_t n) {
                      force[n] -= expansion_force_[n];
                      return expansion_force_[n].dot(x[n] - potential.expansion->centre[n]);
                    });
  }
  if (!potential.untangling) {
    AddFloorForce(model_, x, force, potential.floor_start);
    total.energy += FloorEnergy(model_, x, potential.floor_start);
  }
  if (potential.contact != nullptr) {
    const std::vector<Touch>& touches = contact_.Find(*potential.contact, x, team);
    AddContactForce(touches, force);
    total.energy += ContactEnergy(touches);
  }
  total.valid &= elements.finite && std::isfinite(total.energy);
  const double loads = SumOverNodes(team, model_.nodes(), [&](std::size_t n) { return load[n].squaredNorm(); });
  total.force_scale = std::hypot(std::sqrt(elements.squares), force_floor_, std::sqrt(loads));
  if (!potential.inertia.empty()) {
    const double squares =
        SumOverNodes(team, model_.nodes(), [&](std::size_t n) { return (potential.inertia[n] * x[n]).squaredNorm(); });
    total.rounding = 4 * std::numeric_limits<double>::epsilon() * std::sqrt(squares);
  }
  return total;
}

bool NewtonSystem::FindStep(const IncrementalPotential& potential, const NodalVector& x,
                            std::span<const double> pressure, const StepOptions& options, const NodalVector& force,
                            const NodalVector& prescribed, ThreadTeam& team, NodalVector& dx, std::vector<double>& dp) {
  if (!options.same_point) Assemble(potential, x, pressure, force, prescribed, team);
  if (options.projection != projection_) Project(potential, x, options.projection, prescribed, team);
  dp.resize(model_.patches().size());
  if (!Solve(options.tolerance, team, dx, dp)) return false;
  const FreeComponents& free = assembly_.matrix().free;
  ForNodes(team, model_.nodes(), [&](std::size_t n) {
    for (int c = 0; c < 3; ++c) dx[n][c] = free[n][c] ? dx[n][c] : prescribed[n][c];
  });
  return true;
}

bool NewtonSystem::FindChordStep(const IncrementalPotential& potential, std::span<const double> pressure,
                                 double tolerance, const NodalVector& force, ThreadTeam& team, NodalVector& dx,
                                 std::vector<double>& dp) {
  side_.assign(model_.nodes(), Vec3::Zero());
  volume_side_.assign(model_.patches().size(), 0.0);
  SetSide(potential, pressure, force, team);
  dp.resize(model_.patches().size());
  return Solve(tolerance, team, dx, dp);
}

double NewtonSystem::WorkOfPressures(const NodalVector& dx, std::span<const double> dp, ThreadTeam& team) const {
  const SaddleMatrix& matrix = assembly_.matrix();
  return team.Sum(dp.size(), [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t n = begin; n < end; ++n) sum += dp[n] * matrix.VolumeOf(n, dx);
    return sum;
  });
}

// Assembles the matrix and the right-hand side with exact tangents.
void NewtonSystem::Assemble(const IncrementalPotential& potential, const NodalVector& x,
                            std::span<const double> pressure, const NodalVector& force, const NodalVector& prescribed,
                            ThreadTeam& team) {
  const StageTimer timer(profile_, "assembly");
  Smooth(potential, pressure);
  assembly_.Assemble(potential, x, {acting_, forces_.ratio, TouchesOf(potential)}, team, forces_);
  projection_ = 0;
  has_projected_ = direct_is_current_ = iterative_is_current_ = false;
  SaddleMatrix& matrix = assembly_.matrix();
  side_.assign(model_.nodes(), Vec3::Zero());
  volume_side_.assign(matrix.patches(), 0.0);
  if (std::any_of(prescribed.begin(), prescribed.end(), [](const Vec3& d) { return d != Vec3::Zero(); })) {
    const std::vector<double> no_pressure(matrix.patches(), 0.0);
    matrix.Multiply(prescribed, no_pressure, team, side_, volume_side_);
  }
  SetSide(potential, pressure, force, team);
  matrix.IsolatePrescribed(team);
}

// Sets the right-hand side, from which it subtracts what it was: the product of the matrix with the prescribed change.
void NewtonSystem::SetSide(const IncrementalPotential& potential, std::span<const double> pressure,
                           const NodalVector& force, ThreadTeam& team) {
  const VolumePatches& patches = model_.patches();
  const SaddleMatrix& matrix = assembly_.matrix();
  ForNodes(team, model_.nodes(), [&](std::size_t n) {
    for (int c = 0; c < 3; ++c) side_[n][c] = matrix.free[n][c] ? force[n][c] - side_[n][c] : 0;
  });
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const double law = PatchEnergy{patches.modulus[n]}.Pressure(forces_.ratio[n]);
    volume_side_[n] = potential.untangling ? 0 : matrix.C[n] * (pressure[n] - law) - volume_side_[n];
  }
}

// Changes the projected part of the matrix.
void NewtonSystem::Project(const IncrementalPotential& potential, const NodalVector& x, double projection,
                           const NodalVector& prescribed, ThreadTeam& team) {
  const StageTimer timer(profile_, "projection");
  SaddleMatrix& matrix = assembly_.matrix();
  const BlockValues& whole = assembly_.projection();
  if (!has_projected_) {
    assembly_.AssembleProjection(potential, x, {acting_, forces_.ratio, TouchesOf(potential)}, team, forces_);
    Multiply(matrix.pattern, whole, prescribed, team, projected_side_);
    has_projected_ = true;
  }
  direct_is_current_ = iterative_is_current_ = false;
  const double change = projection - projection_;
  ForNodes(team, model_.nodes(), [&](std::size_t row) {
    for (int c = 0; c < 3; ++c) {
      if (matrix.free[row][c]) side_[row][c] -= change * projected_side_[row][c];
    }
    for (std::int32_t k = matrix.pattern.begin[row]; k < matrix.pattern.begin[row + 1]; ++k) {
      const auto& free_column = matrix.free[matrix.pattern.column[k]];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          if (matrix.free[row][i] && free_column[j]) matrix.A[k](i, j) += change * whole[k](i, j);
        }
      }
    }
  });
  projection_ = projection;
}

bool NewtonSystem::Solve(double tolerance, ThreadTeam& team, NodalVector& dx, std::vector<double>& dp) {
  const SaddleMatrix& matrix = assembly_.matrix();
  if (is_iterative_) {
    if (!iterative_) iterative_ = std::make_unique<IterativeSaddleSolver>(model_, matrix);
    if (!iterative_is_current_) {
      const StageTimer timer(profile_, "preconditioner");
      iterative_->SetUp(matrix, team);
      iterative_is_current_ = true;
    }
    const StageTimer timer(profile_, "iterative solve");
    const auto result = iterative_->Solve(matrix, side_, volume_side_, tolerance, team, dx, dp);
    ++solves_.iterative;
    solves_.iterations += result.iterations;
    if (result.ok && result.is_minimum) return true;
    // A completely projected matrix is that of a minimum, whatever the Ritz values.
    if (!result.is_minimum && projection_ < 1) return false;
    is_iterative_ = ++solves_.not_converged < kMostFailures;
  }
  const StageTimer timer(profile_, "direct solve");
  ++solves_.direct;
  if (!direct_) direct_ = std::make_unique<DirectSaddleSolver>(matrix, team.stop());
  if (!direct_is_current_ && !direct_->Factor(matrix)) return false;
  direct_is_current_ = true;
  direct_->Solve(side_, volume_side_, dx, dp);
  return true;
}

std::span<const Touch> NewtonSystem::TouchesOf(const IncrementalPotential& potential) const {
  return potential.contact == nullptr ? std::span<const Touch>() : std::span<const Touch>(contact_.touches());
}

// Computes the pressures that act on elements.
void NewtonSystem::Smooth(const IncrementalPotential& potential, std::span<const double> pressure) {
  acting_.assign(pressure.size(), 0.0);
  if (potential.untangling) return;
  model_.patches().Smooth(pressure, acting_);
}

}  // namespace fascicle
