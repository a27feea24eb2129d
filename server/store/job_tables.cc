#include "server/store/job_tables.h"

#include <algorithm>
#include <array>

namespace fascicle::server {
namespace {

constexpr std::array<const char*, 5> kControlFormats = {
    // Format 1. The specification has its own table: it may be large, and an update of the job must not rewrite it.
    R"(CREATE TABLE jobs (
         id TEXT PRIMARY KEY NOT NULL,
         request_id TEXT UNIQUE,
         request_digest BLOB NOT NULL,
         scene_name TEXT NOT NULL,
         threads INTEGER NOT NULL,
         state INTEGER NOT NULL,
         failure BLOB NOT NULL,
         attempt INTEGER NOT NULL,
         generation INTEGER NOT NULL,
         create_time_us INTEGER NOT NULL,
         start_time_us INTEGER NOT NULL,
         end_time_us INTEGER NOT NULL,
         fraction REAL NOT NULL,
         time REAL NOT NULL,
         step INTEGER NOT NULL,
         frame_count INTEGER NOT NULL,
         stored_bytes INTEGER NOT NULL
       ) STRICT, WITHOUT ROWID;
       CREATE TABLE specs (
         job_id TEXT PRIMARY KEY NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
         spec BLOB NOT NULL
       ) STRICT;)",
    // Format 2.
    "ALTER TABLE jobs ADD COLUMN profile BLOB NOT NULL DEFAULT x''",
    // Format 3.
    "ALTER TABLE jobs ADD COLUMN warnings BLOB NOT NULL DEFAULT x''",
    // Format 4: crashes and checksums.
    R"(ALTER TABLE jobs ADD COLUMN crash_score INTEGER NOT NULL DEFAULT 0;
       ALTER TABLE jobs ADD COLUMN crash_place INTEGER NOT NULL DEFAULT -1;
       ALTER TABLE jobs ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
       UPDATE jobs SET checksum = row_checksum(id, request_id, request_digest, scene_name, threads, state, failure,
         attempt, generation, create_time_us, start_time_us, end_time_us, fraction, time, step, frame_count,
         stored_bytes, profile, warnings, crash_score, crash_place);
       ALTER TABLE specs ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
       UPDATE specs SET checksum = row_checksum(job_id, spec);)",
    // Format 5: owners, settings, revisions. Damaged rows stay damaged. Reading the other columns of `jobs` is slow
    // where profiles are large, so one index contains all columns by which jobs are found. `removals` remembers deleted
    // jobs; an empty id means that deletions up to this revision were forgotten.
    R"(UPDATE jobs SET checksum = -1 WHERE checksum IS NOT row_checksum(id, request_id, request_digest, scene_name,
         threads, state, failure, attempt, generation, create_time_us, start_time_us, end_time_us, fraction, time, step,
         frame_count, stored_bytes, profile, warnings, crash_score, crash_place);
       ALTER TABLE jobs ADD COLUMN owner TEXT NOT NULL DEFAULT '';
       ALTER TABLE jobs ADD COLUMN labels TEXT NOT NULL DEFAULT '';
       ALTER TABLE jobs ADD COLUMN priority INTEGER NOT NULL DEFAULT 0;
       ALTER TABLE jobs ADD COLUMN ttl_s INTEGER NOT NULL DEFAULT 0;
       ALTER TABLE jobs ADD COLUMN pinned INTEGER NOT NULL DEFAULT 0;
       ALTER TABLE jobs ADD COLUMN first_frame INTEGER NOT NULL DEFAULT 0;
       ALTER TABLE jobs ADD COLUMN revision INTEGER NOT NULL DEFAULT 0;
       UPDATE jobs SET revision = numbered.number FROM
         (SELECT id, row_number() OVER (ORDER BY id) AS number FROM jobs) AS numbered WHERE numbered.id = jobs.id;
       UPDATE jobs SET checksum = row_checksum(id, request_id, request_digest, scene_name, threads, state, failure,
         attempt, generation, create_time_us, start_time_us, end_time_us, fraction, time, step, frame_count,
         stored_bytes, profile, warnings, crash_score, crash_place, owner, labels, priority, ttl_s, pinned,
         first_frame, revision) WHERE checksum <> -1;
       CREATE INDEX jobs_by_owner ON jobs (owner, stored_bytes, state, scene_name, labels, create_time_us,
         start_time_us, end_time_us, priority, ttl_s, frame_count, pinned);
       CREATE INDEX jobs_by_revision ON jobs (revision);
       CREATE TABLE removals (
         revision INTEGER PRIMARY KEY NOT NULL,
         job_id TEXT NOT NULL,
         checksum INTEGER NOT NULL
       ) STRICT;)"};

