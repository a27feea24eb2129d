#ifndef FASCICLE_SERVER_TRANSLATE_IMAGES_H_
#define FASCICLE_SERVER_TRANSLATE_IMAGES_H_

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/problems.h"
#include "core/geometry/voxel_grid.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// The voxels of an image shape (defaults filled in) after all stages; `metres` is the body's length unit. Notes
// describe the results of the stages. Nothing if something is wrong.
std::optional<VoxelGrid> TranslateImage(const v1::ImageShape& shape, double metres, const std::string& path,
                                        const AssetReader& assets, std::vector<std::string>& notes, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_IMAGES_H_
