#ifndef FASCICLE_CLIENT_IMPORT_ENCODE_SKELETON_H_
#define FASCICLE_CLIENT_IMPORT_ENCODE_SKELETON_H_

#include <string>
#include <vector>

#include "core/skeleton/skeleton.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::client {

// A name as a scene may have it: letters, digits, `_`, `-` and `.`, at most 64 of them; others become `_`.
std::string SceneName(const std::string& name);

// The message of a skeleton, without motion and activations. Shapes of bones refer to files by the names of their
// surfaces. Names become SceneName, unique in their list; each changed one is added to `renamed`.
v1::Skeleton EncodeSkeleton(Skeleton skeleton, std::vector<std::string>& renamed);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_ENCODE_SKELETON_H_
