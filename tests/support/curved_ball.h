#ifndef FASCICLE_TESTS_SUPPORT_CURVED_BALL_H_
#define FASCICLE_TESTS_SUPPORT_CURVED_BALL_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/mesh_edges.h"
#include "core/geometry/shapes.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::testing {

// A ball of quadratic tetrahedra around the origin as a server sends it: the mid-edge nodes of its surface are on the
// sphere. Frame k is stretched to 1 + 0.1 k along x; its velocity field is the square of x at every node.
class CurvedBall {
 public:
  static constexpr double kRadius = 0.02;  // [m]

  explicit CurvedBall(int divisions = 4) : mesh_(MakeSphere(kRadius, divisions)), edges_(NumberEdges(mesh_)) {
    middles_ = EdgeMiddles(mesh_, edges_);
    for (const Triangle& t : BoundaryTriangles(mesh_)) {
      for (int c = 0; c < 3; ++c) {
        Vec3& middle = middles_[static_cast<std::size_t>(edges_.Between(t[c], t[(c + 1) % 3]))];
        middle *= kRadius / middle.norm();
      }
    }
  }

  const TetMesh& mesh() const { return mesh_; }
  const MeshEdges& edges() const { return edges_; }
  std::size_t nodes() const { return mesh_.nodes.size() + middles_.size(); }

  v1::Geometry geometry() const {
    v1::Geometry geometry;
    v1::BodyGeometry& body = *geometry.add_bodies();
    body.set_name("ball");
    body.set_positions(Pack(mesh_.nodes));
    body.set_tetrahedra(Pack(mesh_.tetrahedra));
    body.set_fibres(Pack(std::vector<Vec3>(mesh_.tetrahedra.size(), Vec3::UnitX())));
    body.set_higher_order_positions(Pack(middles_));
    std::vector<std::array<std::int32_t, 6>> nodes = edges_.of_tetrahedra;
    for (auto& of_tetrahedron : nodes) {
      for (std::int32_t& n : of_tetrahedron) n += static_cast<std::int32_t>(mesh_.nodes.size());
    }
    body.set_higher_order_nodes(Pack(nodes));
    v1::RegionGeometry& region = *body.add_regions();
    region.set_name("surface");
    std::vector<std::int32_t> on_surface, between;
    for (std::size_t n = 0; n < mesh_.nodes.size(); ++n) {
      if (mesh_.nodes[n].norm() > 0.999 * kRadius) on_surface.push_back(static_cast<std::int32_t>(n));
    }
    const std::vector<bool> within = EdgesWithin(mesh_, edges_, BoundaryTriangles(mesh_), on_surface);
    for (std::size_t e = 0; e < within.size(); ++e) {
      if (within[e]) between.push_back(static_cast<std::int32_t>(mesh_.nodes.size() + e));
    }
    region.set_nodes(Pack(on_surface));
    region.set_higher_order_nodes(Pack(between));
    return geometry;
  }

  v1::Frame frame(int index) const {
    v1::Frame frame;
    frame.set_index(index);
    v1::BodyFrame& body = *frame.add_bodies();
    body.set_positions(Pack(Stretched(mesh_.nodes, index)));
    body.set_higher_order_positions(Pack(Stretched(middles_, index)));
    v1::FieldValues& velocity = *body.add_fields();
    velocity.set_name("velocity");
    velocity.set_location(v1::FieldValues::LOCATION_NODE);
    velocity.set_components(3);
    velocity.set_unit("m/s");
    std::vector<Vec3> values = Squares(mesh_.nodes);
    velocity.set_values(Pack(values));
    const std::vector<Vec3> more = Squares(middles_);
    values.insert(values.end(), more.begin(), more.end());
    velocity.set_all_values(Pack(values));
    return frame;
  }

  // What an older server would have sent: corner nodes only.
  static v1::Geometry WithoutMidEdgeNodes(v1::Geometry geometry) {
    for (v1::BodyGeometry& body : *geometry.mutable_bodies()) {
      body.clear_higher_order_positions();
      body.clear_higher_order_nodes();
      for (v1::RegionGeometry& region : *body.mutable_regions()) region.clear_higher_order_nodes();
    }
    return geometry;
  }
  static v1::Frame WithoutMidEdgeNodes(v1::Frame frame) {
    for (v1::BodyFrame& body : *frame.mutable_bodies()) {
      body.clear_higher_order_positions();
      for (v1::FieldValues& field : *body.mutable_fields()) field.clear_all_values();
    }
    return frame;
  }

 private:
  template <class T>
  static std::string Pack(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
  }
  static std::vector<Vec3> Stretched(std::vector<Vec3> points, int index) {
    for (Vec3& x : points) x[0] *= 1 + 0.1 * index;
    return points;
  }
  static std::vector<Vec3> Squares(std::vector<Vec3> points) {
    for (Vec3& x : points) x = Vec3(x[0] * x[0], 0, 0);
    return points;
  }

  TetMesh mesh_;
  MeshEdges edges_;
  std::vector<Vec3> middles_;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_CURVED_BALL_H_
