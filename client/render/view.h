#ifndef FASCICLE_CLIENT_RENDER_VIEW_H_
#define FASCICLE_CLIENT_RENDER_VIEW_H_

#include <vtkRenderer.h>

#include <optional>

#include "client/render/picture.h"
#include "core/base/types.h"

namespace fascicle::client {

// The viewpoint and what fits into the picture. Parallel projection, so that lengths can be measured.

// The axes of the viewpoint's angles as columns, the third one the vertical `up` (unit). Along an axis, the others are
// axes, too: x, y, z for z; x, -z, y for y, so that the front faces +z as in files of animators; y, z, x for x.
Mat3 VerticalFrame(const Vec3& up);

// Points the camera of `renderer` at `bounds` [m] (in VTK's order: xmin, xmax, ...). If the options do not
// define the vertical, it is `up` (unit), the normal of a floor, or else z. `aspect` is the width of the panel over its
// height.
void AimCamera(const PictureOptions& options, const double bounds[6], const std::optional<Vec3>& up, double aspect,
               vtkRenderer& renderer);

// Draws a bar of a round length with its name into the lower right corner of a renderer of that size [pixel drawn]. The
// camera must have been aimed.
void AddLengthBar(double width, double height, vtkRenderer& renderer);

// Draws the directions of x, y and z into the lower left corner, in layer 2 of the window.
void AddDirections(vtkRenderWindow& window, vtkRenderer& renderer);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_VIEW_H_
