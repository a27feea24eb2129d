#ifndef FASCICLE_SERVER_RPC_NAMES_H_
#define FASCICLE_SERVER_RPC_NAMES_H_

#include <optional>
#include <string>
#include <string_view>

#include "server/store/job_query.h"

namespace fascicle::server {

// Resource names on the wire: `jobs/{id}` and `assets/{sha256}`.

std::string JobName(std::string_view id);
// The id, 1 to 64 letters and digits; nothing if `name` is not a job name.
std::optional<std::string> ParseJobName(std::string_view name);

std::string AssetName(std::string_view sha256_hex);
// The 64 lower-case hexadecimal digits; nothing if `name` is not an asset name.
std::optional<std::string> ParseAssetName(std::string_view name);

// The place of the last job returned of a list, with a checksum over it and `list`, the description of that list, which
// detects invalid tokens and those of another list.
std::string MakePageToken(const JobPlace& last, std::string_view list);
std::optional<JobPlace> ParsePageToken(std::string_view token, std::string_view list);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_NAMES_H_
