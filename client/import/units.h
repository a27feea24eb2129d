#ifndef FASCICLE_CLIENT_IMPORT_UNITS_H_
#define FASCICLE_CLIENT_IMPORT_UNITS_H_

#include <optional>
#include <string>
#include <string_view>

#include "fascicle/v1/scene.pb.h"

namespace fascicle::client {

constexpr double kMaxSceneDensity = 30'000;  // of a scene [kg/m^3]

// A model's units in SI. Time is in seconds in all systems.
struct UnitSystem {
  std::string name;
  double metre = 1;    // [m]
  double newton = 1;   // [N]
  double pascal = 1;   // [Pa]
  double density = 1;  // [kg/m^3]
  // The unit of the scene's coordinates, and the factor that converts the model's coordinates to it.
  v1::LengthUnit scene_unit = v1::LENGTH_UNIT_M;
  double to_scene_unit = 1;
};

// The system with one of FEBio's names or aliases; nothing for an unknown name.
std::optional<UnitSystem> UnitSystemNamed(std::string_view name);

// All names, for messages.
std::string KnownUnitSystems();

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_UNITS_H_
