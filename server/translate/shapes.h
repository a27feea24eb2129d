#ifndef FASCICLE_SERVER_TRANSLATE_SHAPES_H_
#define FASCICLE_SERVER_TRANSLATE_SHAPES_H_

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "server/translate/body_source.h"
#include "server/translate/regions.h"

namespace fascicle::server {

// The shapes of bodies, one function each. They fill in the body's shape, regions and notes, and refuse fields that the
// shape does not support. False if there is no mesh; then only what does not depend on it is checked.
//   structure  gets the problems of the mesh and its regions, which keep CheckScene from checking the body
//   others     gets all other problems; neutral values replace invalid ones
bool TranslateTetShape(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& structure,
                       Problems& others);
bool TranslateVoxelShape(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& structure,
                         Problems& others);
bool TranslateSurfaceShape(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& structure,
                           Problems& others);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_SHAPES_H_
