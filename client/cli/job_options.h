#ifndef FASCICLE_CLIENT_CLI_JOB_OPTIONS_H_
#define FASCICLE_CLIENT_CLI_JOB_OPTIONS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fascicle/v1/job.pb.h"

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

namespace fascicle::client {

// Settings of a job, as `submit` and `update` take them.
struct JobOptions {
  std::optional<int> priority;
  std::vector<std::string> labels;  // KEY=VALUE
  std::optional<std::int64_t> ttl;  // [s]
};

// Adds --priority, --label and --ttl. `options` must outlive parsing.
void AddJobOptions(CLI::App& command, JobOptions& options);

// Sets what is given; CommandError for a label without `=`.
void SetOptions(const JobOptions& options, v1::Job& job);

// The name of this user, in the characters of an owner.
std::string UserName();

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_JOB_OPTIONS_H_
