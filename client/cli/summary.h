#ifndef FASCICLE_CLIENT_CLI_SUMMARY_H_
#define FASCICLE_CLIENT_CLI_SUMMARY_H_

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "fascicle/v1/job.pb.h"

namespace fascicle::client {

// The outcome of a job: state, frames, final, lowest and highest value of every series, notes on bodies.
Json SummaryJson(const Followed& followed);
// The same as a table on stdout; the failure and warnings, if any, with their advice.
void PrintSummary(const Followed& followed);

// 0, 1 or 4 for the job's final state; 0 while it is running.
int ExitCodeOf(const v1::Job& job);

// A job in the form in which `show`, `list`, `submit` and others print it.
Json JobJson(const v1::Job& job);
// The job as JSON, or its name and state as text, on stdout.
void PrintState(const v1::Job& job, bool json);
void PrintFailure(const v1::Failure& failure);
void PrintWarnings(const v1::Job& job);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_SUMMARY_H_
