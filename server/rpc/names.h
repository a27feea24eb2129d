#ifndef FASCICLE_SERVER_RPC_NAMES_H_
#define FASCICLE_SERVER_RPC_NAMES_H_

#include <optional>
#include <string>
#include <string_view>

namespace fascicle::server {

// Resource names on the wire: `jobs/{id}` and `assets/{sha256}`.

std::string JobName(std::string_view id);
// The id, 1 to 64 letters and digits; nothing if `name` is not a job name.
std::optional<std::string> ParseJobName(std::string_view name);

std::string AssetName(std::string_view sha256_hex);
// The 64 lower-case hexadecimal digits; nothing if `name` is not an asset name.
std::optional<std::string> ParseAssetName(std::string_view name);

// The position in a list of jobs: the last id returned, with a checksum over id and `filter` that detects invalid
// tokens and those of another list.
std::string MakePageToken(std::string_view last_id, std::string_view filter);
std::optional<std::string> ParsePageToken(std::string_view token, std::string_view filter);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_NAMES_H_
