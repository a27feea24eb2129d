#ifndef FASCICLE_SERVER_TRANSLATE_BODY_SOURCE_H_
#define FASCICLE_SERVER_TRANSLATE_BODY_SOURCE_H_

#include <cstdint>
#include <initializer_list>
#include <string>

#include "core/base/problems.h"
#include "core/geometry/shapes.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/skeleton.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// A body's message, and everything needed to translate it.
struct BodySource {
  const v1::Body& wire;  // defaults filled in
  std::string path;      // `bodies[0]`
  const AssetReader& assets;
  std::int64_t& budget;  // elements left for the body; reduced by its number of elements
  const TranslateTools& tools;
  const TranslatedSkeleton& skeleton;  // of the scene
  int refinements = 0;                 // times that each element is divided
  // Whether bodies of the tet method keep their hexahedra.
  Cells cells = Cells::kTetrahedra;
  bool quadratic = false;  // whether its elements are quadratic
};

// Adds a problem for each of the named fields that the body has, because its shape does not support them.
void RefuseFields(const BodySource& source, std::initializer_list<const char*> fields, const std::string& message,
                  const std::string& hint, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_BODY_SOURCE_H_
