#ifndef FASCICLE_CLIENT_IMPORT_UNITS_H_
#define FASCICLE_CLIENT_IMPORT_UNITS_H_

#include <optional>
#include <string>
#include <string_view>

#include "fascicle/v1/scene.pb.h"

namespace fascicle::client {

// What one unit of a model's system is in SI. Time is in seconds in all of them.
struct UnitSystem {
  std::string name;
  double metre = 1;    // [m]
  double newton = 1;   // [N]
  double pascal = 1;   // [Pa]
  double density = 1;  // [kg/m^3]
  // The unit in which a scene's coordinates are written, and what the model's are to be multiplied by for that.
  v1::LengthUnit scene_unit = v1::LENGTH_UNIT_M;
  double to_scene_unit = 1;
};

// A system by one of FEBio's names or their aliases; nothing for another name.
std::optional<UnitSystem> UnitSystemNamed(std::string_view name);

// All names, for messages.
std::string KnownUnitSystems();

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_UNITS_H_
