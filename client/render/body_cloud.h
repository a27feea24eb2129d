#ifndef FASCICLE_CLIENT_RENDER_BODY_CLOUD_H_
#define FASCICLE_CLIENT_RENDER_BODY_CLOUD_H_

#include <vtkRenderer.h>
#include <vtkUnstructuredGrid.h>

#include "client/render/colour_scale.h"

namespace fascicle::client {

// Draws a deformed body as a volume [Zhu, Chen & Kaufman 1998, 5]: its elements resampled to a regular grid, rays cast
// through it that gather density and colour, and a transparent surface of equal density around it. `grid` has one value
// for each node (`colour`) where the scale has colours.
void AddCloud(vtkUnstructuredGrid& grid, const ColourScale& scale, vtkRenderer& renderer);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_BODY_CLOUD_H_
