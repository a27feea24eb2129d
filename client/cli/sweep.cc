#include "client/cli/sweep.h"

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"

namespace fascicle::client {
namespace {

constexpr std::size_t kMostPoints = 10'000;

// The settings of one sweep.
std::vector<std::string> SettingsOf(const std::string& sweep) {
  const std::size_t equals = sweep.find('=');
  const Json values = equals == std::string::npos ? Json() : Json::parse(sweep.substr(equals + 1), nullptr, false);
  if (equals == 0 || !values.is_array() || values.empty()) {
    throw CommandError::Invalid("--sweep " + sweep +
                                " is not PATH=[VALUE, ...], such as --sweep 'bodies[0].density=[1000, 1060, 1100]'");
  }
  std::vector<std::string> settings;
  for (const Json& value : values) settings.push_back(sweep.substr(0, equals + 1) + value.dump());
  return settings;
}

}  // namespace

void AddSweepOption(CLI::App& command, std::vector<std::string>& sweeps) {
  command
      .add_option("--sweep", sweeps,
                  "A job for each value of a field; of several, for each combination. 'duration=[0.1, 0.2]'")
      ->type_name("PATH=[VALUE, ...]")
      ->allow_extra_args(false);
}

std::vector<SweepPoint> PointsOf(const std::vector<std::string>& sweeps) {
  std::vector<SweepPoint> points(1);
  for (const std::string& sweep : sweeps) {
    const std::vector<std::string> settings = SettingsOf(sweep);
    if (points.size() * settings.size() > kMostPoints) {
      throw CommandError::Invalid("the sweeps have more than " + std::to_string(kMostPoints) + " combinations");
    }
    std::vector<SweepPoint> finer;
    for (const SweepPoint& point : points) {
      for (const std::string& setting : settings) {
        finer.push_back(point);
        finer.back().push_back(setting);
      }
    }
    points = std::move(finer);
  }
  return points;
}

}  // namespace fascicle::client
