#ifndef FASCICLE_CLIENT_VTK_BODY_GRID_H_
#define FASCICLE_CLIENT_VTK_BODY_GRID_H_

#include <vtkCellArray.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <cstdint>
#include <vector>

#include "client/lib/decode.h"

// Decoded geometry as VTK's data, in double precision and metres. Thread-safe.
namespace fascicle::client {

// The corners of a brick in VTK's order of a hexahedron: around the lower side, then around the upper one.
inline constexpr std::array<std::size_t, 8> kHexahedronCorners = {0, 1, 3, 2, 4, 5, 7, 6};

vtkSmartPointer<vtkPoints> MakePoints(const std::vector<Vec3>& positions);

vtkSmartPointer<vtkCellArray> MakeTriangles(const std::vector<std::array<std::uint32_t, 3>>& triangles);

// The elements of a body with its nodes at `positions`: tetrahedra of four or ten nodes, bricks as hexahedra, or
// triangles.
vtkSmartPointer<vtkUnstructuredGrid> MakeGrid(const BodyShape& shape, const std::vector<Vec3>& positions);

// The same with every quadratic tetrahedron divided into eight of four nodes, which use its mid-edge nodes.
vtkSmartPointer<vtkUnstructuredGrid> MakeLinearGrid(const BodyShape& shape, const std::vector<Vec3>& positions);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_VTK_BODY_GRID_H_
