#include "core/eulerian/advection.h"

namespace fascicle {

void Advect(const EulerianGrid& grid, const std::vector<std::uint8_t>& known, const std::vector<Vec3>& v, double dt,
            const std::vector<Vec3>& field, ThreadTeam& team, std::vector<Vec3>& result) {
  result.resize(field.size());
  const KnownField velocity = {&v, &known}, values = {&field, &known};
  team.For(field.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      result[n] = field[n];
      if (known[n] == 0) continue;
      const Vec3 x = grid.NodePosition(grid.NodeAt(n));
      const Vec3 middle = Interpolate(grid, velocity, x - 0.5 * dt * v[n]).value_or(v[n]);
      if (const std::optional<Vec3> value = Interpolate(grid, values, x - dt * middle)) result[n] = *value;
    }
  });
}

}  // namespace fascicle
