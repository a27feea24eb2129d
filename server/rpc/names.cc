#include "server/rpc/names.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "core/base/digest.h"

namespace fascicle::server {
namespace {

bool IsId(std::string_view id) {
  const auto alphanumeric = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  return !id.empty() && id.size() <= 64 && std::all_of(id.begin(), id.end(), alphanumeric);
}

std::optional<std::string_view> After(std::string_view prefix, std::string_view name) {
  if (!name.starts_with(prefix)) return std::nullopt;
  return name.substr(prefix.size());
}

std::string CheckOf(std::string_view last_id, std::string_view filter) {
  std::array<char, 9> hex;
  std::snprintf(hex.data(), hex.size(), "%08x", static_cast<unsigned>(Crc32c(filter, Crc32c(last_id))));
  return std::string(hex.data(), 8);
}

}  // namespace

std::string JobName(std::string_view id) { return "jobs/" + std::string(id); }

std::optional<std::string> ParseJobName(std::string_view name) {
  const auto id = After("jobs/", name);
  if (!id || !IsId(*id)) return std::nullopt;
  return std::string(*id);
}

std::string AssetName(std::string_view sha256_hex) { return "assets/" + std::string(sha256_hex); }

std::optional<std::string> ParseAssetName(std::string_view name) {
  const auto hex = After("assets/", name);
  const auto lower_hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if (!hex || hex->size() != 64 || !std::all_of(hex->begin(), hex->end(), lower_hex)) return std::nullopt;
  return std::string(*hex);
}

std::string MakePageToken(std::string_view last_id, std::string_view filter) {
  return CheckOf(last_id, filter) + std::string(last_id);
}

std::optional<std::string> ParsePageToken(std::string_view token, std::string_view filter) {
  if (token.size() < 9) return std::nullopt;
  const std::string_view id = token.substr(8);
  if (!IsId(id) || token.substr(0, 8) != CheckOf(id, filter)) return std::nullopt;
  return std::string(id);
}

}  // namespace fascicle::server
