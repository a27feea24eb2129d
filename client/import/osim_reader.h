#ifndef FASCICLE_CLIENT_IMPORT_OSIM_READER_H_
#define FASCICLE_CLIENT_IMPORT_OSIM_READER_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/import/febio_import.h"
#include "core/base/problems.h"
#include "core/skeleton/skeleton.h"

namespace fascicle::client {

// A skeleton of a model file, and what the file has besides.
struct OsimModel {
  Skeleton skeleton;
  std::vector<Notice> notices;  // what is not supported or changed, in the order of the file
};

// Reads an OpenSim model (.osim of version 3 or 4): bones with mass, inertia and surfaces; weld, pin, slider,
// universal, ball, free, planar and custom joints with their functions; coordinates; muscles with their path points
// (conditional and moving ones, too) and the cylinders, spheres and
// ellipsoids around which they wrap.
//
// `name` is that of the file in messages. All problems are added at once, each with its line. Any input is safe:
// entities and other files are never followed. Source: the classes' properties in OpenSim's documentation. Thread-safe.
std::optional<OsimModel> ReadOsim(std::string_view bytes, const std::string& name, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_OSIM_READER_H_
