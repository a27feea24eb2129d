#include "core/tet/position_loads.h"

#include <Eigen/Geometry>

#include "core/tet/face_shapes.h"
#include "core/tet/model.h"

namespace fascicle {
namespace {

// Shape functions and their derivatives at a point of a reference triangle with area 1/2, or of the unit square, and
// the point's weight.
template <int kNodes>
struct FacePoint {
  double weight;
  std::array<double, kNodes> N, d1, d2;
};

template <int kNodes>
FacePoint<kNodes> PointOf(double weight, const FaceShape<kNodes>& shape) {
  return {weight, shape.N, shape.d1, shape.d2};
}

// The centroid, exact for linear faces: their area vector is constant.
std::array<FacePoint<3>, 1> LinearFacePoints() { return {{{0.5, {1. / 3, 1. / 3, 1. / 3}, {-1, 1, 0}, {-1, 0, 1}}}}; }

// Six points, exact for polynomials of degree 4 [Dunavant 1985], which N_a (x,1 x x,2) is.
std::array<FacePoint<6>, 6> QuadraticFacePoints() {
  constexpr double kA = 0.44594849091596488632, kWeightA = 0.22338158967801146570 / 2;
  constexpr double kB = 0.09157621350977074346, kWeightB = 0.10995174365532186764 / 2;
  return {PointOf(kWeightA, QuadraticFace(kA, kA)),         PointOf(kWeightA, QuadraticFace(1 - 2 * kA, kA)),
          PointOf(kWeightA, QuadraticFace(kA, 1 - 2 * kA)), PointOf(kWeightB, QuadraticFace(kB, kB)),
          PointOf(kWeightB, QuadraticFace(1 - 2 * kB, kB)), PointOf(kWeightB, QuadraticFace(kB, 1 - 2 * kB))};
}

// 2 x 2 Gauss points, exact for N_a (x,1 x x,2) of a bilinear side.
std::array<FacePoint<4>, 4> BilinearFacePoints() {
  constexpr double kNear = 0.21132486540518711775;  // (1 - 1/sqrt(3)) / 2
  const auto point = [](double u, double v) { return PointOf(0.25, BilinearFace(u, v)); };
  return {point(kNear, kNear), point(1 - kNear, kNear), point(1 - kNear, 1 - kNear), point(kNear, 1 - kNear)};
}

// 3 x 3 Gauss points, exact for N_a (x,1 x x,2) of a biquadratic side.
std::array<FacePoint<9>, 9> BiquadraticFacePoints() {
  using Shape = HexahedralQuadraticShape;
  std::array<FacePoint<9>, 9> points;
  for (int q = 0; q < 9; ++q) {
    points[q] = PointOf(Shape::LineWeight(q % 3) * Shape::LineWeight(q / 3),
                        BiquadraticFace(Shape::Place(q, 0), Shape::Place(q, 1)));
  }
  return points;
}

// Calls visit(points of a face) for faces of the given order.
template <class Visit>
void WithFacePoints(ElementOrder order, const Visit& visit) {
  static const auto linear = LinearFacePoints();
  static const auto quadratic = QuadraticFacePoints();
  static const auto bilinear = BilinearFacePoints();
  static const auto biquadratic = BiquadraticFacePoints();
  switch (order) {
    case ElementOrder::kLinear:
      return visit(linear);
    case ElementOrder::kQuadratic:
      return visit(quadratic);
    case ElementOrder::kHexahedral:
      return visit(bilinear);
    case ElementOrder::kHexahedralQuadratic:
      return visit(biquadratic);
  }
}

template <int kNodes>
Vec3 TangentOf(const std::array<double, kNodes>& derivatives, const PressureFace& face, const NodalVector& x) {
  Vec3 tangent = Vec3::Zero();
  for (int a = 0; a < kNodes; ++a) tangent += derivatives[a] * x[face.nodes[a]];
  return tangent;
}

template <int kNodes>
void AddPressureForce(double pressure, const PressureFace& face, const FacePoint<kNodes>& point, const NodalVector& x,
                      NodalVector& force) {
  const Vec3 t1 = TangentOf<kNodes>(point.d1, face, x), t2 = TangentOf<kNodes>(point.d2, face, x);
  const Vec3 push = -pressure * point.weight * t1.cross(t2);
  for (int a = 0; a < kNodes; ++a) force[face.nodes[a]] += point.N[a] * push;
}

// The matrix of v -> a x v.
Mat3 CrossMatrix(const Vec3& a) {
  Mat3 matrix;
  matrix << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return matrix;
}

// Half of -df_a/dx_b and, at (b, a), half of its transpose: together with those of (b, a), the symmetric part.
template <int kNodes>
void AddPressureStiffness(double pressure, const PressureFace& face, const FacePoint<kNodes>& point,
                          const NodalVector& x, std::vector<LoadExpansion::Entry>& entries) {
  const Mat3 t1 = CrossMatrix(TangentOf<kNodes>(point.d1, face, x));
  const Mat3 t2 = CrossMatrix(TangentOf<kNodes>(point.d2, face, x));
  for (int a = 0; a < kNodes; ++a) {
    for (int b = 0; b < kNodes; ++b) {
      const Mat3 half = 0.5 * pressure * point.weight * point.N[a] * (point.d2[b] * t1 - point.d1[b] * t2);
      entries.push_back({face.nodes[a], face.nodes[b], half});
      entries.push_back({face.nodes[b], face.nodes[a], half.transpose()});
    }
  }
}

// The integral of N_a N_b over a linear face is not that of its one point: A/12, and A/6 for a = b.
double Shared(const FacePoint<3>&, int a, int b) { return (a == b ? 2 : 1) / 24.0; }
template <int kNodes>
double Shared(const FacePoint<kNodes>& point, int a, int b) {
  return point.weight * point.N[a] * point.N[b];
}

template <int kNodes>
void AddSprings(const PressureFace& face, const FacePoint<kNodes>& point, const NodalVector& X, const Vec3& stiffness,
                double& area, std::vector<SpringEntry>& entries) {
  const double twice_area = TangentOf<kNodes>(point.d1, face, X).cross(TangentOf<kNodes>(point.d2, face, X)).norm();
  area += point.weight * twice_area;
  for (int a = 0; a < kNodes; ++a) {
    for (int b = 0; b < kNodes; ++b) {
      entries.push_back({face.nodes[a], face.nodes[b], Shared(point, a, b) * twice_area * stiffness});
    }
  }
}

Vec3 PositionOf(const MeanPosition& mean, const NodalVector& x) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < mean.nodes.size(); ++i) sum += mean.weights[i] * x[mean.nodes[i]];
  return sum;
}

