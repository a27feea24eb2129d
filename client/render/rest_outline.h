#ifndef FASCICLE_CLIENT_RENDER_REST_OUTLINE_H_
#define FASCICLE_CLIENT_RENDER_REST_OUTLINE_H_

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "core/base/types.h"

namespace fascicle::client {

// The outline of a closed surface in parallel projection, as lines: edges between a face that is turned to the eye and
// one that is not, and with `sharp` also those in front at which the surface bends by more than 60 degrees. Edges of
// the back are left out. `eye` is the direction towards the eye.
vtkSmartPointer<vtkPolyData> MakeRestOutline(vtkPolyData& surface, const Vec3& eye, bool sharp);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_REST_OUTLINE_H_
