#include "core/eulerian/node_roles.h"

namespace fascicle {
namespace {

// Nodes closer to the surface than this are outside [cells]; otherwise round-off would decide for nodes on a surface
// along the grid.
constexpr double kSkin = 1e-3;

}  // namespace

void SetNodeRoles(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                  const std::vector<double>& mass, ThreadTeam& team, NodeRoles& roles) {
  const std::size_t count = mass.size();
  roles.support.assign(count, -1);
  roles.inside.assign(count, 0);
  const double skin = -kSkin * body.grid.spacing;
  team.For(count, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) roles.inside[n] = mass[n] > 0 && cells.distance[n] < skin ? 1 : 0;
  });
  if (!body.supports.empty()) {
    team.For(count, 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        if (mass[n] > 0) roles.support[n] = body.SupportOf(state.X[n]);
      }
    });
  }
  roles.constrained.clear();
  for (std::size_t n = 0; n < count; ++n) {
    if (mass[n] > 0 && roles.inside[n] == 0 && roles.support[n] < 0) roles.constrained.push_back({n, {}});
  }
  team.For(roles.constrained.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      NodeRoles::Constrained& constrained = roles.constrained[c];
      constrained.roots = ExtrapolationWeights(body.grid, body.grid.NodeAt(constrained.node), roles.inside);
    }
  });
  roles.constrained_of.assign(count, -1);
  for (std::size_t c = 0; c < roles.constrained.size(); ++c) {
    if (roles.constrained[c].roots.empty()) continue;
    roles.constrained_of[roles.constrained[c].node] = static_cast<std::int32_t>(c);
  }
}

}  // namespace fascicle
