// FEBio's systems of units [FEBio User Manual, 3.2].
#include "client/import/units.h"

#include <array>

namespace fascicle::client {

std::optional<UnitSystem> UnitSystemNamed(std::string_view name) {
  if (name == "mm-N-MPa") name = "mm-N-s";
  if (name == "m-N-Pa") name = "SI";
  // The unit of mass follows from force = mass times acceleration: tonnes in mm-N-s, grams in um-nN-s.
  static const std::array<UnitSystem, 5> systems = {{
      {"mm-N-s", 1e-3, 1, 1e6, 1e12, v1::LENGTH_UNIT_MM, 1},
      {"SI", 1, 1, 1, 1, v1::LENGTH_UNIT_M, 1},
      {"mm-kg-s", 1e-3, 1e-3, 1e3, 1e9, v1::LENGTH_UNIT_MM, 1},
      {"um-nN-s", 1e-6, 1e-9, 1e3, 1e15, v1::LENGTH_UNIT_MM, 1e-3},
      {"CGS", 1e-2, 1e-5, 0.1, 1e3, v1::LENGTH_UNIT_CM, 1},
  }};
  for (const UnitSystem& system : systems) {
    if (system.name == name) return system;
  }
  return std::nullopt;
}

std::string KnownUnitSystems() { return "mm-N-s (or mm-N-MPa), SI (or m-N-Pa), mm-kg-s, um-nN-s, CGS"; }

}  // namespace fascicle::client
