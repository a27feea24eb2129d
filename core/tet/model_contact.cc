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
// Parts of an edge of a linear or bilinear face, and of others, between bodies.
constexpr int kLinearParts = 4, kQuadraticParts = 2;

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
    point.nodes = face.nodes;
    point.weights = FaceWeights(ElementOrder::kQuadratic, 1. / 3, 1. / 3);
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

// Points of a face with their shares of its area: of the rule for its nodes, applied to equal parts of the face.
class Lattice {
 public:
  explicit Lattice(ElementOrder order) : parts_(IsQuadratic(order) ? kQuadraticParts : kLinearParts) {
    for (int i = 0; i < parts_; ++i) {
      for (int j = 0; j < parts_; ++j) {
        const int u = kSteps * i, v = kSteps * j;
        if (IsHexahedral(order)) {
          AddSquare(u, v, IsQuadratic(order));
        } else if (i + j < parts_) {
          AddTriangle(u, v, kSteps, IsQuadratic(order));
          if (i + j + 1 < parts_) AddTriangle(u + kSteps, v + kSteps, -kSteps, IsQuadratic(order));
        }
      }
    }
    double sum = 0;
    for (const auto& [place, share] : shares_) sum += share;
    for (auto& [place, share] : shares_) share /= sum;
  }

  // Calls visit(u, v, share).
  template <class Visit>
  void ForPoints(const Visit& visit) const {
    const double scale = 1.0 / (kSteps * parts_);
    for (const auto& [place, share] : shares_) visit(scale * place.first, scale * place.second, share);
  }

 private:
  static constexpr int kSteps = 6;  // of a part
  static bool IsQuadratic(ElementOrder order) {
    return order == ElementOrder::kQuadratic || order == ElementOrder::kHexahedralQuadratic;
  }

  void AddTriangle(int u, int v, int edge, bool quadratic) {
    const int half = edge / 2, third = edge / 3;
    const double corner = quadratic ? 1. / 20 : 1. / 3;
    for (const auto& [a, b] : {std::pair(0, 0), std::pair(edge, 0), std::pair(0, edge)})
      shares_[{u + a, v + b}] += corner;
    if (!quadratic) return;
    for (const auto& [a, b] : {std::pair(half, 0), std::pair(half, half), std::pair(0, half)}) {
      shares_[{u + a, v + b}] += 2. / 15;
    }
    shares_[{u + third, v + third}] += 9. / 20;
  }

  void AddSquare(int u, int v, bool quadratic) {
    const int count = quadratic ? 3 : 2, step = kSteps / (count - 1);
    const auto weight = [&](int k) { return k == 1 && quadratic ? 4. / 6 : quadratic ? 1. / 6 : 1. / 2; };
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b < count; ++b) shares_[{u + step * a, v + step * b}] += weight(a) * weight(b);
    }
  }

  int parts_;
  std::map<std::pair<int, int>, double> shares_;
};

// Facets of a face by its nodes.
std::vector<Triangle> FacetsOf(ElementOrder order) {
  switch (order) {
    case ElementOrder::kLinear:
      return {{0, 1, 2}};
    case ElementOrder::kQuadratic:
      return {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
    case ElementOrder::kHexahedral:
      return {{0, 1, 2}, {0, 2, 3}};
    case ElementOrder::kHexahedralQuadratic:
      break;
  }
  return {{0, 4, 8}, {4, 1, 8}, {1, 5, 8}, {5, 2, 8}, {2, 6, 8}, {6, 3, 8}, {3, 7, 8}, {7, 0, 8}};
}

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

TouchingSurface TetModelBuilder::SurfaceOfBody(std::int32_t index) {
  const TetBody& body = model_.bodies_[static_cast<std::size_t>(index)];
  const double modulus = ContactModulus(*body.source, scene_.tet.stepping);
  const Lattice lattice(model_.order());
  TouchingSurface surface;
  surface.body = index;
  surface.faces = BoundaryFaces(body);
  double area = 0, stiffness = 0;
  for (const PressureFace& face : surface.faces) {
    HeedStop();
    const FaceSize size = SizeOf(model_.order(), face, model_.rest_positions_);
    const double per_area = 2 * modulus / size.edge;
    const auto count = static_cast<int>(size.shares.size());
    surface.nodes.insert(surface.nodes.end(), face.nodes.begin(), face.nodes.begin() + count);
    lattice.ForPoints([&](double u, double v, double share) {
      SurfacePoint point;
      point.nodes = face.nodes;
      point.count = count;
      point.weights = FaceWeights(model_.order(), u, v);
      point.stiffness = per_area * share * size.area;
      point.allowed_depth = kTenthOfEdge * size.shortest;
      point.first_side = static_cast<std::int32_t>(model_.contact_.sides.size());
      point.sides = 1;
      model_.contact_.sides.push_back(SideOf(model_.order(), face, point.stiffness));
      surface.points.push_back(point);
    });
    area += size.area;
    stiffness += per_area * size.area;
    surface.edge += size.edge / static_cast<double>(surface.faces.size());
  }
  surface.per_area = stiffness / area;
  std::sort(surface.nodes.begin(), surface.nodes.end());
  surface.nodes.erase(std::unique(surface.nodes.begin(), surface.nodes.end()), surface.nodes.end());
  const auto place = [&](std::int32_t n) {
    return static_cast<std::int32_t>(std::lower_bound(surface.nodes.begin(), surface.nodes.end(), n) -
                                     surface.nodes.begin());
  };
  const std::vector<Triangle> facets = FacetsOf(model_.order());
  surface.facets_per_face = static_cast<std::int32_t>(facets.size());
  for (const PressureFace& face : surface.faces) {
    for (const auto& [a, b, c] : facets) {
      surface.facets.push_back({place(face.nodes[a]), place(face.nodes[b]), place(face.nodes[c])});
    }
  }
  return surface;
}

void TetModelBuilder::AddContact() {
  ContactModel& contact = model_.contact_;
  if (!scene_.rigid_bodies.empty()) {
    for (const TetBody& body : model_.bodies_) AddSurfacePoints(body);
    for (const RigidBody& rigid : scene_.rigid_bodies) contact.rigid.emplace_back(rigid.shape);
  }
  std::map<std::int32_t, std::int32_t> surface_of_body;
  const auto surface = [&](std::int32_t body) {
    const auto [place, is_new] = surface_of_body.try_emplace(body, static_cast<std::int32_t>(contact.surfaces.size()));
    if (is_new) contact.surfaces.push_back(SurfaceOfBody(body));
    return place->second;
  };
  for (const TouchingPair& pair : PairsOf(scene_.contacts, scene_.bodies.size())) {
    const std::int32_t a = surface(static_cast<std::int32_t>(pair.a)), b = surface(static_cast<std::int32_t>(pair.b));
    const double of_a = contact.surfaces[a].per_area, of_b = contact.surfaces[b].per_area;
    contact.passes.push_back({a, b, 0.5 * std::min(1.0, of_b / of_a)});
    contact.passes.push_back({b, a, 0.5 * std::min(1.0, of_a / of_b)});
  }
}

}  // namespace fascicle
