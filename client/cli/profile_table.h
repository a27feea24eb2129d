#ifndef FASCICLE_CLIENT_CLI_PROFILE_TABLE_H_
#define FASCICLE_CLIENT_CLI_PROFILE_TABLE_H_

#include "client/cli/command.h"
#include "fascicle/v1/job.pb.h"

namespace fascicle::client {

// Where the time of a job went, as a table on stdout: each stage with its calls, seconds and part of the whole, and
// what is left of a stage beside its parts. A line that says so for a job without profile.
void PrintProfile(const v1::Job& job);

// The same as an object; null for a job without profile.
Json ProfileJson(const v1::Job& job);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_PROFILE_TABLE_H_
