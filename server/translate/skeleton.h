#ifndef FASCICLE_SERVER_TRANSLATE_SKELETON_H_
#define FASCICLE_SERVER_TRANSLATE_SKELETON_H_

#include <optional>

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/names.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// A scene's skeleton, and the names to which bodies refer.
struct TranslatedSkeleton {
  std::optional<DrivenSkeleton> driven;  // nothing if there is none, or after a problem
  Names bones{"bone"}, muscles{"muscle of the skeleton"};

  // The activation of a muscle; that of none if its name is not known, or the skeleton has problems.
  Curve ActivationOf(const std::string& muscle, const std::string& path, Problems& problems) const;
};

// gravity: of the scene, whose skeleton it acts on.
TranslatedSkeleton TranslateSkeleton(const v1::Scene& scene, const Gravity& gravity, const AssetReader& assets,
                                     const TranslateTools& tools, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_SKELETON_H_
