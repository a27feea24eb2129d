#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "core/base/stop.h"
#include "core/geometry/faces.h"
#include "core/geometry/hexahedron.h"
#include "core/geometry/refinement.h"
#include "core/geometry/solid_cells.h"

namespace fascicle {
namespace {

using Nodes = std::vector<std::int32_t>;

class HexahedraRefiner {
 public:
  HexahedraRefiner(const TetMesh& coarse, const std::stop_token& stop) : coarse_(coarse), stop_(stop) {}

  RefinedHexahedra Refine() && {
    TetMesh& fine = result_.mesh;
    fine.nodes = coarse_.nodes;
    fine.hexahedra.reserve(kChildren * coarse_.hexahedra.size());
    for (const Hexahedron& hexahedron : coarse_.hexahedra) {
      ThrowIfStopped(stop_);
      Divide(hexahedron);
    }
    SplitHexahedra(fine);
    CopyElementTags();
    CopyTriangles();
    CopyNodeTags();
    return std::move(result_);
  }

 private:
  // The node in the middle of some corners: of an edge, a side or a hexahedron.
  std::int32_t MiddleOf(Nodes corners) {
    if (corners.size() == 1) return corners[0];
    std::sort(corners.begin(), corners.end());
    const auto next = static_cast<std::int32_t>(result_.mesh.nodes.size());
    const auto [place, is_new] = middles_.try_emplace(std::move(corners), next);
    if (is_new) {
      Vec3 sum = Vec3::Zero();
      for (const std::int32_t n : place->first) sum += coarse_.nodes[n];
      result_.mesh.nodes.emplace_back(sum / static_cast<double>(place->first.size()));
      result_.between.push_back(place->first);
    }
    return place->second;
  }

  // The node at coordinates 0, 1/2 or 1 of a hexahedron, given twice.
  std::int32_t NodeAt(const Hexahedron& hexahedron, const std::array<int, 3>& twice) {
    Nodes corners;
    for (int a = 0; a < 8; ++a) {
      bool is_beside = true;
      for (int d = 0; d < 3; ++d) is_beside &= twice[d] == 1 || IsFarNode(a, d) == (twice[d] == 2);
      if (is_beside) corners.push_back(hexahedron[a]);
    }
    return MiddleOf(std::move(corners));
  }

  void Divide(const Hexahedron& hexahedron) {
    for (int child = 0; child < 8; ++child) {
      Hexahedron& part = result_.mesh.hexahedra.emplace_back();
      for (int a = 0; a < 8; ++a) {
        std::array<int, 3> twice;
        for (int d = 0; d < 3; ++d) twice[d] = (child >> d & 1) + (IsFarNode(a, d) ? 1 : 0);
        part[a] = NodeAt(hexahedron, twice);
      }
    }
  }

  void CopyElementTags() {
    constexpr int kTetrahedra = 6;
    const int parts = static_cast<int>(kChildren);
    for (std::size_t t = 0; t < coarse_.tetrahedron_tags.size(); t += kTetrahedra) {
      result_.mesh.tetrahedron_tags.insert(result_.mesh.tetrahedron_tags.end(), kTetrahedra * kChildren,
                                           coarse_.tetrahedron_tags[t]);
    }
    for (const auto& [t, tag] : coarse_.further_tags) {
      if (t % kTetrahedra != 0) continue;
      for (int k = 0; k < kTetrahedra * parts; ++k) result_.mesh.further_tags.push_back({parts * t + k, tag});
    }
  }

  // The four parts of every side of which a triangle has a tag, as triangles.
  void CopyTriangles() {
    if (coarse_.tagged_triangles.empty()) return;
    std::map<Triangle, Quad> side_of;
    for (const Hexahedron& hexahedron : coarse_.hexahedra) {
      for (const SolidSide& side : SidesOf(SolidShape::kHexahedron)) {
        const Quad quad = {hexahedron[side[0]], hexahedron[side[1]], hexahedron[side[2]], hexahedron[side[3]]};
        for (int c = 0; c < 4; ++c) side_of[Ascending({quad[c], quad[(c + 1) % 4], quad[(c + 2) % 4]})] = quad;
      }
    }
    std::set<std::pair<Quad, std::int32_t>> seen;
    for (std::size_t i = 0; i < coarse_.tagged_triangles.size(); ++i) {
      const auto side = side_of.find(Ascending(coarse_.tagged_triangles[i]));
      const std::int32_t tag = coarse_.triangle_tags[i];
      if (side == side_of.end() || !seen.insert({side->second, tag}).second) continue;
      const Quad& q = side->second;
      for (int c = 0; c < 4; ++c) {
        const Quad part = {q[c], MiddleOf({q[c], q[(c + 1) % 4]}), MiddleOf({q[0], q[1], q[2], q[3]}),
                           MiddleOf({q[(c + 3) % 4], q[c]})};
        for (const Triangle& triangle : SplitQuad(part)) {
          result_.mesh.tagged_triangles.push_back(triangle);
          result_.mesh.triangle_tags.push_back(tag);
        }
      }
    }
  }

  // A node between nodes all of which have a tag has it, too.
  void CopyNodeTags() {
    TetMesh& fine = result_.mesh;
    fine.tagged_nodes = coarse_.tagged_nodes;
    fine.node_tags = coarse_.node_tags;
    std::set<std::pair<std::int32_t, std::int32_t>> tagged;  // tag and node
    std::set<std::int32_t> tags(coarse_.node_tags.begin(), coarse_.node_tags.end());
    for (std::size_t i = 0; i < coarse_.tagged_nodes.size(); ++i) {
      tagged.insert({coarse_.node_tags[i], coarse_.tagged_nodes[i]});
    }
    for (const std::int32_t tag : tags) {
      for (std::size_t i = 0; i < result_.between.size(); ++i) {
        const Nodes& ends = result_.between[i];
        if (!std::all_of(ends.begin(), ends.end(), [&](std::int32_t n) { return tagged.contains({tag, n}); })) continue;
        fine.tagged_nodes.push_back(static_cast<std::int32_t>(coarse_.nodes.size() + i));
        fine.node_tags.push_back(tag);
      }
    }
  }

  const TetMesh& coarse_;
  const std::stop_token& stop_;
  std::map<Nodes, std::int32_t> middles_;
  RefinedHexahedra result_;
};

}  // namespace

RefinedHexahedra RefinedIntoHexahedra(const TetMesh& mesh, const std::stop_token& stop) {
  return HexahedraRefiner(mesh, stop).Refine();
}

}  // namespace fascicle
