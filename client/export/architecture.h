#ifndef FASCICLE_CLIENT_EXPORT_ARCHITECTURE_H_
#define FASCICLE_CLIENT_EXPORT_ARCHITECTURE_H_

#include <optional>
#include <vector>

#include "client/export/sample.h"

// The architecture of a muscle: its size across an axis, and its fibres. All functions are pure.
namespace fascicle::client {

// Areas of plane cross-sections of a body [m^2], at rest or deformed, at `count` places in the middle of equal parts of
// its extent along `axis` (any non-zero length).
struct CrossSectionAreas {
  std::vector<double> places;  // along the axis, from the origin [m]
  std::vector<double> areas;   // [m^2]
};
CrossSectionAreas CrossSectionAreasOf(const BodySnapshot& body, const Vec3& axis, int count, bool deformed);

// Fibres are traced through the elements from points that represent equal parts of the rest volume, in both directions,
// to the surface. They move with the material.
struct FibreArchitecture {
  std::size_t fibres = 0;  // traced
  double volume = 0;       // [m^3]
  double length = 0;       // mean over the volume [m]
  double shortest = 0, longest = 0;
  double pennation = 0;  // mean angle to the line of action [rad]
  // Physiological cross-section: the sum of each fibre's part of the volume, divided by its length, times the cosine of
  // its pennation [m^2]. For fibres of equal length, V cos(pennation) / length [Powell et al. 1984].
  double cross_section = 0;
};
// Nothing for a body without fibres, or of triangles.
//   line_of_action  any non-zero length; the body's longest principal axis if there is none
std::optional<FibreArchitecture> FibreArchitectureOf(const BodySnapshot& body,
                                                     const std::optional<Vec3>& line_of_action, bool deformed);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_EXPORT_ARCHITECTURE_H_
