#ifndef FASCICLE_CLIENT_LIB_DECODE_H_
#define FASCICLE_CLIENT_LIB_DECODE_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/types.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// Decodes the bytes of frames and geometry to arrays. All functions throw std::runtime_error, with a message for users,
// if sizes are wrong, indices out of range or values missing.

// Rest geometry of one body.
struct BodyShape {
  std::string name;
  std::vector<Vec3> positions;                           // [m]
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;  // node indices, all in range
  std::vector<std::array<std::uint32_t, 8>> bricks;      // in place of tetrahedra: voxels, as in BodyGeometry
  std::vector<std::array<std::uint32_t, 3>> triangles;   // in place of tetrahedra: a closed surface
  std::vector<Vec3> fibres;                              // unit, one for each tetrahedron, or empty
  struct Region {
    std::string name;
    std::vector<std::uint32_t> nodes;  // all in range
  };
  std::vector<Region> regions;

  std::size_t elements() const { return tetrahedra.size() + bricks.size() + triangles.size(); }
};

// The corners of a brick in hexahedron order: around the lower side, then around the upper one.
inline constexpr std::array<std::size_t, 8> kHexahedronCorners = {0, 1, 3, 2, 4, 5, 7, 6};

// VTK's cell type for the elements of a body: tetrahedra (10), voxels as hexahedra (12) or triangles (5).
inline int CellTypeOf(const BodyShape& shape) { return !shape.bricks.empty() ? 12 : !shape.triangles.empty() ? 5 : 10; }

std::vector<BodyShape> DecodeGeometry(const v1::Geometry& geometry);

// Positions [m] of a body with `nodes` nodes.
std::vector<Vec3> DecodePositions(const v1::BodyFrame& frame, std::size_t nodes);

// Values of a field, component fastest: `components` for each node or element of `shape`.
std::vector<double> DecodeField(const v1::FieldValues& field, const BodyShape& shape);

// Throws unless `frame` has as many bodies and series as `geometry`.
void CheckFits(const v1::Frame& frame, const v1::Geometry& geometry);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_DECODE_H_
