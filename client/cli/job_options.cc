#include "client/cli/job_options.h"

#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <string_view>

#include <CLI/CLI.hpp>

#include "client/cli/command.h"

namespace fascicle::client {

void AddJobOptions(CLI::App& command, JobOptions& options) {
  command.add_option("--priority", options.priority, "Higher ones are started first")->check(CLI::Range(-100, 100));
  command.add_option("--label", options.labels, "A word by which to find it again; may be repeated")
      ->type_name("KEY=VALUE");
  command.add_option("--ttl", options.ttl, "How long it is kept after its end, such as 12h or 7d; 0: the server's")
      ->type_name("TIME")
      ->transform(
          CLI::AsNumberWithUnit(std::map<std::string, std::int64_t>{{"s", 1}, {"m", 60}, {"h", 3600}, {"d", 86400}},
                                CLI::AsNumberWithUnit::CASE_SENSITIVE))
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{315'576'000}));
}

void SetOptions(const JobOptions& options, v1::Job& job) {
  if (options.priority) job.set_priority(*options.priority);
  if (options.ttl) job.mutable_ttl()->set_seconds(*options.ttl);
  for (const std::string& label : options.labels) {
    const std::size_t equals = label.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw CommandError::Invalid("--label " + label + " is not KEY=VALUE, such as --label study=knee");
    }
    (*job.mutable_labels())[label.substr(0, equals)] = label.substr(equals + 1);
  }
}

std::string UserName() {
  constexpr std::size_t kLongest = 64;
  const passwd* user = getpwuid(geteuid());
  std::string name = user == nullptr ? "" : user->pw_name;
  name.resize(std::min(name.size(), kLongest));
  for (char& c : name) {
    const bool is_allowed = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (!is_allowed && std::string_view("._@-").find(c) == std::string_view::npos) c = '_';
  }
  return name;
}

}  // namespace fascicle::client