constexpr std::string_view kColumns =
    "id, request_id, request_digest, scene_name, threads, state, failure, attempt, generation, create_time_us, "
    "start_time_us, end_time_us, fraction, time, step, frame_count, stored_bytes, profile, warnings, "
    "crash_score, crash_place, owner, labels, priority, ttl_s, pinned, first_frame, revision";

std::string Columns() { return std::string(kColumns); }
// The columns of a record, and whether they are intact.
std::string CheckedColumns() { return Columns() + ", " + JobChecksum() + " = jobs.checksum"; }
constexpr int kIntact = 28, kSpec = 29, kSpecIntact = 30;

// Labels as one text: a line feed, then KEY=VALUE and a line feed for each, in the order of the keys.
std::string LabelText(const std::map<std::string, std::string>& labels) {
  std::string text;
  for (const auto& [key, value] : labels) text += (text.empty() ? "\n" : "") + key + "=" + value + "\n";
  return text;
}

std::map<std::string, std::string> LabelsOf(std::string_view text) {
  std::map<std::string, std::string> labels;
  for (std::size_t begin = 1; begin < text.size();) {
    const std::size_t end = text.find('\n', begin), equals = text.find('=', begin);
    labels.emplace(text.substr(begin, equals - begin), text.substr(equals + 1, end - equals - 1));
    begin = end + 1;
  }
  return labels;
}

// Reads a record from CheckedColumns().
JobRecord ReadRecord(const Rows& row, const Database& database) {
  if (row.Int(kIntact) != 1) {
    throw DamageError(database.path() + ": the record of job " + row.String(0) + " is damaged");
  }
  JobRecord job;
  job.id = row.String(0);
  job.request_id = row.String(1);
  job.request_digest = row.String(2);
  job.scene_name = row.String(3);
  job.threads = static_cast<int>(row.Int(4));
  job.state = static_cast<JobState>(row.Int(5));
  job.failure = row.String(6);
  job.attempt = row.Int(7);
  job.generation = row.Int(8);
  job.create_time_us = row.Int(9);
  job.start_time_us = row.Int(10);
  job.end_time_us = row.Int(11);
  job.fraction = row.Real(12);
  job.time = row.Real(13);
  job.step = row.Int(14);
  job.frame_count = row.Int(15);
  job.stored_bytes = row.Int(16);
  job.profile = row.String(17);
  job.warnings = row.String(18);
  job.crash_score = row.Int(19);
  job.crash_place = row.Int(20);
  job.owner = row.String(21);
  job.labels = LabelsOf(row.Bytes(22));
  job.priority = static_cast<int>(row.Int(23));
  job.ttl_s = row.Int(24);
  job.is_pinned = row.Int(25) != 0;
  job.first_frame = row.Int(26);
  job.revision = row.Int(27);
  return job;
}

// The checksum is that of the values as they are stored.
std::string InsertSql(const std::string& schema) {
  std::string values;
  for (int i = 1; i <= kIntact; ++i) {
    const std::string value = "?" + std::to_string(i);
    values += (i == 1 ? "" : ", ") + (i == 2 ? "nullif(" + value + ", '')" : value);
  }
  return "INSERT INTO " + schema + ".jobs (" + Columns() + ", checksum) VALUES (" + values + ", row_checksum(" +
         values + "))";
}