// A line spring at positions x.
struct Stretched {
  Stretched(const LineSpringLoad& load, double scale, const NodalVector& x) {
    const Vec3 line = PositionOf(load.ends[1], x) - PositionOf(load.ends[0], x);
    length = line.norm();
    direction = line / length;
    const bool is_slack = load.tension_only && length < load.rest_length;
    slope = is_slack ? 0 : scale * load.stiffness;
    tension = slope * (length - load.rest_length);
  }
  // The derivative of the tension vector with respect to the line.
  Mat3 Stiffness() const {
    const Mat3 along = direction * direction.transpose();
    return slope * along + tension / length * (Mat3::Identity() - along);
  }

  Vec3 direction;  // from the first end to the second
  double length = 0, tension = 0, slope = 0;
};

void AddLineSpringForce(const LineSpringLoad& load, double scale, const NodalVector& x, NodalVector& force) {
  const Stretched spring(load, scale, x);
  for (const int end : {0, 1}) {
    const Vec3 pull = (end == 0 ? spring.tension : -spring.tension) * spring.direction;
    for (std::size_t i = 0; i < load.ends[end].nodes.size(); ++i) {
      force[load.ends[end].nodes[i]] += load.ends[end].weights[i] * pull;
    }
  }
}

// Calls visit(node, signed weight) for the nodes of both ends.
template <class Visit>
void ForEnds(const LineSpringLoad& load, const Visit& visit) {
  for (const int end : {0, 1}) {
    for (std::size_t i = 0; i < load.ends[end].nodes.size(); ++i) {
      visit(load.ends[end].nodes[i], end == 0 ? -load.ends[end].weights[i] : load.ends[end].weights[i]);
    }
  }
}

}  // namespace

double DistanceBetween(const MeanPosition& a, const MeanPosition& b, const NodalVector& x) {
  return (PositionOf(b, x) - PositionOf(a, x)).norm();
}

