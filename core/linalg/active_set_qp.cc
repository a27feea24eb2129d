#include "core/linalg/active_set_qp.h"

#include <algorithm>
#include <limits>

#include "core/linalg/kkt_system.h"

namespace fascicle {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Exchanges of all wrong inequalities that may fail to reduce their number before they are exchanged one at a time.
constexpr int kPatience = 5;
// Part of the tolerance below which a wrong sign is ignored.
constexpr double kSignPart = 0.1;
// Violations above this part of the terms, with the system solved, mean that the constraints have no solution.
constexpr double kInfeasible = 1e-6;

// Most unknowns and rows of a system that is factored when MINRES fails.
constexpr Index kMostFactored = 50000;

double Largest(const VectorXd& x) { return x.size() == 0 ? 0 : x.lpNorm<Eigen::Infinity>(); }

// G v - b.
VectorXd Excess(const ConstraintRows& rows, const VectorXd& v) {
  return rows.count() == 0 ? VectorXd() : rows.G * v - rows.b;
}

// The largest of the terms of the constraints: the scale against which a residual counts as zero.
double TermsOf(const ConstraintRows& rows, const VectorXd& v) {
  if (rows.count() == 0) return 0;
  return std::max(Largest(rows.b), LargestTerms(rows.G, v, nullptr));
}

// Diagonal of G (diag M)^-1 G^T: the change of a constraint per unit of its own multiplier.
VectorXd Compliance(const QuadraticProgram& problem, const ConstraintRows& rows) {
  const VectorXd inverse = problem.M.diagonal().cwiseInverse();
  VectorXd diagonal = VectorXd::Zero(rows.count());
  for (Index i = 0; i < rows.count(); ++i) {
    for (RowMatrix::InnerIterator entry(rows.G, i); entry; ++entry) {
      diagonal[i] += entry.value() * entry.value() * inverse[entry.col()];
    }
  }
  return diagonal;
}

void TakeMultipliers(const KktSystem& system, const KktSystem::Result& result, QpSolution& solution) {
  Index row = system.volumes();
  solution.v = result.v;
  solution.volumes = result.y.head(row);
  solution.equalities = result.y.segment(row, solution.equalities.size());
  row += solution.equalities.size();
  for (std::size_t i = 0; i < solution.active.size(); ++i) {
    solution.contact[static_cast<Index>(i)] = solution.active[i] ? result.y[row++] : 0;
  }
}

KktSystem::Result Solve(const QuadraticProgram& problem, KktSystem& system, const QpSettings& settings,
                        QpReport& report) {
  KktSystem::Result result;
  if (settings.solver == KktSolver::kMinres) {
    result = system.SolveMinres(settings);
    report.minres_iterations.push_back(result.iterations);
    if (result.ok || system.size() > kMostFactored || problem.add_product) return result;
  }
  ++report.factored;
  return system.SolveDirect();
}

// Inequalities with the wrong sign: active ones with a negative multiplier, inactive ones that are violated.
std::vector<std::size_t> WrongSigns(const QpSolution& solution, const VectorXd& excess, const VectorXd& compliance,
                                    double zero) {
  std::vector<std::size_t> wrong;
  for (std::size_t i = 0; i < solution.active.size(); ++i) {
    const auto k = static_cast<Index>(i);
    const double value = solution.active[i] ? solution.contact[k] * compliance[k] : excess[k];
    if (value < -zero) wrong.push_back(i);
  }
  return wrong;
}

// Chooses which of the wrong inequalities are exchanged [Judice & Pires 1994].
class Exchange {
 public:
  void Apply(const std::vector<std::size_t>& wrong, std::vector<bool>& active) {
    if (wrong.size() < best_) {
      best_ = wrong.size();
      patience_ = kPatience;
    } else if (patience_ > 0) {
      --patience_;
    }
    if (patience_ > 0) {
      for (const std::size_t i : wrong) active[i] = !active[i];
    } else {
      active[wrong.back()] = !active[wrong.back()];  // always the last one, so that the method terminates [Murty 1974]
    }
  }