// The column of a field, or what is equivalent to it.
std::string ColumnOf(JobField field) {
  switch (field) {
    case JobField::kId:
    case JobField::kLabel:
      return "id";
    case JobField::kState:
      return "state";
    case JobField::kOwner:
      return "owner";
    case JobField::kName:
      return "scene_name";
    case JobField::kCreated:
      return "create_time_us";
    case JobField::kStarted:
      return "start_time_us";
    case JobField::kEnded:
      return "end_time_us";
    case JobField::kPriority:
      return "priority";
    case JobField::kStoredBytes:
      return "stored_bytes";
    case JobField::kFrames:
      return "frame_count";
    case JobField::kPinned:
      return "pinned";
    case JobField::kTtl:
      return "ttl_s";
    case JobField::kExpiry:
      return "(CASE WHEN end_time_us = 0 OR ttl_s = 0 THEN 0 ELSE end_time_us + 1000000 * ttl_s END)";
  }
  return "id";
}

const char* OperatorOf(JobCondition::Relation relation) {
  switch (relation) {
    case JobCondition::Relation::kEqual:
      return " = ?";
    case JobCondition::Relation::kNotEqual:
      return " <> ?";
    case JobCondition::Relation::kLess:
      return " < ?";
    case JobCondition::Relation::kLessOrEqual:
      return " <= ?";
    case JobCondition::Relation::kGreater:
      return " > ?";
    case JobCondition::Relation::kGreaterOrEqual:
      return " >= ?";
    case JobCondition::Relation::kContains:
      break;
  }
  return " = ?";
}

// A query as SQL, with its arguments in order.
class JobSelection {
 public:
  explicit JobSelection(const JobQuery& query) {
    const std::string direction = query.is_descending ? " DESC" : "";
    const std::string column = ColumnOf(query.order);
    const std::string order = " ORDER BY " + (column == "id" ? "" : column + direction + ", ") + "id" + direction;
    std::string where;
    for (const std::vector<JobCondition>& group : query.filter.groups) {
      std::string any;
      for (const JobCondition& condition : group) any += (any.empty() ? "" : " OR ") + Term(condition);
      where += (where.empty() ? "(" : " AND (") + any + ")";
    }
    if (query.after) where += (where.empty() ? "" : " AND ") + After(query, column);
    if (!where.empty()) where = " WHERE " + where;
    // The rows in the order of the table, or by the index that contains all columns of filters.
    const bool by_id = column == "id" && query.filter.groups.empty();
    sql_ = "SELECT " + CheckedColumns() + " FROM jobs WHERE id IN (SELECT id FROM jobs " +
           (by_id ? "" : "INDEXED BY jobs_by_owner") + where + order + " LIMIT " +
           std::to_string(std::max(query.limit, 0)) + ")" + order;
  }

  const std::string& sql() const { return sql_; }
  // A number, or text if there is one.
  struct Argument {
    std::int64_t number = 0;
    std::optional<std::string> text = {};
  };
  const std::vector<Argument>& arguments() const { return arguments_; }

 private:
  std::string Term(const JobCondition& condition) {
    const std::string term = PlainTerm(condition);
    return condition.is_negated ? "NOT (" + term + ")" : term;
  }

  std::string PlainTerm(const JobCondition& condition) {
    if (condition.field == JobField::kLabel) return LabelTerm(condition);
    const std::string column = ColumnOf(condition.field);
    if (!IsText(condition.field)) {
      arguments_.push_back({.number = condition.number});
      if (!MayBeAbsent(condition.field)) return column + OperatorOf(condition.relation);
      const bool passes_absent = condition.relation == JobCondition::Relation::kNotEqual;
      return "(" + column + OperatorOf(condition.relation) + (passes_absent ? " OR " : " AND ") + column +
             (passes_absent ? " = 0)" : " <> 0)");
    }
    arguments_.push_back({.text = condition.text});
    if (condition.relation == JobCondition::Relation::kContains) return "instr(" + column + ", ?) > 0";
    return column + OperatorOf(condition.relation);
  }

