#ifndef FASCICLE_CLIENT_CLI_PROFILE_TABLE_H_
#define FASCICLE_CLIENT_CLI_PROFILE_TABLE_H_

#include "client/cli/command.h"
#include "fascicle/v1/job.pb.h"

namespace fascicle::client {

// Prints the profile of a job as a table: each stage with its calls, seconds and fraction of the whole, and the time of
// a stage outside of its parts. For a job without a profile, prints a line that says so.
void PrintProfile(const v1::Job& job);

// The same as an object; null for a job without a profile.
Json ProfileJson(const v1::Job& job);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_PROFILE_TABLE_H_
