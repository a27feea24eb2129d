#include "server/translate/built_in_shapes.h"

#include <Eigen/Geometry>

#include "core/geometry/shapes.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

// Each hexahedron becomes six tetrahedra.
std::int64_t Tetrahedra(std::int64_t nx, std::int64_t ny, std::int64_t nz) { return 6 * nx * ny * nz; }

void CheckEven(int divisions, std::string path, Problems& problems) {
  if (divisions % 2 != 0) problems.Add(std::move(path), "is " + std::to_string(divisions), "an even number");
}

std::int64_t CheckFusiform(const v1::FusiformShape& shape, const std::string& path, Problems& problems) {
  CheckEven(shape.divisions_across(), JoinPath(path, "divisions_across"), problems);
  if (shape.end_radius() > shape.belly_radius()) {
    problems.Add(JoinPath(path, "end_radius"),
                 "is " + Text(shape.end_radius()) + ", larger than the belly's radius " + Text(shape.belly_radius()),
                 "a spindle is widest in the middle");
  }
  (void)ToDirection(shape.direction(), JoinPath(path, "direction"), problems);
  return Tetrahedra(shape.divisions_across(), shape.divisions_across(), shape.divisions_along());
}

// Moves a spindle along z to its place.
void Place(const v1::FusiformShape& shape, double metres, TetMesh& mesh) {
  const Vec3 position = ToVec3(shape.position()) * metres, along = ToVec3(shape.direction()).normalized();
  if (position.isZero(0) && along == Vec3::UnitZ()) return;
  const Mat3 R = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), along).toRotationMatrix();
  for (Vec3& x : mesh.nodes) x = position + R * x;
}

std::int64_t CheckTorus(const v1::TorusShape& shape, const std::string& path, Problems& problems) {
  CheckEven(shape.divisions_across(), JoinPath(path, "divisions_across"), problems);
  if (shape.minor_radius() >= shape.major_radius()) {
    problems.Add(JoinPath(path, "minor_radius"),
                 "is " + Text(shape.minor_radius()) + ", not less than the major radius " + Text(shape.major_radius()),
                 "the tube would intersect itself");
  }
  return Tetrahedra(shape.divisions_across(), shape.divisions_across(), shape.divisions_around());
}

std::int64_t CheckSphere(const v1::SphereShape& shape, const std::string& path, Problems& problems) {
  CheckEven(shape.divisions(), JoinPath(path, "divisions"), problems);
  return Tetrahedra(shape.divisions(), shape.divisions(), shape.divisions());
}

std::int64_t CheckBox(const v1::BoxShape& shape) {
  return shape.divisions_size() == 3 ? Tetrahedra(shape.divisions(0), shape.divisions(1), shape.divisions(2)) : 0;
}

}  // namespace

std::optional<ShapeSize> CheckShape(const v1::Mesh& mesh, const std::string& path, Problems& problems) {
  Problems own;
  ShapeSize size;
  switch (mesh.source_case()) {
    case v1::Mesh::kBox:
      size = {JoinPath(path, "box"), CheckBox(mesh.box())};
      break;
    case v1::Mesh::kFusiform:
      size.path = JoinPath(path, "fusiform");
      size.tetrahedra = CheckFusiform(mesh.fusiform(), size.path, own);
      break;
    case v1::Mesh::kTorus:
      size.path = JoinPath(path, "torus");
      size.tetrahedra = CheckTorus(mesh.torus(), size.path, own);
      break;
    case v1::Mesh::kSphere:
      size.path = JoinPath(path, "sphere");
      size.tetrahedra = CheckSphere(mesh.sphere(), size.path, own);
      break;
    case v1::Mesh::kFile:
    case v1::Mesh::kImage:
    case v1::Mesh::kSurface:
    case v1::Mesh::SOURCE_NOT_SET:
      return std::nullopt;
  }
  problems.Append("", own);
  if (!own.empty() || !ObeysRules(mesh)) return std::nullopt;
  return size;
}

TetMesh MakeShape(const v1::Mesh& mesh, double metres, Cells cells) {
  switch (mesh.source_case()) {
    case v1::Mesh::kFusiform: {
      const v1::FusiformShape& shape = mesh.fusiform();
      TetMesh mesh_along_z =
          MakeFusiform({shape.length() * metres, shape.belly_radius() * metres, shape.end_radius() * metres,
                        shape.divisions_across(), shape.divisions_along()},
                       cells);
      Place(shape, metres, mesh_along_z);
      return mesh_along_z;
    }
    case v1::Mesh::kTorus: {
      const v1::TorusShape& shape = mesh.torus();
      return MakeTorus({shape.major_radius() * metres, shape.minor_radius() * metres, shape.divisions_around(),
                        shape.divisions_across()},
                       cells);
    }
    case v1::Mesh::kSphere:
      return MakeSphere(mesh.sphere().radius() * metres, mesh.sphere().divisions(), cells);
    case v1::Mesh::kBox: {
      const v1::BoxShape& shape = mesh.box();
      return MakeBox(ToVec3(shape.origin()) * metres, ToVec3(shape.size()) * metres,
                     {shape.divisions(0), shape.divisions(1), shape.divisions(2)}, cells);
    }
    case v1::Mesh::kFile:
    case v1::Mesh::kImage:
    case v1::Mesh::kSurface:
    case v1::Mesh::SOURCE_NOT_SET:
      break;
  }
  return {};
}

}  // namespace fascicle::server
