#include "server/rpc/names.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
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

constexpr std::size_t kCheckSize = 8;

std::string CheckOf(std::string_view place, std::string_view list) {
  std::array<char, kCheckSize + 1> hex;
  std::snprintf(hex.data(), hex.size(), "%08x", static_cast<unsigned>(Crc32c(list, Crc32c(place))));
  return std::string(hex.data(), kCheckSize);
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

std::string MakePageToken(const JobPlace& last, std::string_view list) {
  const std::string place = std::to_string(last.number) + "." + last.id + "." + last.text;
  return CheckOf(place, list) + place;
}

std::optional<JobPlace> ParsePageToken(std::string_view token, std::string_view list) {
  if (token.size() < kCheckSize) return std::nullopt;
  const std::string_view place = token.substr(kCheckSize);
  if (token.substr(0, kCheckSize) != CheckOf(place, list)) return std::nullopt;
  const std::size_t id = place.find('.') + 1, text = place.find('.', id) + 1;
  if (id == 0 || text == 0) return std::nullopt;
  JobPlace parsed = {.text = std::string(place.substr(text)), .id = std::string(place.substr(id, text - id - 1))};
  const char* end_of_number = place.data() + id - 1;
  const auto [end, error] = std::from_chars(place.data(), end_of_number, parsed.number);
  if (error != std::errc() || end != end_of_number || !IsId(parsed.id)) return std::nullopt;
  return parsed;
}

}  // namespace fascicle::server
