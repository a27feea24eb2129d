// Supports and loads of the bodies.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "client/import/body_draft.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

constexpr double kMaxFactor = 1000, kMaxDisplacement = 10;  // limits of a scene's curves

// Limits the total number of look-ups, so that thousands of loads on a large set do not take hours.
class Budget {
 public:
  explicit Budget(XmlSource& source) : source_(source) {}
  bool Spend(std::size_t items, std::size_t times, pugi::xml_node node) {
    const double cost = static_cast<double>(items) * static_cast<double>(times);
    if (cost <= left_) {
      left_ -= cost;
      return true;
    }
    if (left_ > 0) source_.Fail(node, "there are too many supports and loads on large sets", "join those of one set");
    left_ = 0;
    return false;
  }

 private:
  XmlSource& source_;
  double left_ = 5e8;
};

// The supports of one node set.
struct SetSupport {
  std::string set;
  std::array<const Support*, 3> axes = {};
};

bool SameMotion(const Support& a, const Support& b) {
  if (a.motion.has_value() != b.motion.has_value() || a.rotation != b.rotation) return false;
  return !a.motion || (a.motion->value == b.motion->value && a.motion->controller == b.motion->controller);
}

const char* AxisName(int axis) { return axis == 0 ? "x" : axis == 1 ? "y" : "z"; }

// Groups supports by set, in the order in which sets first occur.
std::vector<SetSupport> BySet(const std::vector<Support>& supports, XmlSource& source) {
  std::vector<SetSupport> sets;
  std::map<std::string, std::size_t> index_of;
  for (const Support& support : supports) {
    const auto [found, is_new] = index_of.try_emplace(support.set, sets.size());
    if (is_new) sets.push_back({support.set, {}});
    const Support*& place = sets[found->second].axes[static_cast<std::size_t>(support.axis)];
    if (place != nullptr && !SameMotion(*place, support)) {
      source.Fail(support.node,
                  std::string("moves the set along ") + AxisName(support.axis) + " differently from line " +
                      std::to_string(source.LineOf(place->node)) + " does",
                  "keep one of them");
      continue;
    }
    if (place == nullptr) place = &support;
  }
  return sets;
}

// Reports nodes that two sets move differently.
class Conflicts {
 public:
  Conflicts(const Model& model, XmlSource& source) : model_(model), source_(source) {}

  void Add(const SetSupport& set, const std::vector<std::int32_t>& nodes) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Support* support = set.axes[axis];
      if (support == nullptr) continue;
      for (const std::int32_t n : nodes) {
        const auto [found, is_new] = holder_[axis].try_emplace(n, support);
        if (is_new || SameMotion(*found->second, *support)) continue;
        source_.Fail(support->node,
                     "moves node " + std::to_string(model_.mesh.ids[static_cast<std::size_t>(n)]) + " along " +
                         AxisName(static_cast<int>(axis)) + " differently from line " +
                         std::to_string(source_.LineOf(found->second->node)) + " does",
                     "take the node out of one of the sets");
        break;
      }
    }
  }

 private:
  const Model& model_;
  XmlSource& source_;
  std::array<std::unordered_map<std::int32_t, const Support*>, 3> holder_;
};

// Nodes outside of all deformable parts make no difference; mid-edge nodes without corners do.
void TellOfNoCorner(const std::vector<std::int32_t>& nodes, const std::vector<BodyDraft>& drafts, pugi::xml_node node,
                    XmlSource& source) {
  const bool any_middle = std::any_of(drafts.begin(), drafts.end(), [&](const BodyDraft& draft) {
    return std::any_of(nodes.begin(), nodes.end(), [&](std::int32_t n) { return draft.mesh.local.contains(n); });
  });
  if (any_middle) {
    source.Remark(Notice::Kind::kNotTaken, node, "none of its nodes is a corner of an element",
                  "add the corners next to them to the set");
  } else {
    source.Remark(Notice::Kind::kNote, node, "none of its nodes belongs to a deformable part: it changes nothing");
  }
}

bool HasAny(const BodyDraft& draft, const std::vector<std::int32_t>& nodes) {
  return std::any_of(nodes.begin(), nodes.end(), [&](std::int32_t n) { return draft.mesh.HasCorner(n); });
}

void AddRotation(const RigidRotation& rotation, const Model& model, CurveMaker& curves, v1::Constraint& constraint) {
  constexpr double kMaxAngle = 1000;
  const auto curve =
      curves.MakeMotion(rotation.angle.value, rotation.angle.controller, -kMaxAngle, kMaxAngle, rotation.angle.node);
  if (!curve) return;
  v1::Rotation& made = *constraint.mutable_motion()->mutable_rotation();
  for (const double component : rotation.point) made.add_point(model.units.to_scene_unit * component);
  for (const double component : rotation.axis) made.add_axis(component);
  *made.mutable_angle() = *curve;
}

