#ifndef FASCICLE_SERVER_TRANSLATE_FILES_H_
#define FASCICLE_SERVER_TRANSLATE_FILES_H_

#include <optional>
#include <string>

#include "core/base/problems.h"
#include "fascicle/v1/file.pb.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// The bytes of a file; nothing, with a problem, if its digest is malformed or its asset is missing.
std::optional<std::string> ReadFile(const v1::FileRef& file, const std::string& path, const AssetReader& assets,
                                    Problems& problems);

// The 64 hexadecimal digits of `assets/{sha256}`; empty if the name has another form.
std::string DigestOfAsset(const std::string& asset);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_FILES_H_
