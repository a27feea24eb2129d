#ifndef FASCICLE_CLIENT_RENDER_BODY_MESH_H_
#define FASCICLE_CLIENT_RENDER_BODY_MESH_H_

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <vector>

#include "client/lib/decode.h"

namespace fascicle::client {

// The elements at given positions, with one value (`colour`) for each node if `values` is not empty.
vtkSmartPointer<vtkUnstructuredGrid> MakeGrid(const BodyShape& shape, const std::vector<Vec3>& positions,
                                              const std::vector<double>& values);

// Gives each node a value (`colour`), unless `values` is empty.
void SetColours(const std::vector<double>& values, vtkUnstructuredGrid& grid);

// The triangles of a rigid body in its pose.
vtkSmartPointer<vtkUnstructuredGrid> MakeGrid(const RigidShape& body, const Pose& pose);

// Whether a body consists of bricks of one shape, as those of an image.
bool IsOfVoxels(const BodyShape& shape);

// The edges of the surface's elements, curved where quadratic elements have curved ones, with one value (`colour`) for
// each node if `values` is not empty.
vtkSmartPointer<vtkPolyData> MakeCurvedEdges(const BodyShape& shape, const std::vector<Vec3>& positions,
                                             const std::vector<double>& values);

// Boundary faces, of quadratic elements divided in sixteen, with normals for smooth shading; edges sharper than 40
// degrees stay sharp. `smooth`: moves corners, by less than a voxel, to hide the steps between voxels.
vtkSmartPointer<vtkPolyData> MakeSurface(vtkUnstructuredGrid& grid, bool smooth = false);

// Lines along the fibres in the deformed body, through about `seeds` points; empty without fibres.
vtkSmartPointer<vtkPolyData> MakeFibreLines(const BodyShape& shape, const std::vector<Vec3>& positions, int seeds);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_BODY_MESH_H_