  // Labels are compared for equality only: the text of one is found in that of all.
  std::string LabelTerm(const JobCondition& condition) {
    const bool is_key = condition.relation == JobCondition::Relation::kContains;
    arguments_.push_back({.text = "\n" + condition.key + "=" + (is_key ? "" : condition.text + "\n")});
    const bool is_without = condition.relation == JobCondition::Relation::kNotEqual;
    return std::string("instr(labels, ?) ") + (is_without ? "= 0" : "> 0");
  }

  std::string After(const JobQuery& query, const std::string& column) {
    const std::string relation = query.is_descending ? "<" : ">";
    if (column != "id") {
      if (IsText(query.order)) arguments_.push_back({.text = query.after->text});
      if (!IsText(query.order)) arguments_.push_back({.number = query.after->number});
    }
    arguments_.push_back({.text = query.after->id});
    return column == "id" ? "id " + relation + " ?" : "(" + column + ", id) " + relation + " (?, ?)";
  }

  std::string sql_;
  std::vector<Argument> arguments_;
};

std::vector<std::string> TextsOf(Rows&& rows) {
  std::vector<std::string> texts;
  while (rows.Next()) texts.push_back(rows.String(0));
  return texts;
}

// Bit s for state s, so that a set of states is a single argument of a query.
std::int64_t MaskOf(const std::vector<JobState>& states) {
  std::int64_t mask = 0;
  for (JobState state : states) mask |= std::int64_t{1} << static_cast<int>(state);
  return states.empty() ? -1 : mask;
}

}  // namespace

std::span<const char* const> ControlFormats() { return kControlFormats; }

std::string JobChecksum() { return "row_checksum(" + Columns() + ")"; }

JobWriter::JobWriter(Database& database, const std::string& schema)
    : database_(database),
      find_request_(database.Prepare("SELECT id FROM " + schema + ".jobs WHERE request_id = ?")),
      insert_job_(database.Prepare(InsertSql(schema))),
      insert_spec_(database.Prepare("INSERT INTO " + schema +
                                    ".specs (job_id, spec, checksum) VALUES (?1, ?2, row_checksum(?1, ?2))")),
      is_intact_(database.Prepare("SELECT " + JobChecksum() + " = checksum FROM " + schema + ".jobs WHERE id = ?")),
      update_(database.Prepare(
          "UPDATE " + schema +
          ".jobs SET state = ?2, failure = ?3, attempt = ?4, generation = ?5, start_time_us = ?6, end_time_us = ?7, "
          "fraction = ?8, time = ?9, step = ?10, frame_count = ?11, stored_bytes = ?12, profile = ?13, warnings = ?14, "
          "crash_score = ?15, crash_place = ?16, first_frame = ?17, revision = ?18 WHERE id = ?1")),
      update_settings_(database.Prepare(
          "UPDATE " + schema +
          ".jobs SET labels = ?2, priority = ?3, ttl_s = ?4, pinned = ?5, revision = ?6 WHERE id = ?1")),
      renew_checksum_(database.Prepare("UPDATE " + schema + ".jobs SET checksum = " + JobChecksum() + " WHERE id = ?")),
      delete_(database.Prepare("DELETE FROM " + schema + ".jobs WHERE id = ?")),
      insert_removal_(database.Prepare("INSERT INTO " + schema +
                                       ".removals (revision, job_id, checksum) VALUES (?1, ?2, row_checksum(?1, ?2))")),
      forget_removals_(database.Prepare("DELETE FROM " + schema + ".removals WHERE revision <= ?")) {}