 private:
  std::size_t best_ = std::numeric_limits<std::size_t>::max();
  int patience_ = kPatience;
};

void SetResiduals(const QuadraticProgram& problem, const QpSolution& solution, const VectorXd& compliance,
                  QpReport& report) {
  const VectorXd forces = problem.Forces(solution.v);
  VectorXd r = forces - problem.p;
  const auto subtract = [&r](const ConstraintRows& rows, const VectorXd& y) {
    if (rows.count() > 0) r -= rows.G.transpose() * y;
  };
  subtract(problem.equalities, solution.equalities);
  subtract(problem.volumes, solution.volumes);
  subtract(problem.inequalities, solution.contact);
  const double size = forces.norm() + problem.p.norm();
  report.stationarity = size > 0 ? r.norm() / size : 0;
  VectorXd of_volumes = Excess(problem.volumes, solution.v);
  if (problem.E.size() > 0) of_volumes += problem.E * solution.volumes;
  const VectorXd excess = Excess(problem.inequalities, solution.v);
  const double terms = std::max({TermsOf(problem.equalities, solution.v), TermsOf(problem.volumes, solution.v),
                                 TermsOf(problem.inequalities, solution.v), std::numeric_limits<double>::min()});
  const double violated = excess.size() == 0 ? 0 : std::max(0.0, -excess.minCoeff());
  report.feasibility =
      std::max({Largest(Excess(problem.equalities, solution.v)), Largest(of_volumes), violated}) / terms;
  report.complementarity = 0;
  for (Index i = 0; i < excess.size(); ++i) {
    const double multiplier = solution.contact[i] * compliance[i] / terms;
    report.complementarity = std::max({report.complementarity, std::abs(multiplier * excess[i] / terms), -multiplier});
  }
}

}  // namespace

QpReport SolveQp(const QuadraticProgram& problem, const QpSettings& settings, QpSolution& solution) {
  const VectorXd compliance = Compliance(problem, problem.inequalities);
  const auto inequalities = static_cast<std::size_t>(problem.inequalities.count());
  if (solution.active.size() != inequalities) solution.active.assign(inequalities, false);
  solution.equalities = VectorXd::Zero(problem.equalities.count());
  solution.contact = VectorXd::Zero(problem.inequalities.count());
  Exchange exchange;
  QpReport report;
  while (report.active_set_iterations < settings.max_active_set_iterations) {
    KktSystem system(problem, solution.active, settings.team);
    KktSystem::Result result = Solve(problem, system, settings, report);
    ++report.active_set_iterations;
    if (result.v.size() == 0) break;
    TakeMultipliers(system, result, solution);
    const VectorXd excess = Excess(problem.inequalities, solution.v);
    const double zero = kSignPart * settings.tolerance * TermsOf(problem.inequalities, solution.v);
    const std::vector<std::size_t> wrong = WrongSigns(solution, excess, compliance, zero);
    if (wrong.empty()) {
      if (result.iterations == 0) {
        system.RemoveRegularization(result);
        TakeMultipliers(system, result, solution);
      }
      if (result.iterations > 0 && inequalities == 0) {
        report.stationarity = result.stationarity;
        report.feasibility = result.feasibility;
      } else {
        SetResiduals(problem, solution, compliance, report);
      }
      if (result.ok && report.feasibility <= settings.tolerance) report.status = QpStatus::kSolved;
      break;
    }
    exchange.Apply(wrong, solution.active);
  }
  if (report.status == QpStatus::kSolved || solution.v.size() == 0) return report;
  SetResiduals(problem, solution, compliance, report);
  if (report.feasibility > kInfeasible) report.status = QpStatus::kInfeasible;
  return report;
}

}  // namespace fascicle
