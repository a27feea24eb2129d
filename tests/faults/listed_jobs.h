#ifndef FASCICLE_TESTS_FAULTS_LISTED_JOBS_H_
#define FASCICLE_TESTS_FAULTS_LISTED_JOBS_H_

#include <string>
#include <vector>

#include "tests/support/service_fixture.h"

namespace fascicle::service_test {

// The names of all jobs, by pages.
inline std::vector<std::string> ListedJobs(Stubs& stubs) {
  std::vector<std::string> names;
  v1::ListJobsRequest page;
  page.set_page_size(1000);
  do {
    grpc::ClientContext context;
    v1::ListJobsResponse answer;
    const bool is_answered = stubs.jobs->ListJobs(&context, page, &answer).ok();
    EXPECT_TRUE(is_answered);
    if (!is_answered) break;
    for (const v1::Job& job : answer.jobs()) names.push_back(job.name());
    page.set_page_token(answer.next_page_token());
  } while (!page.page_token().empty());
  return names;
}

}  // namespace fascicle::service_test

#endif  // FASCICLE_TESTS_FAULTS_LISTED_JOBS_H_