std::string JobWriter::FindRequest(std::string_view request_id) {
  Rows rows = find_request_.Query(request_id);
  return rows.Next() ? rows.String(0) : std::string();
}

void JobWriter::Insert(const JobRecord& job, std::int64_t revision) {
  insert_job_.Run(job.id, job.request_id, Blob{job.request_digest}, job.scene_name, job.threads,
                  static_cast<int>(job.state), Blob{job.failure}, job.attempt, job.generation, job.create_time_us,
                  job.start_time_us, job.end_time_us, job.fraction, job.time, job.step, job.frame_count,
                  job.stored_bytes, Blob{job.profile}, Blob{job.warnings}, job.crash_score, job.crash_place, job.owner,
                  LabelText(job.labels), job.priority, job.ttl_s, static_cast<int>(job.is_pinned), job.first_frame,
                  revision);
  insert_spec_.Run(job.id, Blob{job.spec});
}

bool JobWriter::IsThere(std::string_view id) {
  Rows rows = is_intact_.Query(id);
  if (!rows.Next()) return false;
  if (rows.Int(0) != 1) throw DamageError(database_.path() + ": the record of job " + std::string(id) + " is damaged");
  return true;
}

void JobWriter::Update(const JobRecord& job, std::int64_t revision) {
  if (!IsThere(job.id)) return;
  update_.Run(job.id, static_cast<int>(job.state), Blob{job.failure}, job.attempt, job.generation, job.start_time_us,
              job.end_time_us, job.fraction, job.time, job.step, job.frame_count, job.stored_bytes, Blob{job.profile},
              Blob{job.warnings}, job.crash_score, job.crash_place, job.first_frame, revision);
  renew_checksum_.Run(job.id);
}

bool JobWriter::UpdateSettings(const JobRecord& job, std::int64_t revision) {
  if (!IsThere(job.id)) return false;
  update_settings_.Run(job.id, LabelText(job.labels), job.priority, job.ttl_s, static_cast<int>(job.is_pinned),
                       revision);
  renew_checksum_.Run(job.id);
  return true;
}

bool JobWriter::Delete(std::string_view id, std::int64_t revision) {
  delete_.Run(id);
  if (database_.changes() == 0) return false;
  insert_removal_.Run(revision, id);
  return true;
}

void JobWriter::ForgetRemovals(std::int64_t revision) {
  forget_removals_.Run(revision);
  insert_removal_.Run(revision, std::string_view());
}

JobReader::JobReader(const std::string& path)
    : database_(path, Database::Mode::kReadOnly),
      get_(database_.Prepare("SELECT " + CheckedColumns() +
                             ", spec, row_checksum(job_id, spec) = specs.checksum "
                             "FROM jobs LEFT JOIN specs ON job_id = id WHERE id = ?")),
      find_request_(database_.Prepare("SELECT id FROM jobs WHERE request_id = ?")),
      list_(database_.Prepare("SELECT " + CheckedColumns() +
                              " FROM jobs WHERE (?1 = '' OR id < ?1) AND (?2 >> state) & 1 ORDER BY id DESC LIMIT ?3")),
      has_(database_.Prepare("SELECT 1 FROM jobs WHERE id = ?")),
      ids_(database_.Prepare("SELECT id FROM jobs NOT INDEXED")),
      stored_bytes_(database_.Prepare("SELECT ifnull(sum(stored_bytes), 0) FROM jobs INDEXED BY jobs_by_owner")),
      stored_bytes_of_(
          database_.Prepare("SELECT ifnull(sum(stored_bytes), 0) FROM jobs INDEXED BY jobs_by_owner WHERE owner = ?")),
      changed_(database_.Prepare("SELECT " + CheckedColumns() +
                                 " FROM jobs WHERE revision > ? AND revision <= ? ORDER BY revision LIMIT ?")),
      deleted_(database_.Prepare("SELECT job_id, revision, row_checksum(revision, job_id) = checksum FROM removals "
                                 "WHERE revision > ? AND revision <= ? ORDER BY revision LIMIT ?")) {}

