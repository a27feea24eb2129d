#ifndef FASCICLE_CLIENT_RENDER_VIEW_H_
#define FASCICLE_CLIENT_RENDER_VIEW_H_

#include <vtkRenderer.h>

#include "client/render/picture.h"

namespace fascicle::client {

// Where the eye stands and what fits into the picture. Parallel projection, so that lengths can be measured.

// Points the camera of `renderer` at its props; `bounds` [m] as VTK has them (xmin, xmax, ...), of the bodies.
void AimCamera(const PictureOptions& options, const double bounds[6], vtkRenderer& renderer);

// Draws a bar of a round length with its name into the lower right corner. The camera must have been aimed.
void AddLengthBar(const Canvas& canvas, vtkRenderer& renderer);

// Draws the directions of x, y and z into the lower left corner, in layer 2 of the window.
void AddDirections(vtkRenderWindow& window, vtkRenderer& renderer);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_VIEW_H_