void AddConstraint(const SetSupport& set, const std::vector<std::int32_t>& nodes, const Model& model,
                   CurveMaker& curves, Origins& origins, BodyDraft& draft) {
  origins[draft.path + "." + IndexPath("constraints", std::size_t(draft.body.constraints_size()))] =
      (set.axes[0]   ? set.axes[0]
       : set.axes[1] ? set.axes[1]
                     : set.axes[2])
          ->node;
  v1::Constraint& constraint = *draft.body.add_constraints();
  constraint.set_region(draft.NodeRegion(set.set, set.set.substr(set.set.starts_with('@') ? 1 : 0), nodes));
  const bool all = set.axes[0] && set.axes[1] && set.axes[2];
  if (all && set.axes[0]->rotation >= 0) {
    AddRotation(model.rotations[static_cast<std::size_t>(set.axes[0]->rotation)], model, curves, constraint);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Support* support = set.axes[static_cast<std::size_t>(axis)];
    if (support == nullptr) continue;
    const auto name = static_cast<v1::Axis>(v1::AXIS_X + axis);
    if (!all) constraint.add_axes(name);
    if (!support->motion) continue;
    const Driven& motion = *support->motion;
    const auto curve = curves.MakeMotion(motion.value * model.units.metre, motion.controller, -kMaxDisplacement,
                                         kMaxDisplacement, motion.node);
    if (!curve) continue;
    v1::AxisCurve& translation = *constraint.mutable_motion()->add_translation();
    translation.set_axis(name);
    *translation.mutable_curve() = *curve;
  }
}

// The nodes of quadratic elements that belong to a set, by the rule of the tet method: its corners, and the mid-edge
// nodes both of whose ends belong to it and that lie on the boundary or in an element all of whose corners belong to
// it.
std::set<std::int32_t> MembersOf(const std::vector<std::int32_t>& nodes, const Tetrahedra& all, const MeshBody& body) {
  const std::unordered_set<std::int32_t> chosen(nodes.begin(), nodes.end());
  std::set<std::array<std::int32_t, 2>> surface_edges;
  for (const Triangle& t : body.surface) {
    for (int c = 0; c < 3; ++c) {
      const auto [i, j] = std::minmax(t[c], t[(c + 1) % 3]);
      if (chosen.contains(i) && chosen.contains(j)) surface_edges.insert({i, j});
    }
  }
  std::set<std::int32_t> members;
  for (const std::size_t t : body.tetrahedra) {
    const Tetrahedron& corners = all.corners[t];
    int inside = 0;
    for (const std::int32_t n : corners) {
      if (!chosen.contains(n)) continue;
      members.insert(n);
      ++inside;
    }
    for (std::size_t k = 0; k < kTetEdges.size() && inside >= 2; ++k) {
      const auto [i, j] = std::minmax(corners[kTetEdges[k][0]], corners[kTetEdges[k][1]]);
      if (!chosen.contains(i) || !chosen.contains(j)) continue;
      if (inside == 4 || surface_edges.contains({i, j})) members.insert(all.middles[t][k]);
    }
  }
  return members;
}

class LoadMaker {
 public:
  LoadMaker(const Model& model, const Tetrahedra& all, XmlSource& source, CurveMaker& curves, Origins& origins,
            std::vector<BodyDraft>& drafts)
      : model_(model), all_(all), source_(source), curves_(curves), origins_(origins), drafts_(drafts) {}

  void AddForces(const NodalForces& forces, const std::vector<std::int32_t>& nodes) {
    bool any = false;
    for (BodyDraft& draft : drafts_) {
      if (!HasAny(draft, nodes)) continue;
      any = true;
      double count = 0;
      for (const std::int32_t n : nodes) count += draft.mesh.local.contains(n) ? 1 : 0;
      TellOfSharing(forces, nodes, draft);
      v1::Load* load = NewLoad(draft, forces.controller, forces.node);
      if (load == nullptr) continue;
      load->set_region(draft.NodeRegion(forces.set, forces.set, nodes));
      const Vec3 total = count * model_.units.newton * forces.each;
      for (const double component : total) load->mutable_nodal_force()->add_total(component);
    }
    if (!any) TellOfNoCorner(nodes, drafts_, forces.node, source_);
  }

