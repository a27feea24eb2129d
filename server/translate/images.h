#ifndef FASCICLE_SERVER_TRANSLATE_IMAGES_H_
#define FASCICLE_SERVER_TRANSLATE_IMAGES_H_

#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/voxel_grid.h"
#include "server/translate/body_source.h"

namespace fascicle::server {

// The voxels of the image that a body's mesh names, after all stages. Notes describe the results of the stages. Nothing
// if something is wrong.
std::optional<VoxelGrid> TranslateImage(const BodySource& source, const std::string& path,
                                        std::vector<std::string>& notes, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_IMAGES_H_
