#include "core/eulerian/stiffness.h"

#include <Eigen/LU>

#include <algorithm>

#include "core/materials/spd.h"

namespace fascicle {
namespace {

constexpr std::size_t kGrain = 64;

// V/J (F x I) A (F^T x I) dt^2: of T by columns to L by columns.
Mat9 SpatialTangent(const EulerianBody& body, const Mat3& Fe, const FibreState& fibre, double factor) {
  const Mat9 A = NearestPositive(std::visit([&](const auto& law) { return law.Tangent(Fe, fibre); }, body.material));
  Mat9 Q = Mat9::Zero();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) Q.block<3, 3>(3 * row, 3 * col) = Fe(row, col) * Mat3::Identity();
  }
  return factor * Q * A * Q.transpose();
}

}  // namespace

ElasticStiffness::ElasticStiffness(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                                   const NodalForces& nodes, const std::vector<int>& number, double dt,
                                   ThreadTeam& team)
    : nodes_(&nodes), number_(&number), team_(&team), cells_(cells.solid.size()) {
  team.For(cells_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      cells_[c] = MakeCell(body, state, cells, nodes, cells.solid[c], dt);
    }
  });
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] >= 0) unknown_.push_back(n);
  }
  places_.resize(unknown_.size());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    for (std::size_t p = 0; p < cells_[c].parts.size(); ++p) {
      const int at = number[cells_[c].parts[p].node];
      if (at >= 0) places_[at].push_back({c, p});
    }
  }
}

ElasticStiffness::Cell ElasticStiffness::MakeCell(const EulerianBody& body, const EulerianState& state,
                                                  const EulerianCells& cells, const NodalForces& nodes,
                                                  std::size_t cell, double dt) const {
  const GridIndex at = body.grid.CellAt(cell);
  std::vector<Part> all;
  for (int c = 0; c < 8; ++c) {
    Part part;
    const Vec3 gradient = CornerGradient(c, body.grid.spacing);
    for (int d = 0; d < 3; ++d) part.weight[d] = gradient[d];
    for (int a = 0; a < kPatterns; ++a) part.weight[3 + a] = CornerPattern(a, c) / 8.0;
    const std::size_t corner = body.grid.Corner(at, c);
    part.node = corner;
    if (nodes.mass[corner] > 0) all.push_back(part);
    const std::int32_t follower = nodes.follower_of[corner];
    if (follower < 0) continue;
    for (const NodeWeight& leader : nodes.followers[follower].leaders) {
      Part led = part;
      led.node = leader.node;
      for (double& weight : led.weight) weight *= leader.weight;
      all.push_back(led);
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Part& a, const Part& b) { return a.node < b.node; });
  Cell result;
  for (const Part& part : all) {
    if (result.parts.empty() || result.parts.back().node != part.node) {
      result.parts.push_back(part);
    } else {
      for (int r = 0; r < kRows; ++r) result.parts.back().weight[r] += part.weight[r];
    }
  }
  const double volume = cells.inside[cell] * std::pow(body.grid.spacing, 3);
  const Mat3 Fe = ElasticGradient(body, state, cells, cell);
  result.gradient = SpatialTangent(body, Fe, FibreOf(body, state, at), dt * dt * volume / cells.J[cell]);
  const Mat3 inverse = cells.F[cell].inverse();
  result.pattern = dt * dt * PatternStiffness(body, volume) * inverse.transpose() * inverse;
  return result;
}

// First what each cell pushes with, then what comes together at each node.
template <class VelocityOf>
void ElasticStiffness::Add(const VelocityOf& velocity_of, Eigen::VectorXd& product) const {
  std::vector<CellForces> forces(cells_.size());
  team_->For(cells_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
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
      for (int a = 3; a < kRows; ++a) forces[c][a] = cells_[c].pattern * rates[a];
    }
  });
  team_->For(places_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Vec3 sum = Vec3::Zero();
      for (const Place& place : places_[n]) {
        const Part& part = cells_[place.cell].parts[place.part];
        for (int r = 0; r < kRows; ++r) sum += part.weight[r] * forces[place.cell][r];
      }
      product.segment<3>(static_cast<Eigen::Index>(3 * n)) += sum;
    }
  });
}

void ElasticStiffness::AddProduct(const Eigen::VectorXd& v, Eigen::VectorXd& product) const {
  Add(
      [&](std::size_t node) {
        const int at = (*number_)[node];
        return at >= 0 ? Vec3(v.segment<3>(3 * static_cast<Eigen::Index>(at))) : Vec3(Vec3::Zero());
      },
      product);
}

Eigen::VectorXd ElasticStiffness::OfHeld(const std::vector<Vec3>& velocity) const {
  Eigen::VectorXd product = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * unknown_.size()));
  Add([&](std::size_t node) { return nodes_->support[node] >= 0 ? velocity[node] : Vec3(Vec3::Zero()); }, product);
  return product;
}

Eigen::VectorXd ElasticStiffness::Diagonal() const {
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * unknown_.size()));
  team_->For(places_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      for (const Place& place : places_[n]) {
        const Cell& cell = cells_[place.cell];
        const auto& weight = cell.parts[place.part].weight;
        for (int i = 0; i < 3; ++i) {
          double sum = 0;
          for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) sum += weight[k] * weight[l] * cell.gradient(3 * k + i, 3 * l + i);
          }
          for (int a = 3; a < kRows; ++a) sum += weight[a] * weight[a] * cell.pattern(i, i);
          diagonal[static_cast<Eigen::Index>(3 * n) + i] += sum;
        }
      }
    }
  });
  return diagonal;
}

}  // namespace fascicle
