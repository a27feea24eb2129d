#include <Eigen/Geometry>

#include <optional>
#include <utility>

#include "core/geometry/capsule_surface.h"
#include "server/translate/files.h"
#include "server/translate/skeleton_parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

constexpr std::size_t kMostTriangles = 1'000'000;

std::optional<TriangleMesh> ReadShape(const v1::FileRef& file, const std::string& path, const AssetReader& assets,
                                      const TranslateTools& tools, std::vector<std::string>& notes,
                                      Problems& problems) {
  const auto bytes = ReadFile(file, path, assets, problems);
  if (!bytes || file.path().empty()) return std::nullopt;
  Problems own;
  std::vector<std::string> remarks;
  auto surface = ReadSurface(file.path(), *bytes, own, tools.stop, &remarks);
  for (const std::string& remark : remarks) notes.push_back(JoinPath(path, "path") + ": " + remark);
  problems.Append(path, own);
  return surface;
}

std::optional<TriangleMesh> ShapeOf(const v1::BoneShape& wire, const std::string& path, const AssetReader& assets,
                                    const TranslateTools& tools, std::vector<std::string>& notes, Problems& problems) {
  if (wire.has_capsule()) {
    if (ToVec3(wire.scale()) != Vec3::Ones()) problems.Add(JoinPath(path, "scale"), "belongs to a file", "omit it");
    const v1::Capsule& capsule = wire.capsule();
    return CapsuleSurface(ToVec3(capsule.from()), capsule.radius(), ToVec3(capsule.to()),
                          capsule.has_end_radius() ? capsule.end_radius() : capsule.radius());
  }
  return ReadShape(wire.file(), JoinPath(path, "file"), assets, tools, notes, problems);
}

// Appends a shape to those of its bone.
void Append(const TriangleMesh& shape, const v1::BoneShape& wire, TriangleMesh& all) {
  const Vec3 scale = wire.has_file() ? ToVec3(wire.scale()) : Vec3(Vec3::Ones());
  const Pose pose = ToPose(wire.placement());
  const Mat3 R = RotationOf(pose);
  const auto first = static_cast<std::int32_t>(all.nodes.size());
  for (const Vec3& x : shape.nodes) all.nodes.push_back(pose.position + R * x.cwiseProduct(scale));
  for (Triangle triangle : shape.triangles) {
    if (scale.prod() < 0) std::swap(triangle[1], triangle[2]);  // a mirror image
    for (auto& node : triangle) node += first;
    all.triangles.push_back(triangle);
  }
}

}  // namespace

std::vector<TriangleMesh> TranslateBoneShapes(const v1::Skeleton& wire, const AssetReader& assets,
                                              const TranslateTools& tools, std::vector<std::string>& notes,
                                              Problems& problems) {
  std::vector<TriangleMesh> shapes(static_cast<std::size_t>(wire.bones_size()));
  std::size_t triangles = 0;
  for (int b = 0; b < wire.bones_size(); ++b) {
    const std::string bone = JoinPath("skeleton", IndexPath("bones", static_cast<std::size_t>(b)));
    for (int k = 0; k < wire.bones(b).shapes_size(); ++k) {
      const v1::BoneShape& from = wire.bones(b).shapes(k);
      const std::string path = JoinPath(bone, IndexPath("shapes", static_cast<std::size_t>(k)));
      const auto shape = ShapeOf(from, path, assets, tools, notes, problems);
      if (!shape) continue;
      triangles += shape->triangles.size();
      if (triangles > kMostTriangles) {
        problems.Add(path, "makes more than a million triangles of all bones", "use coarser surfaces");
        return shapes;
      }
      if (from.has_file() && ToVec3(from.scale()).prod() == 0) {
        problems.Add(JoinPath(path, "scale"), "has a factor of 0", "it flattens the shape");
        continue;
      }
      Append(*shape, from, shapes[static_cast<std::size_t>(b)]);
    }
  }
  return shapes;
}

}  // namespace fascicle::server
