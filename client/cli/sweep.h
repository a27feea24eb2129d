#ifndef FASCICLE_CLIENT_CLI_SWEEP_H_
#define FASCICLE_CLIENT_CLI_SWEEP_H_

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

namespace fascicle::client {

// One scene of a sweep: settings as of --set.
using SweepPoint = std::vector<std::string>;

// Adds --sweep to a sub-command. `sweeps` must outlive parsing.
void AddSweepOption(CLI::App& command, std::vector<std::string>& sweeps);

// All combinations of the values of sweeps (PATH=[VALUE, ...]), where the last sweep varies fastest; one point without
// settings if there are none. CommandError for a sweep that is not such, and for more than 10,000 combinations.
std::vector<SweepPoint> PointsOf(const std::vector<std::string>& sweeps);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_SWEEP_H_
