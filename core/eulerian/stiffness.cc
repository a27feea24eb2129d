#include "core/eulerian/stiffness.h"

#include <Eigen/LU>

#include <algorithm>

#include "core/eulerian/elasticity.h"
#include "core/materials/spd.h"

namespace fascicle {
namespace {

constexpr std::size_t kStiffnessGrain = 64;

// V/J (F x I) A (F^T x I) dt^2: maps L to T, both in column-major order.
//   factor  dt^2 V/J
Mat9 SpatialTangent(const Mat9& tangent, const Mat3& Fe, double factor) {
  const Mat9 A = NearestPositive(tangent);
  Mat9 Q = Mat9::Zero();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) Q.block<3, 3>(3 * row, 3 * col) = Fe(row, col) * Mat3::Identity();
  }
  return factor * Q * A * Q.transpose();
}

}  // namespace

ElasticStiffness::ElasticStiffness(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                                   const EulerianCells& cells, const NodeRoles& roles, const std::vector<int>& number,
                                   double dt, ThreadTeam& team)
    : roles_(&roles), number_(&number), team_(&team), cells_(cells.solid.size()) {
  std::visit(
      [&](const auto& law) {
        team.For(cells_.size(), kStiffnessGrain, [&](std::size_t begin, std::size_t end) {
          for (std::size_t c = begin; c < end; ++c) {
            cells_[c] = MakeCell(law, body, state, controls, cells, cells.solid[c], dt);
          }
        });
      },
      body.material);
  std::vector<int> prescribed_number(number.size(), -1);
  std::size_t free = 0;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] >= 0) ++free;
    if (!roles.IsPrescribed(n)) continue;
    prescribed_number[n] = static_cast<int>(prescribed_.size());
    prescribed_.push_back({n, {}});
  }
  places_.resize(free);
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    for (std::size_t p = 0; p < cells_[c].parts.size(); ++p) {
      const std::size_t node = cells_[c].parts[p].node;
      if (number[node] >= 0) places_[number[node]].push_back({c, p});
      if (prescribed_number[node] >= 0) prescribed_[prescribed_number[node]].places.push_back({c, p});
    }
  }
}

template <class Law>
ElasticStiffness::Cell ElasticStiffness::MakeCell(const Law& law, const EulerianBody& body, const EulerianState& state,
                                                  const BodyControls& controls, const EulerianCells& cells,
                                                  std::size_t cell, double dt) const {
  const GridIndex at = body.grid.CellAt(cell);
  Cell result;
  for (int c = 0; c < 8; ++c) {
    const Vec3 gradient = CornerGradient(c, body.grid.spacing);
    std::array<double, kRows> of_corner;
    for (int d = 0; d < 3; ++d) of_corner[d] = gradient[d];
    for (int mode = 0; mode < kHourglassModes; ++mode) of_corner[3 + mode] = HourglassSign(mode, c) / 8.0;
    roles_->ForRoots(body.grid.Corner(at, c), [&](std::size_t node, double weight) {
      Part part = {node, of_corner};
      for (double& w : part.weight) w *= weight;
      result.parts.push_back(part);
    });
  }
  MergeByNode(result.parts, [](Part& sum, const Part& part) {
    for (int r = 0; r < kRows; ++r) sum.weight[r] += part.weight[r];
  });
  const double volume = cells.inside[cell] * std::pow(body.grid.spacing, 3);
  const Mat3 Fe = ElasticGradient(body, state, cells, cell);
  const Mat9 tangent = law.Tangent(Fe, FibreOf(body, state, controls, at));
  result.gradient = SpatialTangent(tangent, Fe, dt * dt * volume / cells.J[cell]);
  const Mat3 inverse = cells.F[cell].inverse();
  const double stiffness = HourglassStiffness(law.ShearModulus(), volume, body.grid.spacing);
  result.hourglass = dt * dt * stiffness * inverse.transpose() * inverse;
  return result;
}

// The forces of each cell on its gradient and its hourglass modes.
template <class VelocityOf>
std::vector<ElasticStiffness::CellForces> ElasticStiffness::ForcesOf(const VelocityOf& velocity_of) const {
  std::vector<CellForces> forces(cells_.size());
  team_->For(cells_.size(), kStiffnessGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      CellForces rates;
      rates.fill(Vec3::Zero());
      for (const Part& part : cells_[c].parts) {
        const Vec3 v = velocity_of(part.node);
        for (int r = 0; r < kRows; ++r) rates[r] += part.weight[r] * v;
      }
      Eigen::Matrix<double, 9, 1> L;
      L << rates[0], rates[1], rates[2];
      const Eigen::Matrix<double, 9, 1> T = cells_[c].gradient * L;
      for (int d = 0; d < 3; ++d) forces[c][d] = T.segment<3>(3 * d);
      for (int a = 3; a < kRows; ++a) forces[c][a] = cells_[c].hourglass * rates[a];
    }
  });
  return forces;
}

Vec3 ElasticStiffness::SumAt(const std::vector<Place>& places, const std::vector<CellForces>& forces) const {
  Vec3 sum = Vec3::Zero();
  for (const Place& place : places) {
    const Part& part = cells_[place.cell].parts[place.part];
    for (int r = 0; r < kRows; ++r) sum += part.weight[r] * forces[place.cell][r];
  }
  return sum;
}

template <class VelocityOf>
void ElasticStiffness::Add(const VelocityOf& velocity_of, Eigen::Ref<Eigen::VectorXd> product) const {
  const std::vector<CellForces> forces = ForcesOf(velocity_of);
  team_->For(places_.size(), kStiffnessGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      product.segment<3>(static_cast<Eigen::Index>(3 * n)) += SumAt(places_[n], forces);
    }
  });
}

void ElasticStiffness::AddProduct(const Eigen::Ref<const Eigen::VectorXd>& v,
                                  Eigen::Ref<Eigen::VectorXd> product) const {
  Add(
      [&](std::size_t node) {
        const int at = (*number_)[node];
        return at >= 0 ? Vec3(v.segment<3>(3 * static_cast<Eigen::Index>(at))) : Vec3(Vec3::Zero());
      },
      product);
}

Eigen::VectorXd ElasticStiffness::OfPrescribed(const std::vector<Vec3>& velocity) const {
  Eigen::VectorXd product = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * places_.size()));
  Add([&](std::size_t node) { return roles_->IsPrescribed(node) ? velocity[node] : Vec3(Vec3::Zero()); }, product);
  return product;
}

void ElasticStiffness::AddPrescribedImpulses(const std::vector<Vec3>& velocity, std::vector<Vec3>& impulses) const {
  if (prescribed_.empty()) return;
  const std::vector<CellForces> forces = ForcesOf([&](std::size_t node) { return velocity[node]; });
  for (const Prescribed& prescribed : prescribed_) {
    impulses[prescribed.node] -= SumAt(prescribed.places, forces);
  }
}

Eigen::VectorXd ElasticStiffness::Diagonal() const {
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * places_.size()));
  team_->For(places_.size(), kStiffnessGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      for (const Place& place : places_[n]) {
        const Cell& cell = cells_[place.cell];
        const auto& weight = cell.parts[place.part].weight;
        for (int i = 0; i < 3; ++i) {
          double sum = 0;
          for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) sum += weight[k] * weight[l] * cell.gradient(3 * k + i, 3 * l + i);
          }
          for (int a = 3; a < kRows; ++a) sum += weight[a] * weight[a] * cell.hourglass(i, i);
          diagonal[static_cast<Eigen::Index>(3 * n) + i] += sum;
        }
      }
    }
  });
  return diagonal;
}

}  // namespace fascicle
