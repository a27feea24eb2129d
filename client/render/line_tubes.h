#ifndef FASCICLE_CLIENT_RENDER_LINE_TUBES_H_
#define FASCICLE_CLIENT_RENDER_LINE_TUBES_H_

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <vector>

#include "core/base/types.h"

namespace fascicle::client {

// A round tube along a path: cylinders with spheres at the bends, closed at both ends. Empty if the path has zero
// length. Path and radius [m].
vtkSmartPointer<vtkPolyData> MakeTube(const std::vector<Vec3>& points, double radius);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_LINE_TUBES_H_