std::vector<double> SharesOf(ElementOrder order, const PressureFace& face, const NodalVector& X) {
  std::vector<double> shares;
  WithFacePoints(order, [&]<int kNodes, std::size_t kPoints>(const std::array<FacePoint<kNodes>, kPoints>& points) {
    shares.assign(kNodes, 0.0);
    for (const FacePoint<kNodes>& point : points) {
      const double area = TangentOf<kNodes>(point.d1, face, X).cross(TangentOf<kNodes>(point.d2, face, X)).norm();
      for (int a = 0; a < kNodes; ++a) shares[a] += point.weight * area * point.N[a];
    }
  });
  return shares;
}

std::vector<SpringEntry> SpringsOnFaces(ElementOrder order, std::span<const PressureFace> faces, const NodalVector& X,
                                        const Vec3& stiffness) {
  std::vector<SpringEntry> entries;
  double area = 0;
  WithFacePoints(order, [&](const auto& points) {
    for (const PressureFace& face : faces) {
      for (const auto& point : points) AddSprings(face, point, X, stiffness, area, entries);
    }
  });
  for (SpringEntry& entry : entries) entry.stiffness /= area;
  return entries;
}

void AddPositionLoads(const TetModel& model, std::span<const double> load_scales, const NodalVector& x,
                      NodalVector& force) {
  WithFacePoints(model.order(), [&](const auto& points) {
    for (const PressureLoad& load : model.position_loads().pressures) {
      const double pressure = load_scales[load.load] * load.pressure;
      for (const PressureFace& face : load.faces) {
        for (const auto& point : points) AddPressureForce(pressure, face, point, x, force);
      }
    }
  });
  for (const SpringLoad& load : model.position_loads().springs) {
    for (const auto& [row, column, stiffness] : load.entries) {
      force[row] -= load_scales[load.load] * stiffness.cwiseProduct(x[column] - model.rest_positions()[column]);
    }
  }
  for (const LineSpringLoad& load : model.position_loads().line_springs) {
    AddLineSpringForce(load, load_scales[load.load], x, force);
  }
}

void LoadExpansion::Multiply(const NodalVector& x, NodalVector& product) const {
  product.assign(x.size(), Vec3::Zero());
  for (const auto& [row, column, block] : stiffness) product[row] += block * (x[column] - centre[column]);
}

LoadExpansion ExpandPositionLoads(const TetModel& model, std::span<const double> load_scales, const NodalVector& c) {
  LoadExpansion expansion{c, {}};
  WithFacePoints(model.order(), [&](const auto& points) {
    for (const PressureLoad& load : model.position_loads().pressures) {
      const double pressure = load_scales[load.load] * load.pressure;
      for (const PressureFace& face : load.faces) {
        for (const auto& point : points) AddPressureStiffness(pressure, face, point, c, expansion.stiffness);
      }
    }
  });
  for (const SpringLoad& load : model.position_loads().springs) {
    for (const auto& [row, column, stiffness] : load.entries) {
      expansion.stiffness.push_back({row, column, Mat3((load_scales[load.load] * stiffness).asDiagonal())});
    }
  }
  for (const LineSpringLoad& load : model.position_loads().line_springs) {
    const Mat3 stiffness = Stretched(load, load_scales[load.load], c).Stiffness();
    ForEnds(load, [&](std::int32_t row, double a) {
      ForEnds(load, [&](std::int32_t column, double b) {
        expansion.stiffness.push_back({row, column, a * b * stiffness});
      });
    });
  }
  return expansion;
}

void AddSpringStiffness(const TetModel& model, const NodalVector& p, NodalVector& product) {
  for (const SpringLoad& load : model.position_loads().springs) {
    for (const auto& [row, column, stiffness] : load.entries) {
      product[row] += load.largest_scale * stiffness.cwiseProduct(p[column]);
    }
  }
  for (const LineSpringLoad& load : model.position_loads().line_springs) {
    const Vec3 pull = load.largest_scale * load.stiffness * (PositionOf(load.ends[1], p) - PositionOf(load.ends[0], p));
    ForEnds(load, [&](std::int32_t node, double weight) { product[node] += weight * pull; });
  }
}

std::vector<std::int32_t> NodesOf(const LineSpringLoad& load) {
  std::vector<std::int32_t> nodes;
  ForEnds(load, [&](std::int32_t node, double) { nodes.push_back(node); });
  return nodes;
}

}  // namespace fascicle
