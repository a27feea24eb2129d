#include "server/rpc/job_filter.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <google/protobuf/util/time_util.h>

#include "core/base/letters.h"
#include "fascicle/v1/job.pb.h"

namespace fascicle::server {
namespace {

using Relation = JobCondition::Relation;

constexpr std::size_t kLongestFilter = 2000;
constexpr int kMostComparisons = 32;

enum class Kind { kState, kText, kTime, kAge, kNumber, kSize, kFlag };

struct FieldName {
  std::string_view name;
  JobField field;
  Kind kind;
};

constexpr std::array<FieldName, 11> kFields = {{{"state", JobField::kState, Kind::kState},
                                                {"owner", JobField::kOwner, Kind::kText},
                                                {"name", JobField::kName, Kind::kText},
                                                {"created", JobField::kCreated, Kind::kTime},
                                                {"started", JobField::kStarted, Kind::kTime},
                                                {"ended", JobField::kEnded, Kind::kTime},
                                                {"age", JobField::kEnded, Kind::kAge},
                                                {"priority", JobField::kPriority, Kind::kNumber},
                                                {"size", JobField::kStoredBytes, Kind::kSize},
                                                {"frames", JobField::kFrames, Kind::kNumber},
                                                {"pinned", JobField::kPinned, Kind::kFlag}}};

constexpr std::string_view kFieldNames =
    "state, owner, name, labels.KEY, created, started, ended, age, priority, size, frames, pinned";

// A mistake at a character of the filter, counted from 0.
class FilterError : public std::runtime_error {
 public:
  FilterError(std::size_t where, const std::string& what, std::string the_hint = "")
      : std::runtime_error(what), at(where), hint(std::move(the_hint)) {}
  const std::size_t at;
  const std::string hint;
};

std::optional<std::int64_t> ParseInteger(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

struct Suffix {
  std::string_view text;
  std::int64_t factor;
};

// A number with one of several suffixes.
template <std::size_t kCount>
std::optional<std::int64_t> ParseWithSuffix(std::string_view text, const std::array<Suffix, kCount>& suffixes) {
  constexpr std::int64_t kMost = std::int64_t{1} << 62;
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  const std::optional<std::int64_t> number = ParseInteger(text.substr(0, digits));
  for (const Suffix& suffix : suffixes) {
    if (!number || text.substr(digits) != suffix.text) continue;
    if (*number > kMost / suffix.factor) return std::nullopt;
    return *number * suffix.factor;
  }
  return std::nullopt;
}

std::optional<std::int64_t> ParseSize(std::string_view text) {
  constexpr std::array<Suffix, 6> kSuffixes = {
      {{"", 1}, {"B", 1}, {"kB", 1000}, {"MB", 1'000'000}, {"GB", 1'000'000'000}, {"TB", 1'000'000'000'000}}};
  return ParseWithSuffix(text, kSuffixes);
}

// [us]
std::optional<std::int64_t> ParseDuration(std::string_view text) {
  constexpr std::int64_t kSecond = 1'000'000;
  constexpr std::array<Suffix, 4> kSuffixes = {
      {{"s", kSecond}, {"m", 60 * kSecond}, {"h", 3600 * kSecond}, {"d", 86400 * kSecond}}};
  const std::optional<std::int64_t> time = ParseWithSuffix(text, kSuffixes);
  constexpr std::int64_t kLongest = 3'000'000'000 * kSecond;  // about a century
  return time && *time <= kLongest ? time : std::nullopt;
}

// [us since the Unix epoch]
std::optional<std::int64_t> ParseTime(std::string_view text) {
  constexpr std::size_t kDate = 10;
  google::protobuf::Timestamp time;
  const std::string whole = std::string(text) + (text.size() == kDate ? "T00:00:00Z" : "");
  if (!google::protobuf::util::TimeUtil::FromString(whole, &time)) return std::nullopt;
  return google::protobuf::util::TimeUtil::TimestampToMicroseconds(time);
}

std::optional<std::int64_t> ParseState(std::string_view text) {
  std::string name = Lower(text);
  if (name.starts_with("state_")) name.erase(0, 6);
  for (int state = v1::Job::STATE_QUEUED; state <= v1::Job::State_MAX; ++state) {
    if (Lower(v1::Job::State_Name(static_cast<v1::Job::State>(state))) == "state_" + name) return state;
  }
  return std::nullopt;
}

// Ages grow as times get smaller.
Relation Reversed(Relation relation) {
  switch (relation) {
    case Relation::kLess:
      return Relation::kGreater;
    case Relation::kLessOrEqual:
      return Relation::kGreaterOrEqual;
    case Relation::kGreater:
      return Relation::kLess;
    case Relation::kGreaterOrEqual:
      return Relation::kLessOrEqual;
    default:
      return relation;
  }
}

class FilterParser {
 public:
  FilterParser(std::string_view text, std::int64_t now_us) : text_(text), now_us_(now_us) {}

  JobFilter Parse() {
    JobFilter filter;
    SkipSpace();
    if (IsAtEnd()) return filter;
    filter.groups.push_back(Group());
    while (!IsAtEnd()) {
      if (!TakeWord("AND")) {
        throw FilterError(at_, "AND or OR is expected here", "values with spaces need quotes: name=\"my muscle\"");
      }
      filter.groups.push_back(Group());
    }
    return filter;
  }

 private:
  // Comparisons joined by OR, where parentheses may be around several.
  std::vector<JobCondition> Group() {
    std::vector<JobCondition> conditions;
    do {
      if (Take('(')) {
        do {
          conditions.push_back(Term());
        } while (TakeWord("OR"));
        if (!Take(')')) {
          throw FilterError(at_, ") is expected here", "parentheses contain comparisons joined by OR only");
        }
      } else {
        conditions.push_back(Term());
      }
    } while (TakeWord("OR"));
    return conditions;
  }

  JobCondition Term() {
    const bool is_negated = TakeWord("NOT") || Take('-');
    if (++comparisons_ > kMostComparisons) {
      throw FilterError(at_, "there are more than " + std::to_string(kMostComparisons) + " comparisons");
    }
    JobCondition condition = Comparison();
    condition.is_negated = is_negated;
    return condition;
  }

  JobCondition Comparison() {
    const std::size_t begin = at_;
    const std::string_view name = TakeName();
    if (name.empty()) throw FilterError(begin, "a field is expected here", "one of " + std::string(kFieldNames));
    const std::size_t operator_at = at_;
    const Relation relation = TakeRelation();
    if (name == "labels") return LabelIsThere(operator_at, relation);
    if (name.starts_with("labels.")) return Label(name.substr(7), operator_at, relation);
    const auto* const known =
        std::find_if(kFields.begin(), kFields.end(), [&](const FieldName& field) { return field.name == name; });
    if (known == kFields.end()) {
      throw FilterError(begin, "there is no field " + std::string(name), "one of " + std::string(kFieldNames));
    }
    CheckRelation(*known, operator_at, relation);
    const std::size_t value_at = at_;
    return WithValue(*known, relation, TakeValue(), value_at);
  }

  JobCondition LabelIsThere(std::size_t operator_at, Relation relation) {
    if (relation != Relation::kContains) {
      throw FilterError(operator_at, "labels has the operator : only", "labels:KEY, or labels.KEY=VALUE");
    }
    return {.field = JobField::kLabel, .relation = relation, .key = TakeValue()};
  }

  JobCondition Label(std::string_view key, std::size_t operator_at, Relation relation) {
    if (relation != Relation::kEqual && relation != Relation::kNotEqual) {
      throw FilterError(operator_at, "a label has the operators = and != only");
    }
    return {.field = JobField::kLabel, .relation = relation, .text = TakeValue(), .key = std::string(key)};
  }

  static void CheckRelation(const FieldName& field, std::size_t at, Relation relation) {
    const bool is_equality = relation == Relation::kEqual || relation == Relation::kNotEqual;
    const std::string name(field.name);
    if (field.kind == Kind::kText && !is_equality && relation != Relation::kContains) {
      throw FilterError(at, name + " has the operators = != and : only");
    }
    if ((field.kind == Kind::kState || field.kind == Kind::kFlag) && !is_equality) {
      throw FilterError(at, name + " has the operators = and != only");
    }
    if (field.kind != Kind::kText && relation == Relation::kContains) {
      throw FilterError(at, name + " has no operator :", "one of = != < <= > >=");
    }
  }

  JobCondition WithValue(const FieldName& field, Relation relation, const std::string& value, std::size_t at) const {
    JobCondition condition = {.field = field.field, .relation = relation};
    std::optional<std::int64_t> number;
    const char* expected = "";
    switch (field.kind) {
      case Kind::kText:
        condition.text = value;
        return condition;
      case Kind::kState:
        number = ParseState(value);
        expected = "a state, such as QUEUED, RUNNING, PAUSED, SUCCEEDED, FAILED or CANCELLED";
        break;
      case Kind::kTime:
        number = ParseTime(value);
        expected = "a time, such as 2026-11-30 or 2026-11-30T08:15:00Z";
        break;
      case Kind::kAge:
        number = ParseDuration(value);
        if (number) number = now_us_ - *number;
        condition.relation = Reversed(relation);
        expected = "a time, such as 90s, 15m, 8h or 7d";
        break;
      case Kind::kNumber:
        number = ParseInteger(value);
        expected = "an integer";
        break;
      case Kind::kSize:
        number = ParseSize(value);
        expected = "a size, such as 500000, 20MB or 3GB";
        break;
      case Kind::kFlag:
        if (value == "true" || value == "false") number = value == "true" ? 1 : 0;
        expected = "true or false";
        break;
    }
    if (!number) throw FilterError(at, "\"" + value + "\" is not " + expected);
    condition.number = *number;
    return condition;
  }

  bool IsAtEnd() const { return at_ == text_.size(); }

  void SkipSpace() {
    while (!IsAtEnd() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
  }

  bool Take(char wanted) {
    if (IsAtEnd() || text_[at_] != wanted) return false;
    ++at_;
    SkipSpace();
    return true;
  }

  // In capitals, as a word of its own.
  bool TakeWord(std::string_view word) {
    const std::string_view rest = text_.substr(at_);
    if (!rest.starts_with(word)) return false;
    if (rest.size() > word.size() && std::string_view(" \t\n(").find(rest[word.size()]) == std::string_view::npos) {
      return false;
    }
    at_ += word.size();
    SkipSpace();
    return true;
  }

  std::string_view TakeName() {
    const std::size_t end = std::min(text_.find_first_of(" \t\n()=!<>:\"", at_), text_.size());
    const std::string_view name = text_.substr(at_, end - at_);
    at_ = end;
    SkipSpace();
    return name;
  }

  Relation TakeRelation() {
    constexpr std::array<std::pair<std::string_view, Relation>, 7> kOperators = {{{"!=", Relation::kNotEqual},
                                                                                  {"<=", Relation::kLessOrEqual},
                                                                                  {">=", Relation::kGreaterOrEqual},
                                                                                  {"=", Relation::kEqual},
                                                                                  {"<", Relation::kLess},
                                                                                  {">", Relation::kGreater},
                                                                                  {":", Relation::kContains}}};
    for (const auto& [name, relation] : kOperators) {
      if (!text_.substr(at_).starts_with(name)) continue;
      at_ += name.size();
      SkipSpace();
      return relation;
    }
    throw FilterError(at_, "an operator is expected here", "one of = != < <= > >= :");
  }

  std::string TakeValue() {
    const std::size_t begin = at_;
    std::string value;
    if (!IsAtEnd() && text_[at_] == '"') {
      value = TakeQuoted();
    } else {
      const std::size_t end = std::min(text_.find_first_of(" \t\n()\"", at_), text_.size());
      value = text_.substr(at_, end - at_);
      at_ = end;
      if (value.empty()) throw FilterError(begin, "a value is expected here", "an empty one is \"\"");
    }
    SkipSpace();
    return value;
  }

  std::string TakeQuoted() {
    const std::size_t begin = at_++;
    std::string value;
    while (!IsAtEnd() && text_[at_] != '"') {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      value += text_[at_++];
    }
    if (IsAtEnd()) throw FilterError(begin, "this quote has no end");
    ++at_;
    return value;
  }

  const std::string_view text_;
  const std::int64_t now_us_;
  std::size_t at_ = 0;
  int comparisons_ = 0;
};

}  // namespace

JobFilter ParseJobFilter(std::string_view text, std::int64_t now_us, Problems& problems) {
  if (text.size() > kLongestFilter) {
    problems.Add("filter", "is longer than " + std::to_string(kLongestFilter) + " bytes");
    return {};
  }
  try {
    return FilterParser(text, now_us).Parse();
  } catch (const FilterError& error) {
    problems.Add("filter", "at character " + std::to_string(error.at + 1) + ": " + error.what(), error.hint);
    return {};
  }
}

void ParseJobOrder(std::string_view text, JobQuery& query, Problems& problems) {
  constexpr std::array<std::pair<std::string_view, JobField>, 9> kOrders = {{{"created", JobField::kId},
                                                                             {"started", JobField::kStarted},
                                                                             {"ended", JobField::kEnded},
                                                                             {"priority", JobField::kPriority},
                                                                             {"size", JobField::kStoredBytes},
                                                                             {"frames", JobField::kFrames},
                                                                             {"owner", JobField::kOwner},
                                                                             {"name", JobField::kName},
                                                                             {"state", JobField::kState}}};
  if (text.empty()) text = "created desc";
  query.is_descending = text.ends_with(" desc");
  const std::string_view name = text.substr(0, text.find(' '));
  const bool is_plain = text == name || text.substr(name.size()) == " desc" || text.substr(name.size()) == " asc";
  for (const auto& [known, field] : kOrders) {
    if (!is_plain || known != name) continue;
    query.order = field;
    return;
  }
  problems.Add("order_by", "must be a field, or a field and ` desc`",
               "one of created, started, ended, priority, size, frames, owner, name, state");
}

}  // namespace fascicle::server
