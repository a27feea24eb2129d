#include "client/import/body_draft.h"

#include <algorithm>

#include "client/import/sections.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {

std::string NewName(const std::string& wanted, std::set<std::string>& taken) {
  constexpr std::size_t kLongest = 56;  // of 64, to leave room for a number
  std::string name;
  for (const char c : wanted.substr(0, kLongest)) {
    const bool good =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
    name += good ? c : '_';
  }
  if (name.empty() || name == "." || name == "..") name = "part";
  std::string unique = name;
  // With many names, numbers continue from their count, to avoid a search from 2 for each.
  for (std::size_t k = taken.size() < 100 ? 2 : taken.size(); !taken.insert(unique).second; ++k) {
    unique = name + "_" + std::to_string(k);
  }
  return unique;
}

const std::string& BodyDraft::NewRegion(const std::string& key, const std::string& wanted, TaggedPart& part) {
  part.name = NewName(wanted, names_);
  part.tag = static_cast<std::int32_t>(1 + file.parts.size());
  v1::Region& region = *body.add_regions();
  region.set_name(part.name);
  region.set_physical_tag(part.tag);
  file.parts.push_back(std::move(part));
  return region_of_[key] = region.name();
}

const std::string& BodyDraft::NodeRegion(const std::string& key, const std::string& wanted,
                                         const std::vector<std::int32_t>& nodes) {
  if (const auto found = region_of_.find("n:" + key); found != region_of_.end()) return found->second;
  TaggedPart part;
  part.dimension = 0;
  for (const std::int32_t n : nodes) {
    if (mesh.HasCorner(n)) part.nodes.push_back(mesh.local.at(n));
  }
  return NewRegion("n:" + key, wanted, part);
}

const std::string& BodyDraft::SurfaceRegion(const std::string& key, const std::string& wanted,
                                            const std::vector<Triangle>& triangles) {
  if (const auto found = region_of_.find("s:" + key); found != region_of_.end()) return found->second;
  TaggedPart part;
  part.dimension = 2;
  for (Triangle triangle : triangles) {
    for (std::int32_t& n : triangle) n = mesh.local.at(n);
    part.triangles.push_back(triangle);
  }
  return NewRegion("s:" + key, wanted, part);
}

const std::string& BodyDraft::PartRegion(std::int32_t part, const std::string& wanted) {
  const std::string key = "p:" + std::to_string(part);
  if (const auto found = region_of_.find(key); found != region_of_.end()) return found->second;
  // The file already has the tags of tetrahedra: the parts come first.
  const auto at = std::find(mesh.parts.begin(), mesh.parts.end(), part) - mesh.parts.begin();
  TaggedPart& tagged = file.parts[static_cast<std::size_t>(at)];
  v1::Region& region = *body.add_regions();
  region.set_name(NewName(wanted, names_));
  region.set_physical_tag(tagged.tag);
  return region_of_[key] = region.name();
}

std::optional<std::vector<std::int32_t>> NodeSets::Collect(const std::string& kind, const std::string& name) const {
  std::vector<std::int32_t> nodes;
  if (kind == "surface") {
    const auto surface = mesh_.surfaces.find(name);
    if (surface == mesh_.surfaces.end()) return std::nullopt;
    nodes = surface->second.middles;
    for (const Facet& facet : surface->second.facets) {
      nodes.insert(nodes.end(), facet.node.begin(), facet.node.begin() + facet.corners);
    }
  } else if (kind == "elem_set") {
    const std::vector<std::int64_t>* ids = FindElements(mesh_, name);
    if (ids == nullptr) return std::nullopt;
    for (const std::int64_t id : *ids) {
      const auto found = mesh_.element_index.find(id);
      if (found == mesh_.element_index.end()) continue;  // already reported
      const auto& [p, e] = found->second;
      const Part& part = mesh_.parts[static_cast<std::size_t>(p)];
      const auto count = static_cast<std::ptrdiff_t>(part.count);
      if (e >= static_cast<std::int32_t>(part.size())) continue;  // refused
      const auto first = part.nodes.begin() + e * count;
      nodes.insert(nodes.end(), first, first + count);
    }
  } else {
    return std::nullopt;
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

const std::vector<std::int32_t>* NodeSets::Find(const std::string& set, pugi::xml_node node) {
  if (const auto own = mesh_.node_sets.find(set); own != mesh_.node_sets.end()) return &own->second.nodes;
  if (const auto known = found_.find(set); known != found_.end()) return &known->second;
  const std::size_t colon = set.find(':');
  if (set.starts_with('@') && colon != std::string::npos) {
    auto nodes = Collect(set.substr(1, colon - 1), set.substr(colon + 1));
    if (nodes) return &found_.emplace(set, std::move(*nodes)).first->second;
  }
  source_.Fail(node, "there is no node set " + Quoted(set),
               "name a NodeSet of the mesh, or @surface:NAME or @elem_set:NAME");
  return nullptr;
}

}  // namespace fascicle::client
