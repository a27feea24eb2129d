#ifndef FASCICLE_CORE_SKELETON_LINE_MUSCLE_H_
#define FASCICLE_CORE_SKELETON_LINE_MUSCLE_H_

#include <array>
#include <string>
#include <vector>

#include "core/base/types.h"
#include "core/skeleton/hill_muscle.h"
#include "core/skeleton/scalar_function.h"

namespace fascicle {

// A point through which a muscle passes, fixed to a bone. A conditional point counts only while a coordinate is within
// a range; the place of a moving point depends on coordinates.
struct PathPoint {
  int bone = 0;               // -1: the ground
  Vec3 place = Vec3::Zero();  // in the bone's frame [m]
  int condition = -1;         // a coordinate; -1: counts always
  std::array<double, 2> range = {0, 0};
  // For each direction of the bone's frame: the coordinate and the function of it that gives the place; -1: `place`.
  std::array<int, 3> moved_by = {-1, -1, -1};
  std::array<ScalarFunction, 3> moved = {};
};

// A surface around which a muscle passes between two of its points.
struct PathWrap {
  int surface = 0;  // of the skeleton
  // Points between which the muscle may touch the surface.
  int first = 0, last = 0;
};

// A muscle as a line from its origin to its insertion.
struct LineMuscle {
  std::string name;
  std::vector<PathPoint> points;  // at least two
  std::vector<PathWrap> wraps = {};
  double max_isometric_force = 0;   // [N]
  double optimal_fibre_length = 0;  // [m]
  double tendon_slack_length = 0;   // [m]
  double pennation = 0;             // at the optimal fibre length [rad]
  HillCurves hill = {};
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_LINE_MUSCLE_H_
