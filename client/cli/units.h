#ifndef FASCICLE_CLIENT_CLI_UNITS_H_
#define FASCICLE_CLIENT_CLI_UNITS_H_

#include <string_view>

namespace fascicle::client {

// A unit of length on the command line, mm, cm or m, in [m].
inline double MetresIn(std::string_view unit) { return unit == "mm" ? 1e-3 : unit == "cm" ? 1e-2 : 1; }

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_UNITS_H_
