#include <utility>

#include "server/translate/skeleton_parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

constexpr int kMostPathPoints = 100, kMostWraps = 20;

void SetSide(v1::WrapSide side, WrapSurface& surface) {
  if (side == v1::WRAP_SIDE_UNSPECIFIED) return;
  const int number = static_cast<int>(side) - 1;  // +x, -x, +y, ...
  surface.side_axis = number / 2;
  surface.side = number % 2 == 0 ? 1 : -1;
}

WrapSurface TranslateSurface(const v1::WrapSurface& wire, const std::string& path, const SkeletonNames& names,
                             Problems& problems) {
  WrapSurface surface;
  surface.name = wire.name();
  surface.bone = names.BoneOrGround(wire.bone(), JoinPath(path, "bone"), problems);
  surface.pose = ToPose(wire.placement());
  SetSide(wire.side(), surface);
  if (wire.has_cylinder()) {
    surface.kind = WrapSurface::Kind::kCylinder;
    surface.radius = wire.cylinder().radius();
    surface.length = wire.cylinder().length();
  } else if (wire.has_sphere()) {
    surface.kind = WrapSurface::Kind::kSphere;
    surface.radius = wire.sphere().radius();
  } else {
    surface.kind = WrapSurface::Kind::kEllipsoid;
    surface.radii = ToVec3(wire.ellipsoid().radii());
  }
  return surface;
}

void TranslateCondition(const v1::PathPoint& wire, const std::string& path, const SkeletonNames& names,
                        PathPoint& point, Problems& problems) {
  if (wire.condition().empty()) {
    if (wire.range_size() > 0) problems.Add(JoinPath(path, "range"), "has no coordinate", "name it by `condition`");
    return;
  }
  point.condition = names.Coordinate(wire.condition(), JoinPath(path, "condition"), problems);
  if (wire.range_size() != 2) {
    problems.Add(JoinPath(path, "range"), "is missing", "the lowest and the highest value of the coordinate");
  } else if (wire.range(0) > wire.range(1)) {
    problems.Add(JoinPath(path, "range"), "descends", "the lowest value comes first");
  } else {
    point.range = {wire.range(0), wire.range(1)};
  }
}

PathPoint TranslatePoint(const v1::PathPoint& wire, const std::string& path, const SkeletonNames& names,
                         Problems& problems) {
  PathPoint point;
  point.bone = names.BoneOrGround(wire.bone(), JoinPath(path, "bone"), problems);
  point.place = ToVec3(wire.place());
  TranslateCondition(wire, path, names, point, problems);
  for (int k = 0; k < wire.moved_size(); ++k) {
    const v1::MovedPlace& moved = wire.moved(k);
    const std::string moved_path = JoinPath(path, IndexPath("moved", static_cast<std::size_t>(k)));
    const int axis = static_cast<int>(moved.axis()) - 1;
    if (axis < 0 || axis > 2) {
      problems.Add(JoinPath(moved_path, "axis"), "is missing", "x, y or z");
      continue;
    }
    int& by = point.moved_by[static_cast<std::size_t>(axis)];
    if (by >= 0) problems.Add(JoinPath(moved_path, "axis"), "is given twice", "one entry for each axis");
    by = names.Coordinate(moved.coordinate(), JoinPath(moved_path, "coordinate"), problems);
    point.moved[static_cast<std::size_t>(axis)] =
        TranslateFunction(moved.function(), JoinPath(moved_path, "function"), problems);
  }
  return point;
}

PathWrap TranslateWrap(const v1::PathWrap& wire, const std::string& path, const SkeletonNames& names, int points,
                       Problems& problems) {
  PathWrap wrap;
  const auto surface = names.surfaces.Find(wire.surface(), JoinPath(path, "surface"), problems);
  wrap.surface = surface ? static_cast<int>(*surface) : 0;
  wrap.first = wire.first_point();
  wrap.last = wire.has_last_point() ? wire.last_point() : points - 1;
  if (wrap.last >= points || wrap.first >= wrap.last) {
    problems.Add(path,
                 "lies between points " + std::to_string(wrap.first) + " and " + std::to_string(wrap.last) + " of " +
                     std::to_string(points),
                 "the first point has index 0, and must come before the last one");
  }
  return wrap;
}

LineMuscle TranslateMuscle(const v1::LineMuscle& wire, const std::string& path, const SkeletonNames& names,
                           bool by_length, Problems& problems) {
  LineMuscle muscle;
  muscle.name = wire.name();
  CheckCount(wire.points_size(), kMostPathPoints, JoinPath(path, "points"), problems);
  CheckCount(wire.wraps_size(), kMostWraps, JoinPath(path, "wraps"), problems);
  if (wire.points_size() < 2)
    problems.Add(JoinPath(path, "points"), "are fewer than two", "an origin and an insertion");
  for (int k = 0; k < wire.points_size() && k < kMostPathPoints; ++k) {
    const std::string point = JoinPath(path, IndexPath("points", static_cast<std::size_t>(k)));
    muscle.points.push_back(TranslatePoint(wire.points(k), point, names, problems));
  }
  for (int k = 0; k < wire.wraps_size() && k < kMostWraps; ++k) {
    const std::string wrap = JoinPath(path, IndexPath("wraps", static_cast<std::size_t>(k)));
    muscle.wraps.push_back(TranslateWrap(wire.wraps(k), wrap, names, wire.points_size(), problems));
  }
  if (by_length && !wire.has_optimal_fibre_length()) {
    problems.Add(JoinPath(path, "optimal_fibre_length"), "is missing",
                 "it is needed by `strength` = force_length; the range is (0, 100] m");
  }
  muscle.max_isometric_force = wire.max_isometric_force();
  muscle.optimal_fibre_length = wire.optimal_fibre_length();
  muscle.tendon_slack_length = wire.tendon_slack_length();
  muscle.pennation = wire.pennation();
  muscle.hill.active_width = wire.active_width();
  muscle.hill.passive_strain = wire.passive_strain();
  muscle.hill.passive_shape = wire.passive_shape();
  return muscle;
}

}  // namespace

void TranslateLineMuscles(const v1::Skeleton& wire, const SkeletonNames& names, Skeleton& skeleton,
                          Problems& problems) {
  for (int i = 0; i < wire.wrap_surfaces_size(); ++i) {
    const std::string path = JoinPath("skeleton", IndexPath("wrap_surfaces", static_cast<std::size_t>(i)));
    skeleton.surfaces.push_back(TranslateSurface(wire.wrap_surfaces(i), path, names, problems));
  }
  const bool by_length = wire.strength() == v1::MUSCLE_STRENGTH_FORCE_LENGTH;
  for (int i = 0; i < wire.muscles_size(); ++i) {
    const std::string path = JoinPath("skeleton", IndexPath("muscles", static_cast<std::size_t>(i)));
    skeleton.muscles.push_back(TranslateMuscle(wire.muscles(i), path, names, by_length, problems));
  }
}

}  // namespace fascicle::server
