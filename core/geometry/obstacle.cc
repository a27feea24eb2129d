#include "core/geometry/obstacle.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/geometry/shapes.h"
#include "core/geometry/unused_nodes.h"

namespace fascicle {
namespace {

// Divisions of round shapes in pictures.
constexpr int kAround = 48, kAcross = 16;

Mat3 Projector(const Vec3& unit) { return unit * unit.transpose(); }

SignedDistance DistanceAt(const HalfSpace&, const Vec3& X) { return {X[2], Vec3::UnitZ(), Mat3::Zero()}; }

SignedDistance DistanceAt(const Ball& ball, const Vec3& X) {
  const double r = X.norm();
  if (!(r > 0)) return {-ball.radius, Vec3::UnitZ(), Mat3::Zero()};
  const Vec3 n = X / r;
  return {r - ball.radius, n, (Mat3::Identity() - Projector(n)) / r};
}

SignedDistance DistanceAt(const Cuboid& box, const Vec3& X) {
  const Vec3 beyond = X.cwiseAbs() - box.size / 2;
  const auto sign = [&](int c) { return X[c] < 0 ? -1.0 : 1.0; };
  SignedDistance at;
  if ((beyond.array() <= 0).all()) {
    int axis = 0;
    at.distance = beyond.maxCoeff(&axis);
    at.normal = sign(axis) * Vec3::Unit(axis);
    return at;
  }
  Mat3 outside = Mat3::Zero();
  Vec3 d = Vec3::Zero();
  for (int c = 0; c < 3; ++c) {
    if (!(beyond[c] > 0)) continue;
    d[c] = sign(c) * beyond[c];
    outside(c, c) = 1;
  }
  at.distance = d.norm();
  at.normal = d / at.distance;
  at.curvature = (outside - Projector(at.normal)) / at.distance;
  return at;
}

SignedDistance DistanceAt(const Cylinder& cylinder, const Vec3& X) {
  const double rho = std::hypot(X[0], X[1]);
  const Vec3 out = rho > 0 ? Vec3(X[0] / rho, X[1] / rho, 0) : Vec3(Vec3::UnitX());
  const Vec3 around(-out[1], out[0], 0);
  const Vec3 along = (X[2] < 0 ? -1.0 : 1.0) * Vec3::UnitZ();
  const double beyond_side = rho - cylinder.radius, beyond_end = std::abs(X[2]) - cylinder.length / 2;
  const double turn = rho > 0 ? 1 / rho : 0;
  if (beyond_side > 0 && beyond_end > 0) {
    const double d = std::hypot(beyond_side, beyond_end);
    const Vec3 n = (beyond_side * out + beyond_end * along) / d;
    const Vec3 across = (beyond_end * out - beyond_side * along) / d;
    return {d, n, Projector(across) / d + beyond_side / d * turn * Projector(around)};
  }
  if (beyond_side > beyond_end) return {beyond_side, out, turn * Projector(around)};
  return {beyond_end, along, Mat3::Zero()};
}

// Corners with the faces of a closed surface around a circle.
TriangleMesh SurfaceOfCylinder(const Cylinder& cylinder) {
  TriangleMesh mesh;
  const double half = cylinder.length / 2;
  for (int k = 0; k < kAround; ++k) {
    const double angle = 2 * std::numbers::pi * k / kAround;
    for (const double z : {-half, half}) {
      mesh.nodes.emplace_back(cylinder.radius * std::cos(angle), cylinder.radius * std::sin(angle), z);
    }
  }
  mesh.nodes.emplace_back(0, 0, -half);
  mesh.nodes.emplace_back(0, 0, half);
  for (int k = 0; k < kAround; ++k) {
    const int low = 2 * k, high = low + 1, next_low = 2 * ((k + 1) % kAround), next_high = next_low + 1;
    mesh.triangles.push_back({low, next_low, next_high});
    mesh.triangles.push_back({low, next_high, high});
    mesh.triangles.push_back({2 * kAround, next_low, low});
    mesh.triangles.push_back({2 * kAround + 1, high, next_high});
  }
  return mesh;
}

TriangleMesh BoundaryOfMesh(const TetMesh& mesh) {
  TriangleMesh surface = {mesh.nodes, BoundaryTriangles(mesh)};
  DropUnusedNodes(surface.nodes, surface.triangles);
  return surface;
}

}  // namespace

ObstacleDistance::ObstacleDistance(const ObstacleShape& shape) : shape_(shape) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) surface_ = std::make_unique<SurfaceDistance>(*mesh);
}

SignedDistance ObstacleDistance::At(const Vec3& point) const {
  if (surface_ != nullptr) return *surface_->At(point);
  return std::visit(
      [&]<class Shape>(const Shape& shape) {
        if constexpr (std::is_same_v<Shape, TriangleMesh>) {
          return SignedDistance();
        } else {
          return DistanceAt(shape, point);
        }
      },
      shape_);
}

TriangleMesh SurfaceOf(const ObstacleShape& shape, double side_of_plane) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return *mesh;
  if (const auto* ball = std::get_if<Ball>(&shape)) return BoundaryOfMesh(MakeSphere(ball->radius, kAcross));
  if (const auto* box = std::get_if<Cuboid>(&shape))
    return BoundaryOfMesh(MakeBox(-box->size / 2, box->size, {1, 1, 1}));
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return SurfaceOfCylinder(*cylinder);
  const double a = side_of_plane / 2;
  return {{Vec3(-a, -a, 0), Vec3(a, -a, 0), Vec3(a, a, 0), Vec3(-a, a, 0)}, {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace fascicle
