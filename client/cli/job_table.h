#ifndef FASCICLE_CLIENT_CLI_JOB_TABLE_H_
#define FASCICLE_CLIENT_CLI_JOB_TABLE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "fascicle/v1/job.pb.h"

namespace fascicle::client {

// Prints jobs as lines of a table on stdout.
class JobTable {
 public:
  // Wide enough for these jobs, and for others with ids of usual length.
  explicit JobTable(const std::vector<v1::Job>& jobs);

  void PrintHead() const;
  void Print(const v1::Job& job) const;

 private:
  int name_width_ = 3;
  int owner_width_ = 5;
};

// "950 kB"; powers of 1000.
std::string SizeText(std::int64_t bytes);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_JOB_TABLE_H_
