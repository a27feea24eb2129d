#include "core/geometry/shapes.h"

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/check.h"

namespace fascicle {
namespace {

constexpr double kPi = std::numbers::pi;

// Local nodes of a hexahedron: bit d of kCorner[n] tells whether node n is at the far end along axis d.
constexpr int kCorner[8] = {0b000, 0b001, 0b011, 0b010, 0b100, 0b101, 0b111, 0b110};
constexpr int kKuhn[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};

// A block of hexahedra. A mirrored axis is split in two halves, with the hexahedra's local axes pointing away from the
// middle. Every hexahedron at a rounded edge is then split through that edge, not beside it, which would create
// slivers. The faces between mirror images match.
struct Block {
  std::array<int, 3> divisions;
  std::array<bool, 3> mirrored = {false, false, false};
  bool ring = false;  // the last axis is periodic

  int NodeCount(int axis) const { return divisions[axis] + (ring && axis == 2 ? 0 : 1); }
  std::int32_t Node(const std::array<int, 3>& at) const {
    const int k = at[2] % (ring ? divisions[2] : divisions[2] + 1);
    return at[0] + NodeCount(0) * (at[1] + NodeCount(1) * k);
  }
};

void AddHexahedron(const Block& block, const std::array<int, 3>& at, TetMesh& mesh) {
  std::vector<Tetrahedron>& tetrahedra = mesh.tetrahedra;
  bool mirror_image = false;
  std::array<bool, 3> backwards{};
  for (int axis = 0; axis < 3; ++axis) {
    backwards[axis] = block.mirrored[axis] && 2 * at[axis] < block.divisions[axis];
    mirror_image ^= backwards[axis];
  }
  std::array<std::int32_t, 8> nodes;
  for (int n = 0; n < 8; ++n) {
    std::array<int, 3> corner = at;
    for (int axis = 0; axis < 3; ++axis) corner[axis] += ((kCorner[n] >> axis) & 1) ^ (backwards[axis] ? 1 : 0);
    nodes[n] = block.Node(corner);
  }
  for (const auto& [a, b, c, d] : kKuhn) {
    if (mirror_image) {
      tetrahedra.push_back({nodes[a], nodes[c], nodes[b], nodes[d]});
    } else {
      tetrahedra.push_back({nodes[a], nodes[b], nodes[c], nodes[d]});
    }
  }
}

Hexahedron HexahedronAt(const Block& block, const std::array<int, 3>& at) {
  Hexahedron nodes;
  for (int n = 0; n < 8; ++n) {
    std::array<int, 3> corner = at;
    for (int axis = 0; axis < 3; ++axis) corner[axis] += (kCorner[n] >> axis) & 1;
    nodes[n] = block.Node(corner);
  }
  return nodes;
}

// Fills a block; place(i, j, k) is the position of node (i, j, k).
template <class Place>
TetMesh MakeBlock(const Block& block, Cells cells, const Place& place) {
  const auto& [nx, ny, nz] = block.divisions;
  FASCICLE_CHECK(nx >= 1 && ny >= 1 && nz >= 1, "a shape has at least one hexahedron along each axis");
  TetMesh mesh;
  mesh.nodes.reserve(std::size_t(block.NodeCount(0)) * block.NodeCount(1) * block.NodeCount(2));
  for (int k = 0; k < block.NodeCount(2); ++k) {
    for (int j = 0; j < block.NodeCount(1); ++j) {
      for (int i = 0; i < block.NodeCount(0); ++i) mesh.nodes.push_back(place(i, j, k));
    }
  }
  mesh.tetrahedra.reserve(std::size_t(6) * nx * ny * nz);
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        AddHexahedron(block, {i, j, k}, mesh);
        if (cells == Cells::kHexahedra) mesh.hexahedra.push_back(HexahedronAt(block, {i, j, k}));
      }
    }
  }
  return mesh;
}

// Coordinate of node `index` out of `divisions` along [-1, 1].
double Centred(int index, int divisions) { return (2.0 * index - divisions) / divisions; }

// Maps the square or cube [-1, 1]^N onto the unit disc or ball. Concentric square shells become circles or spheres,
// with equal angles along each side. In two dimensions the map preserves ratios of area [Shirley and Chiu 1997, "A low
// distortion map between disk and square"]; in three it is the equiangular cubed sphere [Ronchi et al. 1996].
template <int N>
Eigen::Matrix<double, N, 1> RoundOff(const Eigen::Matrix<double, N, 1>& point) {
  const double radius = point.cwiseAbs().maxCoeff();
  if (radius == 0) return point;
  Eigen::Matrix<double, N, 1> direction;
  for (int d = 0; d < N; ++d) {
    // Exactly +-1 on the shell's own side, so that opposite sides match to the bit.
    direction[d] =
        std::abs(point[d]) == radius ? std::copysign(1.0, point[d]) : std::tan(kPi / 4 * (point[d] / radius));
  }
  return radius / direction.norm() * direction;
}

Eigen::Vector2d OnDisc(int i, int j, int divisions) {
  return RoundOff<2>({Centred(i, divisions), Centred(j, divisions)});
}

}  // namespace

TetMesh MakeBox(const Vec3& origin, const Vec3& size, const std::array<int, 3>& divisions, Cells cells) {
  return MakeBlock({divisions}, cells, [&](int i, int j, int k) {
    return Vec3(origin.x() + size.x() * (double(i) / divisions[0]), origin.y() + size.y() * (double(j) / divisions[1]),
                origin.z() + size.z() * (double(k) / divisions[2]));
  });
}

TetMesh MakeFusiform(const Fusiform& shape, Cells cells) {
  const int across = shape.divisions_across, along = shape.divisions_along;
  return MakeBlock({{across, across, along}, {true, true, false}}, cells, [&](int i, int j, int k) {
    const double s = double(k) / along;
    const double sine = std::sin(kPi * s);
    const double radius = shape.end_radius + (shape.belly_radius - shape.end_radius) * (sine * sine);
    const Eigen::Vector2d at = radius * OnDisc(i, j, across);
    return Vec3(at.x(), at.y(), shape.length * s);
  });
}

TetMesh MakeTorus(const Torus& shape, Cells cells) {
  const int across = shape.divisions_across, around = shape.divisions_around;
  return MakeBlock({{across, across, around}, {true, true, false}, true}, cells, [&](int i, int j, int k) {
    // Along the axis, radially, around the axis: a right-handed frame.
    const Eigen::Vector2d at = shape.minor_radius * OnDisc(i, j, across);
    const double angle = 2 * kPi * k / around;
    const double radius = shape.major_radius + at.y();
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), at.x());
  });
}

TetMesh MakeSphere(double radius, int divisions, Cells cells) {
  return MakeBlock({{divisions, divisions, divisions}, {true, true, true}}, cells, [&](int i, int j, int k) -> Vec3 {
    return radius * RoundOff<3>({Centred(i, divisions), Centred(j, divisions), Centred(k, divisions)});
  });
}

}  // namespace fascicle
