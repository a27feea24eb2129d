#ifndef FASCICLE_SERVER_STORE_JOB_QUERY_H_
#define FASCICLE_SERVER_STORE_JOB_QUERY_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fascicle::server {

struct JobRecord;

// Columns of jobs by which they can be selected and ordered.
enum class JobField {
  kId,
  kState,
  kOwner,
  kName,
  kLabel,
  kCreated,
  kStarted,
  kEnded,
  kPriority,
  kStoredBytes,
  kFrames,
  kPinned,
  kTtl,     // [s]; 0: none of its own
  kExpiry,  // when its own ttl ends [us]
};

// A comparison of a column with a value.
struct JobCondition {
  enum class Relation { kEqual, kNotEqual, kLess, kLessOrEqual, kGreater, kGreaterOrEqual, kContains };

  JobField field = JobField::kState;
  Relation relation = Relation::kEqual;
  std::int64_t number = 0;  // for fields that are numbers; times in us since the Unix epoch
  std::string text = {};    // for kOwner, kName and kLabel
  std::string key = {};     // of a label; with kContains, jobs that have the label pass
  bool is_negated = false;  // whether the others pass

  // Jobs without a value (a time that has not come, a label that is not there) pass kNotEqual only, unless negated.
  bool Passes(const JobRecord& job) const;
};

// Jobs that pass at least one condition of each group. Without groups all pass.
struct JobFilter {
  std::vector<std::vector<JobCondition>> groups;

  bool Passes(const JobRecord& job) const;
};

// A place in an ordered list: the value of the field by which it is ordered, and the id.
struct JobPlace {
  std::int64_t number = 0;
  std::string text = {};
  std::string id;
};

// A part of a list of jobs. Jobs with equal values are in the order of their ids, which descends with the values. kId
// is the order of creation.
struct JobQuery {
  JobFilter filter = {};
  JobField order = JobField::kId;
  bool is_descending = true;
  std::optional<JobPlace> after = {};  // absent: from the beginning
  int limit = 0;
};

// Whether a field is text rather than a number.
bool IsText(JobField field);
// Whether a number is absent where it is 0.
bool MayBeAbsent(JobField field);
// Where a job is in a list with this order.
JobPlace PlaceOf(const JobRecord& job, JobField order);
// Whether `a` is listed before `b`.
bool IsBefore(const JobQuery& query, const JobPlace& a, const JobPlace& b);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_JOB_QUERY_H_
