#ifndef FASCICLE_CLIENT_RENDER_BODY_CLOUD_H_
#define FASCICLE_CLIENT_RENDER_BODY_CLOUD_H_

#include <vtkRenderer.h>
#include <vtkUnstructuredGrid.h>

#include "client/render/colour_scale.h"

namespace fascicle::client {

// Draws a deformed body as a volume [Zhu, Chen & Kaufman 1998, 6]: resamples its elements to a regular grid, casts rays
// through it that accumulate density and colour, and adds a transparent isosurface of the density. `grid` has one value
// for each node (`colour`) if the scale has colours.
void AddCloud(vtkUnstructuredGrid& grid, const ColourScale& scale, vtkRenderer& renderer);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_BODY_CLOUD_H_
