#include "server/store/job_query.h"

#include <algorithm>
#include <tuple>

#include "server/store/store.h"

namespace fascicle::server {
namespace {

using Relation = JobCondition::Relation;

template <class Value>
bool Compare(const Value& value, Relation relation, const Value& with) {
  switch (relation) {
    case Relation::kEqual:
      return value == with;
    case Relation::kNotEqual:
      return value != with;
    case Relation::kLess:
      return value < with;
    case Relation::kLessOrEqual:
      return value <= with;
    case Relation::kGreater:
      return value > with;
    case Relation::kGreaterOrEqual:
      return value >= with;
    case Relation::kContains:
      return false;
  }
  return false;
}

bool PassesText(const std::string& value, const JobCondition& condition) {
  if (condition.relation == Relation::kContains) return value.find(condition.text) != std::string::npos;
  return Compare(value, condition.relation, condition.text);
}

bool PassesLabel(const JobRecord& job, const JobCondition& condition) {
  const auto found = job.labels.find(condition.key);
  if (condition.relation == Relation::kContains) return found != job.labels.end();
  if (found == job.labels.end()) return condition.relation == Relation::kNotEqual;
  return Compare(found->second, condition.relation, condition.text);
}

bool Holds(const JobRecord& job, const JobCondition& condition) {
  if (condition.field == JobField::kLabel) return PassesLabel(job, condition);
  const JobPlace value = PlaceOf(job, condition.field);
  if (IsText(condition.field)) return PassesText(value.text, condition);
  if (MayBeAbsent(condition.field) && value.number == 0) return condition.relation == Relation::kNotEqual;
  return Compare(value.number, condition.relation, condition.number);
}

}  // namespace

bool JobCondition::Passes(const JobRecord& job) const { return Holds(job, *this) != is_negated; }

bool JobFilter::Passes(const JobRecord& job) const {
  return std::all_of(groups.begin(), groups.end(), [&](const std::vector<JobCondition>& group) {
    return std::any_of(group.begin(), group.end(),
                       [&](const JobCondition& condition) { return condition.Passes(job); });
  });
}

bool IsText(JobField field) {
  return field == JobField::kOwner || field == JobField::kName || field == JobField::kLabel;
}

bool MayBeAbsent(JobField field) {
  return field == JobField::kStarted || field == JobField::kEnded || field == JobField::kExpiry;
}

JobPlace PlaceOf(const JobRecord& job, JobField order) {
  switch (order) {
    case JobField::kId:
    case JobField::kLabel:
      return {.id = job.id};
    case JobField::kState:
      return {.number = static_cast<int>(job.state), .id = job.id};
    case JobField::kOwner:
      return {.text = job.owner, .id = job.id};
    case JobField::kName:
      return {.text = job.scene_name, .id = job.id};
    case JobField::kCreated:
      return {.number = job.create_time_us, .id = job.id};
    case JobField::kStarted:
      return {.number = job.start_time_us, .id = job.id};
    case JobField::kEnded:
      return {.number = job.end_time_us, .id = job.id};
    case JobField::kPriority:
      return {.number = job.priority, .id = job.id};
    case JobField::kStoredBytes:
      return {.number = job.stored_bytes, .id = job.id};
    case JobField::kFrames:
      return {.number = job.frame_count, .id = job.id};
    case JobField::kPinned:
      return {.number = job.is_pinned ? 1 : 0, .id = job.id};
    case JobField::kTtl:
      return {.number = job.ttl_s, .id = job.id};
    case JobField::kExpiry: {
      const bool has_expiry = job.end_time_us != 0 && job.ttl_s != 0;
      return {.number = has_expiry ? job.end_time_us + 1'000'000 * job.ttl_s : 0, .id = job.id};
    }
  }
  return {.id = job.id};
}

bool IsBefore(const JobQuery& query, const JobPlace& a, const JobPlace& b) {
  const auto less = [](const JobPlace& x, const JobPlace& y) {
    return std::tie(x.number, x.text, x.id) < std::tie(y.number, y.text, y.id);
  };
  return query.is_descending ? less(b, a) : less(a, b);
}

}  // namespace fascicle::server
