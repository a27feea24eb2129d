#include "client/lib/scene_settings.h"

#include <charconv>
#include <optional>
#include <string_view>

namespace fascicle::client {
namespace {

using nlohmann::json;

constexpr const char* kHint = "such as --set 'bodies[0].activation.values[1]=0.5'";

// One step of a path: the name of a field, or an index in a list.
struct Step {
  std::string_view name;
  std::optional<std::size_t> index;
};

// Parses "bodies[0].name" to bodies, 0, name; nothing if it is malformed.
std::optional<std::vector<Step>> ParsePath(std::string_view path) {
  std::vector<Step> steps;
  while (!path.empty()) {
    if (path[0] == '[') {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(path.data() + 1, path.data() + path.size(), index);
      if (error != std::errc() || end == path.data() + path.size() || *end != ']') return std::nullopt;
      steps.push_back({{}, index});
      path.remove_prefix(static_cast<std::size_t>(end + 1 - path.data()));
    } else {
      if (!steps.empty()) {
        if (path[0] != '.') return std::nullopt;
        path.remove_prefix(1);
      }
      const std::string_view name = path.substr(0, path.find_first_of(".["));
      if (name.empty()) return std::nullopt;
      steps.push_back({name, std::nullopt});
      path.remove_prefix(name.size());
    }
  }
  if (steps.empty()) return std::nullopt;
  return steps;
}

// The value at the end of a path; null if a step does not exist.
json* Find(const std::vector<Step>& steps, json& scene) {
  json* at = &scene;
  for (const Step& step : steps) {
    if (step.index) {
      if (!at->is_array() || *step.index >= at->size()) return nullptr;
      at = &(*at)[*step.index];
    } else {
      if (!at->is_object() && !at->is_null()) return nullptr;
      at = &(*at)[std::string(step.name)];
    }
  }
  return at;
}

void Apply(const std::string& setting, json& scene, Problems& problems) {
  const std::size_t equals = setting.find('=');
  const std::string path = setting.substr(0, equals);
  const auto steps = ParsePath(path);
  if (equals == std::string::npos || !steps) {
    problems.Add("", "--set " + setting + " is not PATH=VALUE", kHint);
    return;
  }
  json* const place = Find(*steps, scene);
  if (place == nullptr) {
    problems.Add(path, "cannot be set: the scene has no such element", kHint);
    return;
  }
  const std::string text = setting.substr(equals + 1);
  json value = json::parse(text, nullptr, false);
  *place = value.is_discarded() ? json(text) : std::move(value);
}

}  // namespace

void ApplySettings(const std::vector<std::string>& settings, json& scene, Problems& problems) {
  for (const std::string& setting : settings) Apply(setting, scene, problems);
}

}  // namespace fascicle::client