std::optional<JobRecord> JobReader::Get(std::string_view id) {
  Rows rows = get_.Query(id);
  if (!rows.Next()) return std::nullopt;
  JobRecord job = ReadRecord(rows, database_);
  if (rows.Int(kSpecIntact) != 1) throw DamageError(database_.path() + ": the scene of job " + job.id + " is damaged");
  job.spec = rows.String(kSpec);
  return job;
}

std::optional<JobRecord> JobReader::FindRequest(std::string_view request_id) {
  const std::vector<std::string> ids = TextsOf(find_request_.Query(request_id));
  return ids.empty() ? std::nullopt : Get(ids.front());
}

std::vector<JobRecord> JobReader::List(int limit, std::string_view before_id, const std::vector<JobState>& states) {
  std::vector<JobRecord> jobs;
  Rows rows = list_.Query(before_id, MaskOf(states), limit < 0 ? 0 : limit);  // SQL: LIMIT < 0 is no limit
  while (rows.Next()) jobs.push_back(ReadRecord(rows, database_));
  return jobs;
}

std::vector<JobRecord> JobReader::Find(const JobQuery& query) {
  const JobSelection selection(query);
  Statement statement = database_.Prepare(selection.sql());
  int index = 0;
  for (const JobSelection::Argument& argument : selection.arguments()) {
    ++index;
    if (argument.text) {
      statement.Bind(index, std::string_view(*argument.text));
    } else {
      statement.Bind(index, argument.number);
    }
  }
  std::vector<JobRecord> jobs;
  Rows rows = statement.Query();
  while (rows.Next()) {
    jobs.push_back(ReadRecord(rows, database_));
    if (!query.filter.Passes(jobs.back())) throw DamageError(database_.path() + ": the index of jobs is damaged");
  }
  return jobs;
}

std::int64_t JobReader::StoredBytesOf(const std::optional<std::string>& owner) {
  Rows rows = owner ? stored_bytes_of_.Query(*owner) : stored_bytes_.Query();
  return rows.Next() ? rows.Int(0) : 0;
}

JobChanges JobReader::Changes(const ChangeRange& range) {
  // One moment for both tables: a job that is deleted in between would be in neither.
  database_.Execute("BEGIN");
  JobChanges changes;
  try {
    changes = ReadChanges(range);
  } catch (...) {
    database_.Execute("ROLLBACK");
    throw;
  }
  database_.Execute("COMMIT");
  return changes;
}

JobChanges JobReader::ReadChanges(const ChangeRange& range) {
  JobChanges changes;
  changes.revision = range.last;
  {
    Rows rows = changed_.Query(range.after, range.last, range.limit);
    while (rows.Next()) changes.changed.push_back(ReadRecord(rows, database_));
  }
  // Of the deletions, those before the last change that fits.
  if (static_cast<int>(changes.changed.size()) == range.limit) changes.revision = changes.changed.back().revision;
  Rows rows = deleted_.Query(range.deletions_after, changes.revision, range.limit);
  while (rows.Next()) {
    if (rows.Int(2) != 1) throw DamageError(database_.path() + ": the record of a deleted job is damaged");
    if (!rows.Bytes(0).empty()) changes.deleted.push_back(rows.String(0));
    if (static_cast<int>(changes.deleted.size()) == range.limit) changes.revision = rows.Int(1);
  }
  std::erase_if(changes.changed, [&](const JobRecord& job) { return job.revision > changes.revision; });
  return changes;
}

bool JobReader::Has(std::string_view id) { return has_.Query(id).Next(); }

std::vector<std::string> JobReader::Ids() { return TextsOf(ids_.Query()); }

}  // namespace fascicle::server