  void AddSurfaceLoad(const SurfaceLoad& load, const Surface& surface) {
    std::size_t taken = 0;
    for (BodyDraft& draft : drafts_) taken += AddSurfaceLoad(load, surface, draft);
    const auto deformable = static_cast<std::size_t>(
        std::count_if(surface.facets.begin(), surface.facets.end(), [&](const Facet& f) { return IsDeformable(f); }));
    if (taken == 0 && deformable == 0) {
      source_.Remark(Notice::Kind::kNote, load.node,
                     "none of its facets belongs to a deformable part: it changes nothing");
    } else if (taken == 0) {
      source_.Remark(Notice::Kind::kNotTaken, load.node, "none of its facets is on the surface of a deformable part",
                     "remove it, or correct its surface");
    } else if (taken < deformable) {
      source_.Remark(Notice::Kind::kChanged, load.node,
                     std::to_string(deformable - taken) + " of " + std::to_string(surface.facets.size()) +
                         " facets are not on the surface of a deformable part",
                     "remove them from the surface");
    }
  }

 private:
  // Whether all corners of a facet belong to one deformable body.
  bool IsDeformable(const Facet& facet) const {
    return std::any_of(drafts_.begin(), drafts_.end(), [&](const BodyDraft& draft) {
      return std::all_of(facet.node.begin(), facet.node.begin() + facet.corners,
                         [&](std::int32_t n) { return draft.mesh.HasCorner(n); });
    });
  }

  // A new load with its scale over time; null after a problem.
  v1::Load* NewLoad(BodyDraft& draft, const std::optional<std::int64_t>& controller, pugi::xml_node node) {
    std::optional<v1::Curve> scale;
    if (controller) {
      scale = curves_.Make(1, controller, -kMaxFactor, kMaxFactor, node);
      if (!scale) return nullptr;
    }
    origins_[draft.path + "." + IndexPath("loads", std::size_t(draft.body.loads_size()))] = node;
    v1::Load* load = draft.body.add_loads();
    if (scale) *load->mutable_scale() = *scale;
    return load;
  }

  // The total is preserved in any case; the force on each node depends on the elements.
  void TellOfSharing(const NodalForces& forces, const std::vector<std::int32_t>& nodes, const BodyDraft& draft) {
    const Shape shape = model_.mesh.parts[static_cast<std::size_t>(draft.mesh.parts[0])].shape;
    bool same = shape == Shape::kTet4;
    if (draft.mesh.quadratic) {
      std::set<std::int32_t> own;
      for (const std::int32_t n : nodes) {
        if (draft.mesh.local.contains(n)) own.insert(n);
      }
      same = own == MembersOf(nodes, all_, draft.mesh);
    }
    if (same) return;
    source_.Remark(Notice::Kind::kChanged, forces.node,
                   "the total is shared equally by the set's corners and the mid-edge nodes between "
                   "them, which differ from the nodes of the set",
                   "write it as a traction on a surface");
  }

