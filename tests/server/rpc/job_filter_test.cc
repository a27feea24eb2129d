// Filters and orders of lists of jobs, as clients write them.
#include "server/rpc/job_filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <string>

#include "server/store/store.h"

namespace fascicle::server {
namespace {

constexpr std::int64_t kHour = 3'600'000'000;               // [us]
constexpr std::int64_t kNow = 1'764'500'000 * 1'000'000LL;  // 2025-11-30T10:53:20Z [us]

JobRecord Sample() {
  JobRecord job;
  job.id = "1";
  job.scene_name = "left knee";
  job.state = JobState::kFailed;
  job.owner = "ann";
  job.labels = {{"study", "knee"}, {"run", ""}};
  job.priority = -3;
  job.stored_bytes = 20'000'000;
  job.frame_count = 7;
  job.create_time_us = kNow - 30 * kHour;
  job.end_time_us = kNow - 25 * kHour;
  return job;
}

bool Passes(const std::string& filter, const JobRecord& job = Sample()) {
  Problems problems;
  const JobFilter parsed = ParseJobFilter(filter, kNow, problems);
  EXPECT_TRUE(problems.empty()) << filter << ": " << problems.ToString();
  return parsed.Passes(job);
}

TEST(JobFilter, ComparesEveryField) {
  for (const char* filter : {"",
                             "  ",
                             "state=FAILED",
                             "state=failed",
                             "state = STATE_FAILED",
                             "state!=RUNNING",
                             "owner=ann",
                             "owner!=bob",
                             "owner:nn",
                             "name=\"left knee\"",
                             "name:knee",
                             "labels.study=knee",
                             "labels.run=\"\"",
                             "labels.study!=hip",
                             "labels.none!=x",
                             "labels:study",
                             "NOT labels:none",
                             "-labels:none",
                             "priority<0",
                             "priority=-3",
                             "priority>=-3",
                             "size>=20MB",
                             "size<21000kB",
                             "size<1TB",
                             "frames=7",
                             "frames>6",
                             "pinned=false",
                             "pinned!=true",
                             "created>2025-11-29T04:00:00Z",
                             "created<2025-11-30",
                             "ended<=2025-11-29T09:53:20Z",
                             "age>1d",
                             "age>=25h",
                             "age<=25h",
                             "age<1501m",
                             "age>89999s",
                             "started!=2025-01-01",
                             "NOT started<2030-01-01",
                             "state=RUNNING OR owner=ann",
                             "owner=ann AND (state=RUNNING OR state=FAILED) AND age>1d",
                             "owner=ann OR owner=bob AND state=FAILED",
                             "(owner=bob OR owner=ann)"}) {
    EXPECT_TRUE(Passes(filter)) << filter;
  }
  for (const char* filter : {"state=RUNNING",
                             "NOT state=FAILED",
                             "owner=an",
                             "owner:x",
                             "name=knee",
                             "labels.study=kne",
                             "labels.none=x",
                             "labels:none",
                             "labels:stud",
                             "priority>-3",
                             "size>20MB",
                             "frames!=7",
                             "pinned=true",
                             "created>=2025-11-30",
                             "age>26h",
                             "age<25h",
                             "started<2030-01-01",
                             "started>2000-01-01",
                             "state=FAILED AND owner=bob",
                             "owner=ann OR owner=bob AND state=RUNNING",
                             "-owner=ann OR -age>1d"}) {
    EXPECT_FALSE(Passes(filter)) << filter;
  }
}

TEST(JobFilter, MistakesAreToldAtTheirPlace) {
  const auto mistake = [](const std::string& filter) {
    Problems problems;
    ParseJobFilter(filter, kNow, problems);
    EXPECT_EQ(problems.count(), 1u) << filter;
    return problems.ToString();
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(mistake("stat=FAILED"), HasSubstr("filter: at character 1: there is no field stat"));
  EXPECT_THAT(mistake("owner=ann AND state=BROKEN"), HasSubstr("at character 21: \"BROKEN\" is not a state"));
  EXPECT_THAT(mistake("owner"), HasSubstr("at character 6: an operator is expected"));
  EXPECT_THAT(mistake("owner="), HasSubstr("at character 7: a value is expected"));
  EXPECT_THAT(mistake("owner=ann bob"), HasSubstr("at character 11: AND or OR is expected"));
  EXPECT_THAT(mistake("owner=ann AND"), HasSubstr("at character 14: a field is expected"));
  EXPECT_THAT(mistake("name=\"left"), HasSubstr("at character 6: this quote has no end"));
  EXPECT_THAT(mistake("(owner=ann AND state=FAILED)"), HasSubstr("at character 12: ) is expected"));
  EXPECT_THAT(mistake("owner<ann"), HasSubstr("at character 6: owner has the operators"));
  EXPECT_THAT(mistake("age>7 d"), HasSubstr("at character 5: \"7\" is not a time"));
  EXPECT_THAT(mistake("age>99999999999999999999d"), HasSubstr("is not a time"));
  EXPECT_THAT(mistake("size>9000000000TB"), HasSubstr("is not a size"));
  EXPECT_THAT(mistake("created>yesterday"), HasSubstr("is not a time"));
  EXPECT_THAT(mistake("pinned=yes"), HasSubstr("true or false"));
  EXPECT_THAT(mistake("labels=x"), HasSubstr("at character 7: labels has the operator : only"));
  EXPECT_THAT(mistake("state:RUN"), HasSubstr("at character 6: state has the operators"));
  EXPECT_THAT(mistake("priority:3"), HasSubstr("at character 9: priority has no operator :"));
}

TEST(JobFilter, HostileFiltersCostNothing) {
  std::string many = "frames=1", deep(2000, '(');
  for (int i = 0; i < 150; ++i) many += " OR frames=1";
  const auto start = std::chrono::steady_clock::now();
  for (const std::string& filter :
       {many, deep, std::string(2001, ' '), std::string(5'000'000, 'x'), "name=\"" + std::string(1900, '\\'),
        "owner=" + std::string(1900, 'a'), std::string("owner=\0a", 8), std::string(1000, '-') + "a=b"}) {
    Problems problems;
    ParseJobFilter(filter, kNow, problems);
    EXPECT_LE(problems.count(), 1u);
  }
  // Whatever is written, the parser returns.
  std::mt19937 random(3);
  const std::string words[] = {"state", "=",  "FAILED",  " ", "AND", "OR", "NOT", "(",  ")",  "age",  ">",
                               "7d",    "\"", "labels.", "-", ":",   "\\", "x",   "!=", "\n", "\xff", "1e9"};
  for (int i = 0; i < 20'000; ++i) {
    std::string filter;
    for (int length = static_cast<int>(random() % 12); length >= 0; --length)
      filter += words[random() % std::size(words)];
    Problems problems;
    ParseJobFilter(filter, kNow, problems).Passes(Sample());
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(JobOrder, IsAFieldWithOrWithoutADirection) {
  JobQuery query;
  Problems problems;
  ParseJobOrder("", query, problems);
  EXPECT_EQ(query.order, JobField::kId);
  EXPECT_TRUE(query.is_descending);
  ParseJobOrder("size", query, problems);
  EXPECT_EQ(query.order, JobField::kStoredBytes);
  EXPECT_FALSE(query.is_descending);
  ParseJobOrder("ended desc", query, problems);
  EXPECT_EQ(query.order, JobField::kEnded);
  EXPECT_TRUE(query.is_descending);
  ParseJobOrder("owner asc", query, problems);
  EXPECT_FALSE(query.is_descending);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  for (const char* wrong : {"colour", "size down", "size  desc", " size", "desc", "size, owner", "labels.a", "id"}) {
    Problems found;
    ParseJobOrder(wrong, query, found);
    EXPECT_EQ(found.count(), 1u) << wrong;
  }
}

}  // namespace
}  // namespace fascicle::server
