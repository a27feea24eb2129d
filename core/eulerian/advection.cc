#include "core/eulerian/advection.h"

namespace fascicle {
namespace {

constexpr std::size_t kAdvectionGrain = 256;

// The departure point of the flow that arrives at a node.
Vec3 Origin(const Flow& flow, std::size_t n) {
  const Vec3 x = flow.grid->NodePosition(flow.grid->NodeAt(n)), v = (*flow.v)[n];
  const KnownField velocity = {flow.v, flow.known};
  return x - flow.dt * Interpolate(*flow.grid, velocity, x - 0.5 * flow.dt * v).value_or(v);
}

// Limits a value to the range at the corners of the cell around a place; `otherwise` if one of them is not known.
Vec3 Limited(const Vec3& value, const Flow& flow, const std::vector<Vec3>& field, const Vec3& place,
             const Vec3& otherwise) {
  const GridIndex cell = flow.grid->PlaceOf(place).cell;
  Vec3 lowest = field[flow.grid->Corner(cell, 0)], highest = lowest;
  for (int c = 0; c < 8; ++c) {
    const std::size_t corner = flow.grid->Corner(cell, c);
    if ((*flow.known)[corner] == 0) return otherwise;
    lowest = lowest.cwiseMin(field[corner]);
    highest = highest.cwiseMax(field[corner]);
  }
  return value.cwiseMax(lowest).cwiseMin(highest);
}

}  // namespace

void Advect(const Flow& flow, const std::vector<Vec3>& field, ThreadTeam& team, std::vector<Vec3>& result) {
  result.resize(field.size());
  const KnownField values = {&field, flow.known};
  team.For(field.size(), kAdvectionGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      result[n] = field[n];
      if ((*flow.known)[n] == 0) continue;
      if (const std::optional<Vec3> value = Interpolate(*flow.grid, values, Origin(flow, n))) result[n] = *value;
    }
  });
}

void AdvectMacCormack(const Flow& flow, const std::vector<Vec3>& field, ThreadTeam& team, std::vector<Vec3>& result) {
  std::vector<Vec3> there, back;
  Advect(flow, field, team, there);
  Flow reverse = flow;
  reverse.dt = -flow.dt;
  Advect(reverse, there, team, back);
  result.resize(field.size());
  team.For(field.size(), kAdvectionGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      result[n] = there[n];
      if ((*flow.known)[n] == 0) continue;
      const Vec3 corrected = there[n] + 0.5 * (field[n] - back[n]);
      result[n] = Limited(corrected, flow, field, Origin(flow, n), there[n]);
    }
  });
}

}  // namespace fascicle