  std::size_t AddSurfaceLoad(const SurfaceLoad& load, const Surface& surface, BodyDraft& draft) {
    std::size_t taken = 0;
    std::map<double, std::vector<Triangle>> by_factor;
    for (std::size_t f = 0; f < surface.facets.size(); ++f) {
      std::vector<Triangle> own = TrianglesOf(surface.facets[f]);
      std::erase_if(own, [&](const Triangle& triangle) { return !draft.mesh.HasSurface(triangle); });
      taken += own.empty() ? 0 : 1;
      const double factor = load.factors.empty() ? 1 : load.factors[f];
      if (factor == 0) continue;
      for (const Triangle& triangle : own) {
        // A pressure here pushes inwards, in FEBio against the facet's own normal.
        const bool turns = load.follows && !draft.mesh.IsOutward(triangle);
        by_factor[turns ? -factor : factor].push_back(triangle);
      }
    }
    std::vector<Group> groups;
    for (auto& [factor, triangles] : by_factor) {
      if (triangles.empty()) continue;
      if (load.pressure == 0) {
        groups.push_back({factor * load.traction, 0, std::move(triangles)});
      } else if (load.follows) {
        groups.push_back({Vec3::Zero(), factor * load.pressure, std::move(triangles)});
      } else {
        AddDirections(factor * load.pressure, triangles, groups);
      }
      if (groups.size() <= kMaxGroups) continue;
      source_.Remark(Notice::Kind::kNotTaken, load.node,
                     "has more than 500 normal directions and values; a load here has one",
                     "divide the surface, or remove it");
      return taken;
    }
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::string key = groups.size() == 1 ? load.surface : load.surface + "," + Text(groups[g]);
      AddGroup(load, key, groups[g], draft);
    }
    return taken;
  }

  // Triangles with the same traction, or the same pressure that follows them.
  struct Group {
    Vec3 traction = Vec3::Zero();
    double pressure = 0;
    std::vector<Triangle> triangles;
  };
  static constexpr std::size_t kMaxGroups = 500;

  static std::string Text(const Group& group) {
    const Vec3& t = group.traction;
    char text[128];
    std::snprintf(text, sizeof(text), "%.17g,%.17g,%.17g", t[0], t[1], t[2]);
    if (group.pressure != 0) std::snprintf(text, sizeof(text), "%.17g", group.pressure);
    return text;
  }

  void AddGroup(const SurfaceLoad& source, const std::string& key, const Group& group, BodyDraft& draft) {
    v1::Load* load = NewLoad(draft, source.controller, source.node);
    if (load == nullptr) return;
    load->set_region(draft.SurfaceRegion(key, source.surface, group.triangles));
    if (group.pressure != 0) {
      load->mutable_pressure()->set_value(model_.units.pascal * group.pressure);
      return;
    }
    for (const double component : group.traction) load->mutable_traction()->add_vector(model_.units.pascal * component);
  }

  // Adds a group for each normal direction of the triangles.
  void AddDirections(double pressure, const std::vector<Triangle>& triangles, std::vector<Group>& groups) const {
    constexpr double kSame = 1e6;
    std::map<std::array<std::int64_t, 3>, Group> by_normal;
    for (const Triangle& triangle : triangles) {
      const auto x = [&](int c) { return model_.mesh.nodes[static_cast<std::size_t>(triangle[c])]; };
      const Vec3 normal = (x(1) - x(0)).cross(x(2) - x(0)).stableNormalized();
      std::array<std::int64_t, 3> key;
      for (int c = 0; c < 3; ++c) key[c] = std::llround(kSame * normal[c]);
      const auto place = by_normal.try_emplace(key, Group{-pressure * normal, 0, {}}).first;
      place->second.triangles.push_back(triangle);
      if (groups.size() + by_normal.size() > kMaxGroups) break;
    }
    for (auto& [key, group] : by_normal) groups.push_back(std::move(group));
  }

  const Model& model_;
  const Tetrahedra& all_;
  XmlSource& source_;
  CurveMaker& curves_;
  Origins& origins_;
  std::vector<BodyDraft>& drafts_;
};

}  // namespace

void SetSupports(const Model& model, XmlSource& source, CurveMaker& curves, Origins& origins,
                 std::vector<BodyDraft>& drafts) {
  NodeSets node_sets(model.mesh, source);
  Conflicts conflicts(model, source);
  Budget budget(source);
  for (const SetSupport& set : BySet(model.supports, source)) {
    const auto of_set = [&](const Support* support) { return support != nullptr; };
    const Support& first = **std::find_if(set.axes.begin(), set.axes.end(), of_set);
    const std::vector<std::int32_t>* nodes = node_sets.Find(set.set, first.node);
    if (nodes == nullptr || !budget.Spend(nodes->size(), 3 + drafts.size(), first.node)) continue;
    conflicts.Add(set, *nodes);
    bool any = false;
    for (BodyDraft& draft : drafts) {
      if (!HasAny(draft, *nodes)) continue;
      any = true;
      AddConstraint(set, *nodes, model, curves, origins, draft);
    }
    if (!any) TellOfNoCorner(*nodes, drafts, first.node, source);
  }
}

void SetLoads(const Model& model, const Tetrahedra& all, XmlSource& source, CurveMaker& curves, Origins& origins,
              std::vector<BodyDraft>& drafts) {
  NodeSets node_sets(model.mesh, source);
  LoadMaker maker(model, all, source, curves, origins, drafts);
  Budget budget(source);
  for (const NodalForces& forces : model.nodal_forces) {
    const std::vector<std::int32_t>* nodes = node_sets.Find(forces.set, forces.node);
    if (nodes == nullptr || forces.each.isZero(0)) continue;
    const std::size_t cost = nodes->size() * drafts.size() + all.corners.size();
    if (budget.Spend(cost, 2, forces.node)) maker.AddForces(forces, *nodes);
  }
  for (const SurfaceLoad& load : model.surface_loads) {
    const auto surface = model.mesh.surfaces.find(load.surface);
    if (surface == model.mesh.surfaces.end()) {
      source.Fail(load.node, "there is no surface " + Quoted(load.surface), "name a Surface of the mesh");
    } else if ((load.pressure != 0 || !load.traction.isZero(0)) &&
               budget.Spend(surface->second.facets.size(), 5 * drafts.size(), load.node)) {
      maker.AddSurfaceLoad(load, surface->second);
    }
  }
}

}  // namespace fascicle::client
