#include "client/import/bodies.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "core/geometry/faces.h"

namespace fascicle::client {
namespace {

// The body of each tetrahedron, counted from 0 in the order of first tetrahedra, by union-find over shared faces.
std::vector<std::size_t> BodyOf(std::size_t count, const std::vector<Face>& faces) {
  std::vector<std::size_t> parent(count);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].nodes != faces[i - 1].nodes) continue;
    const std::size_t a = root(static_cast<std::size_t>(faces[i].side / 4));
    const std::size_t b = root(static_cast<std::size_t>(faces[i - 1].side / 4));
    parent[std::max(a, b)] = std::min(a, b);  // roots are first tetrahedra
  }
  std::vector<std::size_t> body(count);
  std::size_t bodies = 0;
  for (std::size_t t = 0; t < count; ++t) body[t] = root(t) == t ? bodies++ : body[root(t)];
  return body;
}

void NumberNodes(const Tetrahedra& all, MeshBody& body) {
  for (const std::size_t t : body.tetrahedra) {
    body.nodes.insert(body.nodes.end(), all.corners[t].begin(), all.corners[t].end());
    if (all.middles[t][0] < 0) continue;
    body.quadratic = true;
    body.nodes.insert(body.nodes.end(), all.middles[t].begin(), all.middles[t].end());
  }
  std::sort(body.nodes.begin(), body.nodes.end());
  body.nodes.erase(std::unique(body.nodes.begin(), body.nodes.end()), body.nodes.end());
  body.local.reserve(body.nodes.size());
  for (std::size_t n = 0; n < body.nodes.size(); ++n) body.local[body.nodes[n]] = static_cast<std::int32_t>(n);
  body.is_corner.assign(body.nodes.size(), 0);
  for (const std::size_t t : body.tetrahedra) {
    for (const std::int32_t n : all.corners[t]) body.is_corner[static_cast<std::size_t>(body.local[n])] = 1;
  }
}

}  // namespace

bool MeshBody::IsOutward(const Triangle& triangle) const {
  const auto key = std::lower_bound(surface_keys.begin(), surface_keys.end(), Ascending(triangle));
  Triangle turned = surface[static_cast<std::size_t>(key - surface_keys.begin())];
  for (int turn = 0; turn < 3; ++turn) {
    if (turned == triangle) return true;
    std::rotate(turned.begin(), turned.begin() + 1, turned.end());
  }
  return false;
}

bool MeshBody::HasSurface(const Triangle& triangle) const {
  return std::binary_search(surface_keys.begin(), surface_keys.end(), Ascending(triangle));
}

std::vector<MeshBody> MakeBodies(const Tetrahedra& all) {
  const std::vector<Face> faces = SortedFaces(all.corners);
  const std::vector<std::size_t> body_of = BodyOf(all.corners.size(), faces);
  std::vector<MeshBody> bodies(all.corners.empty() ? 0 : 1 + *std::max_element(body_of.begin(), body_of.end()));
  for (std::size_t t = 0; t < body_of.size(); ++t) bodies[body_of[t]].tetrahedra.push_back(t);
  for (MeshBody& body : bodies) {
    NumberNodes(all, body);
    std::set<std::int32_t> parts;
    for (const std::size_t t : body.tetrahedra) parts.insert(all.part[t]);
    body.parts.assign(parts.begin(), parts.end());
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const bool is_shared = (i > 0 && faces[i].nodes == faces[i - 1].nodes) ||
                           (i + 1 < faces.size() && faces[i].nodes == faces[i + 1].nodes);
    if (is_shared) continue;
    const auto t = static_cast<std::size_t>(faces[i].side / 4);
    bodies[body_of[t]].surface.push_back(OutwardTriangle(all.corners[t], static_cast<int>(faces[i].side % 4)));
    bodies[body_of[t]].surface_keys.push_back(faces[i].nodes);  // sorted, as faces are
  }
  return bodies;
}

}  // namespace fascicle::client
