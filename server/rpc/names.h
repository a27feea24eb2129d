#ifndef FASCICLE_SERVER_RPC_NAMES_H_
#define FASCICLE_SERVER_RPC_NAMES_H_

#include <optional>
#include <string>
#include <string_view>

namespace fascicle::server {

// Resource names on the wire: `jobs/{id}` and `assets/{sha256}`.

std::string JobName(std::string_view id);
// The id, 1 to 64 letters and digits; nothing when `name` is no name of a job.
std::optional<std::string> ParseJobName(std::string_view name);

std::string AssetName(std::string_view sha256_hex);
// The 64 lower-case hexadecimal digits; nothing when `name` is no name of an asset.
std::optional<std::string> ParseAssetName(std::string_view name);

// Where a list of jobs goes on: the last id that was given, with a check over id and `filter`, so that garbage and
// tokens of another list are told from real ones.
std::string MakePageToken(std::string_view last_id, std::string_view filter);
std::optional<std::string> ParsePageToken(std::string_view token, std::string_view filter);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_NAMES_H_
