#ifndef FASCICLE_SERVER_TRANSLATE_REFINE_BODY_H_
#define FASCICLE_SERVER_TRANSLATE_REFINE_BODY_H_

#include "core/base/problems.h"
#include "core/scene/body.h"
#include "server/translate/body_source.h"
#include "server/translate/regions.h"

namespace fascicle::server {

// Divides the elements of a complete body as often as the scene asks for. Parts of an element have its fibre, material
// and activation; regions are selected again. A body of the eulerian method keeps its surface: its grid is refined
// instead. A problem if the elements would exceed the source's budget. Throws Stopped after a stop request.
void RefineBody(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_REFINE_BODY_H_
