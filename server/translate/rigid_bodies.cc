#include "server/translate/rigid_bodies.h"

#include <cstdint>
#include <utility>

#include "core/geometry/surface_repair.h"
#include "server/translate/files.h"
#include "server/translate/supports_and_loads.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

// Triangles of all rigid bodies together.
constexpr std::int64_t kMostObstacleTriangles = 2'000'000;
// Holes of a surface are closed up to this part of its diagonal.
constexpr double kLargestHole = 0.5;

// Translates one rigid body after another.
class RigidBodyReader {
 public:
  RigidBodyReader(const RigidBodySources& sources, const Names& bodies, std::vector<std::string>& notes,
                  Problems& problems)
      : sources_(sources), bodies_(bodies), notes_(notes), problems_(problems) {}

  RigidBody Read(const v1::RigidBody& wire, const std::string& path) {
    RigidBody rigid;
    rigid.name = wire.name();
    const double metres = MetresIn(wire.unit());
    rigid.pose = PoseAt(ToVec3(wire.position()) * metres, Turn(ToVec3(wire.rotation())));
    ReadShape(wire, metres, path, rigid);
    if (wire.has_motion()) {
      const std::string at = JoinPath(path, "motion");
      rigid.motion = TranslateMotion(wire.motion(), {true, true, true}, metres, at, problems_);
      if (!wire.motion().bone().empty()) {
        problems_.Add(JoinPath(at, "bone"), "is not supported yet for rigid bodies", "give translation and rotation");
      }
    }
    if (wire.has_free()) rigid.free = FreeOf(wire.free());
    rigid.bone = wire.bone();
    rigid.friction = wire.friction();
    for (int i = 0; i < wire.bodies_size(); ++i) {
      const std::string at = JoinPath(path, IndexPath("bodies", static_cast<std::size_t>(i)));
      if (const auto body = bodies_.Find(wire.bodies(i), at, problems_)) {
        rigid.bodies.push_back(static_cast<std::int32_t>(*body));
      }
    }
    return rigid;
  }

 private:
  static Eigen::Quaterniond Turn(const Vec3& rotation) {
    const double angle = rotation.norm();
    if (!(angle > 0)) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
  }

  // Turns the frame so that its z axis has a direction, which the message gives in the frame before.
  void PointAlong(const Vec3& direction, RigidBody& rigid) {
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), direction);
    rigid.pose = PoseAt(rigid.pose.position, QuaternionOf(rigid.pose) * turn);
  }

  void ReadShape(const v1::RigidBody& wire, double metres, const std::string& path, RigidBody& rigid) {
    switch (wire.shape_case()) {
      case v1::RigidBody::kPlane:
        rigid.shape = HalfSpace();
        return PointAlong(ToDirection(wire.plane().normal(), JoinPath(path, "plane.normal"), problems_), rigid);
      case v1::RigidBody::kSphere:
        rigid.shape = Ball{wire.sphere().radius() * metres};
        return;
      case v1::RigidBody::kBox:
        rigid.shape = Cuboid{ToVec3(wire.box().size()) * metres};
        return;
      case v1::RigidBody::kCylinder:
        rigid.shape = Cylinder{wire.cylinder().radius() * metres, wire.cylinder().length() * metres};
        return PointAlong(ToDirection(wire.cylinder().axis(), JoinPath(path, "cylinder.axis"), problems_), rigid);
      case v1::RigidBody::kSurface:
        rigid.shape = ReadSurfaceFile(wire, metres, JoinPath(path, "surface"));
        return;
      case v1::RigidBody::SHAPE_NOT_SET:
        return;  // the rules report it
    }
  }

  // A closed surface; without triangles if there is a problem.
  TriangleMesh ReadSurfaceFile(const v1::RigidBody& wire, double metres, const std::string& path) {
    if (wire.unit() == v1::LENGTH_UNIT_UNSPECIFIED) {
      problems_.Add(path.substr(0, path.rfind('.')) + ".unit", "is missing: a surface file does not say its unit",
                    "mm, cm or m");
    }
    const auto bytes = ReadFile(wire.surface(), path, sources_.assets, problems_);
    if (!bytes || wire.surface().path().empty()) return {};
    Problems own;
    std::vector<std::string> found;
    auto surface = ReadSurface(wire.surface().path(), *bytes, own, sources_.stop, &found);
    for (const std::string& note : found) notes_.push_back(path + ": " + note);
    if (surface) Close(path, *surface, own);
    problems_.Append(path, own);
    if (!surface || !own.empty()) return {};
    for (Vec3& x : surface->nodes) x *= metres;
    return std::move(*surface);
  }

  void Close(const std::string& path, TriangleMesh& surface, Problems& problems) {
    triangles_ += static_cast<std::int64_t>(surface.triangles.size());
    if (triangles_ > kMostObstacleTriangles) {
      problems.Add("",
                   std::to_string(triangles_) + " triangles of rigid bodies are too many; at most " +
                       std::to_string(kMostObstacleTriangles),
                   "use a coarser surface");
      return;
    }
    const SurfaceReport report =
        RepairSurface(surface, kLargestHole * Diagonal(surface.nodes), problems, sources_.stop);
    for (const SurfacePlace& hole : report.holes) {
      notes_.push_back(path + ": a hole was closed at " + PlaceText(hole));
    }
    if (!report.cuts.empty()) {
      notes_.push_back(path + ": the surface intersects itself at " + PlaceText(report.cuts.front()) +
                       "; contact is not reliable there");
    }
  }

  FreeRigidMotion FreeOf(const v1::FreeMotion& wire) {
    FreeRigidMotion free;
    if (wire.inertia_case() == v1::FreeMotion::kMass) free.mass = wire.mass();
    if (wire.inertia_case() == v1::FreeMotion::kDensity) free.density = wire.density();
    free.velocity = ToVec3(wire.velocity());
    free.spin = ToVec3(wire.spin());
    return free;
  }

  const RigidBodySources& sources_;
  const Names& bodies_;
  std::vector<std::string>& notes_;
  Problems& problems_;
  std::int64_t triangles_ = 0;  // so far
};

}  // namespace

std::vector<RigidBody> TranslateRigidBodies(const v1::Scene& scene, const RigidBodySources& sources,
                                            const Names& bodies, std::vector<std::string>& notes, Problems& problems) {
  std::vector<RigidBody> result;
  Names names("rigid body");
  RigidBodyReader reader(sources, bodies, notes, problems);
  for (int i = 0; i < scene.rigid_bodies_size(); ++i) {
    const std::string path = IndexPath("rigid_bodies", static_cast<std::size_t>(i));
    names.Add(scene.rigid_bodies(i).name(), JoinPath(path, "name"), problems);
    result.push_back(reader.Read(scene.rigid_bodies(i), path));
  }
  return result;
}

}  // namespace fascicle::server
