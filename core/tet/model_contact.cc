// The points and faces of bodies' surfaces that may touch something.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/tet/face_shapes.h"
#include "core/tet/model_builder.h"

namespace fascicle {
namespace {

constexpr double kTenthOfEdge = 0.1;
// Of steppings that solve for the positions: times this the stiffness of a layer of elements.
constexpr double kFirmness = 10;
// Largest bulk modulus that counts there, relative to the shear modulus: that of Poisson's ratio 0.4.
constexpr double kMostBulk = 14. / 3;

double ContactModulus(const Material& material, bool is_explicit) {
  return std::visit(
      [&](const auto& law) {
        const double mu = law.ShearModulus(), bulk = law.BulkModulus();
        return is_explicit ? bulk + 4 * mu / 3 : kFirmness * (std::min(bulk, kMostBulk * mu) + 4 * mu / 3);
      },
      material);
}

// That of the stiffest law of a body.
double ContactModulus(const Body& body, Stepping stepping) {
  const bool is_explicit = stepping == Stepping::kExplicit || stepping == Stepping::kMixed;
  double modulus = ContactModulus(body.material, is_explicit);
  for (const Material& material : body.tet().materials.more) {
    modulus = std::max(modulus, ContactModulus(material, is_explicit));
  }
  return modulus;
}

int CornersOf(ElementOrder order) { return IsHexahedral(order) ? 4 : 3; }

struct FaceSize {
  double area = 0, edge = 0, shortest = INFINITY;  // `edge`: of a right triangle or square with this area
  std::vector<double> shares;                      // of the area, for each node
};

FaceSize SizeOf(ElementOrder order, const PressureFace& face, const NodalVector& X) {
  FaceSize size;
  size.shares = SharesOf(order, face, X);
  size.area = std::accumulate(size.shares.begin(), size.shares.end(), 0.0);
  const int corners = CornersOf(order);
  size.edge = std::sqrt(corners == 3 ? 2 * size.area : size.area);
  for (int c = 0; c < corners; ++c) {
    const double edge = (X[face.nodes[(c + 1) % corners]] - X[face.nodes[c]]).norm();
    if (edge > 0) size.shortest = std::min(size.shortest, edge);  // sides of wedges have repeated corners
  }
  return size;
}

SurfaceSide SideOf(ElementOrder order, const PressureFace& face, double stiffness) {
  const std::int32_t last = face.nodes[IsHexahedral(order) ? 3 : 2];
  return {{face.nodes[0], face.nodes[1], face.nodes[2], last}, stiffness};
}

// Adds up the points of faces; those at nodes are shared between faces.
class PointCollector {
 public:
  explicit PointCollector(ElementOrder order) : order_(order) {}

  void AddNode(std::int32_t node, const PressureFace& face, double stiffness, double allowed_depth) {
    const auto [place, is_new] = of_node_.try_emplace(node, points_.size());
    if (is_new) {
      points_.push_back({{node}, {1}, 1, 0, 0, 0, allowed_depth});
      sides_.emplace_back();
    }
    SurfacePoint& point = points_[place->second];
    point.stiffness += stiffness;
    point.allowed_depth = std::min(point.allowed_depth, allowed_depth);
    sides_[place->second].push_back(SideOf(order_, face, stiffness));
  }

  // The centroid of a quadratic triangle.
  void AddCentroid(const PressureFace& face, double stiffness, double allowed_depth) {
    SurfacePoint& point = points_.emplace_back();
    const auto weights = QuadraticFace(1. / 3, 1. / 3).N;
    std::copy(weights.begin(), weights.end(), point.weights.begin());
    point.nodes = face.nodes;
    point.count = 6;
    point.stiffness = stiffness;
    point.allowed_depth = allowed_depth;
    sides_.push_back({SideOf(order_, face, stiffness)});
  }

  // Appends the points for which keep(point).
  template <class Keep>
  void Put(const Keep& keep, ContactModel& contact) const {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!keep(points_[i])) continue;
      SurfacePoint& point = contact.points.emplace_back(points_[i]);
      point.first_side = static_cast<std::int32_t>(contact.sides.size());
      point.sides = static_cast<std::int32_t>(sides_[i].size());
      contact.sides.insert(contact.sides.end(), sides_[i].begin(), sides_[i].end());
    }
  }

 private:
  ElementOrder order_;
  std::vector<SurfacePoint> points_;
  std::vector<std::vector<SurfaceSide>> sides_;  // of each point
  std::map<std::int32_t, std::size_t> of_node_;
};

}  // namespace

std::vector<PressureFace> TetModelBuilder::BoundaryFaces(const TetBody& body) const {
  const TetMesh& mesh = body.source->tet().mesh;
  Region all;
  if (IsHexahedral(model_.order())) {
    all.sides = BoundaryOfHexahedra(mesh, stop_).quads;
  } else {
    all.triangles = BoundaryTriangles(mesh, stop_);
  }
  return FacesOf(all, body);
}

bool TetModelBuilder::IsHeld(const SurfacePoint& point) const {
  return std::all_of(point.nodes.begin(), point.nodes.begin() + point.count,
                     [&](std::int32_t n) { return model_.inverse_mass_[n] == Vec3::Zero(); });
}

void TetModelBuilder::AddSurfacePoints(const TetBody& body) {
  const double modulus = ContactModulus(*body.source, scene_.tet.stepping);
  PointCollector collector(model_.order());
  for (const PressureFace& face : BoundaryFaces(body)) {
    HeedStop();
    const FaceSize size = SizeOf(model_.order(), face, model_.rest_positions_);
    const double per_area = 2 * modulus / size.edge, allowed = kTenthOfEdge * size.shortest;
    if (model_.order() != ElementOrder::kQuadratic) {
      for (std::size_t a = 0; a < size.shares.size(); ++a) {
        collector.AddNode(face.nodes[a], face, per_area * size.shares[a], allowed);
      }
      continue;
    }
    for (std::size_t a = 0; a < 6; ++a) {
      collector.AddNode(face.nodes[a], face, per_area * size.area * (a < 3 ? 1. / 20 : 2. / 15), allowed);
    }
    collector.AddCentroid(face, per_area * size.area * 9. / 20, allowed);
  }
  // What supports hold altogether cannot be pushed out.
  collector.Put([&](const SurfacePoint& point) { return !IsHeld(point); }, model_.contact_);
  model_.contact_.point_begin.push_back(model_.contact_.points.size());
}

void TetModelBuilder::AddContact() {
  if (scene_.rigid_bodies.empty()) return;
  for (const TetBody& body : model_.bodies_) AddSurfacePoints(body);
  for (const RigidBody& rigid : scene_.rigid_bodies) model_.contact_.rigid.emplace_back(rigid.shape);
}

}  // namespace fascicle
