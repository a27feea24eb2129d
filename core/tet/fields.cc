#include "core/tet/fields.h"

#include <cmath>

#include "core/tet/element.h"

namespace fascicle {
namespace {

constexpr std::size_t kGrain = 512;

std::vector<double> Velocities(const TetBody& body, const NodalVector& v) {
  std::vector<double> values;
  values.reserve(3 * (body.node_end - body.node_begin));
  for (std::size_t n = body.node_begin; n < body.node_end; ++n) values.insert(values.end(), v[n].begin(), v[n].end());
  return values;
}

double VonMises(const Mat3& sigma) {
  const Mat3 deviator = sigma - sigma.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5 * deviator.squaredNorm());
}

// Calls set(F, sigma, values of the element) for every element, sigma = P F^T / J.
template <class Set>
std::vector<double> OfStress(const TetModel& model, const TetBody& body, int components, double activation,
                             const NodalVector& x, ThreadTeam& team, const Set& set) {
  std::vector<double> values(static_cast<std::size_t>(components) * (body.tet_end - body.tet_begin));
  std::visit(
      [&](const auto& law) {
        team.For(body.tet_end - body.tet_begin, kGrain, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            const std::size_t e = body.tet_begin + i;
            const Mat3 F = EdgeMatrix(x, model.corners()[e]) * model.Dm_inverse()[e];
            const Mat3 P = law.Stress(F, FibreState{model.fibres()[e], activation});
            const Mat3 sigma = P * F.transpose() / Determinant(F);
            set(sigma, &values[components * i]);
          }
        });
      },
      body.source->material);
  return values;
}

// Calls set(F, a0, values of the element) for every element.
template <class Set>
std::vector<double> OfDeformation(const TetModel& model, const TetBody& body, int components, const NodalVector& x,
                                  ThreadTeam& team, const Set& set) {
  std::vector<double> values(static_cast<std::size_t>(components) * (body.tet_end - body.tet_begin));
  team.For(body.tet_end - body.tet_begin, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t e = body.tet_begin + i;
      const Mat3 F = EdgeMatrix(x, model.corners()[e]) * model.Dm_inverse()[e];
      set(F, model.fibres()[e], &values[components * i]);
    }
  });
  return values;
}

}  // namespace

int ComponentsOf(OutputField field) {
  switch (field) {
    case OutputField::kVelocity:
    case OutputField::kFibreDirection:
      return 3;
    case OutputField::kCauchyStress:
      return 6;
    default:
      return 1;
  }
}

std::vector<double> FieldValuesOf(const TetModel& model, std::size_t body_index, OutputField field, double activation,
                                  const TetState& state, ThreadTeam& team) {
  const TetBody& body = model.bodies()[body_index];
  const NodalVector& x = state.positions;
  const int components = ComponentsOf(field);
  switch (field) {
    case OutputField::kVelocity:
      return Velocities(body, state.velocities);
    case OutputField::kCauchyStress:
      return OfStress(model, body, components, activation, x, team, [](const Mat3& sigma, double* value) {
        const double six[] = {sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(0, 2)};
        std::copy(std::begin(six), std::end(six), value);
      });
    case OutputField::kVonMisesStress:
      return OfStress(model, body, components, activation, x, team,
                      [](const Mat3& sigma, double* value) { *value = VonMises(sigma); });
    case OutputField::kPressure:
      return OfStress(model, body, components, activation, x, team,
                      [](const Mat3& sigma, double* value) { *value = sigma.trace() / 3; });
    case OutputField::kVolumeRatio:
      return OfDeformation(model, body, components, x, team,
                           [](const Mat3& F, const Vec3&, double* value) { *value = Determinant(F); });
    case OutputField::kFibreStretch:
      return OfDeformation(model, body, components, x, team,
                           [](const Mat3& F, const Vec3& a0, double* value) { *value = (F * a0).norm(); });
    case OutputField::kFibreDirection:
      return OfDeformation(model, body, components, x, team, [](const Mat3& F, const Vec3& a0, double* value) {
        const Vec3 a = F * a0;
        const Vec3 direction = a.squaredNorm() > 0 ? Vec3(a.normalized()) : Vec3(Vec3::Zero());
        std::copy(direction.begin(), direction.end(), value);
      });
  }
  return {};
}

}  // namespace fascicle
