// SPDX-License-Identifier: MIT
// See history.h. Tables: run, answer (a case in a run), verdict and figure of an answer.
#include "reports/history.h"

#include <sqlite3.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "reports/files.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr int kApplicationId = 0x506c756d;  // "Plum": tells our databases from others (PRAGMA application_id)
constexpr int kSchema = 1;                  // PRAGMA user_version

constexpr const char* kTables = R"sql(
CREATE TABLE run (
  id INTEGER PRIMARY KEY, started TEXT NOT NULL, seed TEXT NOT NULL, commit_id TEXT NOT NULL, version TEXT NOT NULL,
  seconds REAL NOT NULL, cases INTEGER NOT NULL, passed INTEGER NOT NULL, failed INTEGER NOT NULL, errors INTEGER NOT NULL,
  skipped INTEGER NOT NULL, rays INTEGER NOT NULL, without_verdict INTEGER NOT NULL, unfinished INTEGER NOT NULL,
  UNIQUE (started, seed, commit_id));
CREATE TABLE answer (
  id INTEGER PRIMARY KEY, run_id INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE, name TEXT NOT NULL,
  status TEXT NOT NULL, rays INTEGER NOT NULL, seconds REAL NOT NULL, message TEXT NOT NULL, UNIQUE (run_id, name));
CREATE INDEX answer_by_name ON answer (name, run_id);
CREATE TABLE verdict (
  answer_id INTEGER NOT NULL REFERENCES answer (id) ON DELETE CASCADE, name TEXT NOT NULL, rays INTEGER NOT NULL,
  PRIMARY KEY (answer_id, name)) WITHOUT ROWID;
CREATE TABLE figure (
  answer_id INTEGER NOT NULL REFERENCES answer (id) ON DELETE CASCADE, position INTEGER NOT NULL, name TEXT NOT NULL,
  unit TEXT NOT NULL, value REAL, low REAL, high REAL, rounds INTEGER NOT NULL,
  PRIMARY KEY (answer_id, position)) WITHOUT ROWID;
)sql";

CaseStatus status_from(std::string_view name) {
  for (const CaseStatus status : {CaseStatus::passed, CaseStatus::failed, CaseStatus::skipped})
    if (name == status_name(status)) return status;
  return CaseStatus::error;
}

}  // namespace

struct History::Impl {
  fs::path file;
  sqlite3* database = nullptr;

  ~Impl() { sqlite3_close(database); }

  [[noreturn]] void refuse(int code) const {
    const std::string why = database ? sqlite3_errmsg(database) : sqlite3_errstr(code);
    switch (code & 0xff) {
      case SQLITE_NOTADB:
      case SQLITE_CORRUPT:
        throw InputError(file.string() + ": not a history, or damaged (" + why +
                         "); move it away and a new one is begun");
      case SQLITE_ERROR:
      case SQLITE_CONSTRAINT:
      case SQLITE_MISMATCH:
        throw InputError(file.string() + ": not as a history should be (" + why +
                         "); move it away and a new one is begun");
      default:
        throw EnvironmentError(file.string() + ": the history cannot be used: " + why);
    }
  }
  void check(int code) const {
    if (code != SQLITE_OK && code != SQLITE_ROW && code != SQLITE_DONE) refuse(code);
  }
  void execute(const char* sql) const { check(sqlite3_exec(database, sql, nullptr, nullptr, nullptr)); }
};

namespace {

/// A prepared statement: values are bound in order, rows are read in order.
class Statement {
 public:
  template <typename Impl>
  Statement(const Impl& impl, const char* sql) : check_([&impl](int code) { impl.check(code); }) {
    check_(sqlite3_prepare_v2(impl.database, sql, -1, &statement_, nullptr));
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(const std::string& text) {
    check_(sqlite3_bind_text64(statement_, ++bound_, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
    return *this;
  }
  Statement& bind(std::string_view text) { return bind(std::string(text)); }
  Statement& bind(double value) {  // NaN is stored as NULL by SQLite
    check_(sqlite3_bind_double(statement_, ++bound_, value));
    return *this;
  }
  Statement& bind(std::uint64_t value) {
    PLUMBLINE_ASSERT(value <= static_cast<std::uint64_t>(INT64_MAX));
    check_(sqlite3_bind_int64(statement_, ++bound_, static_cast<sqlite3_int64>(value)));
    return *this;
  }
  /// True: there is a row to read.
  bool step() {
    const int code = sqlite3_step(statement_);
    check_(code);
    read_ = 0;
    return code == SQLITE_ROW;
  }
  /// Runs the statement and makes it ready for the next values.
  void run() {
    step();
    check_(sqlite3_reset(statement_));
    bound_ = 0;
  }
  std::string text() {
    const int column = read_++;
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)))
                 : std::string();
  }
  std::uint64_t count() {
    return static_cast<std::uint64_t>(std::max<sqlite3_int64>(0, sqlite3_column_int64(statement_, read_++)));
  }
  double real() {
    const int column = read_++;
    if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::numeric_limits<double>::quiet_NaN();
    return sqlite3_column_double(statement_, column);
  }

 private:
  std::function<void(int)> check_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0, read_ = 0;
};

/// A time that lasted NaN seconds is no time: the tables want a number.
double number_or_zero(double value) { return value == value ? value : 0.0; }

}  // namespace

History::History(const fs::path& file) : impl_(std::make_unique<Impl>()) {
  impl_->file = file;
  make_folder(file.parent_path());
  std::error_code error;
  if (fs::is_directory(file, error)) throw InputError(file.string() + ": this is a folder, not a history file");
  const int code = sqlite3_open_v2(file.c_str(), &impl_->database,
                                   SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_EXRESCODE, nullptr);
  if (code != SQLITE_OK) impl_->refuse(code);
  sqlite3_busy_timeout(impl_->database, 10000);
  impl_->execute("PRAGMA foreign_keys = ON; BEGIN IMMEDIATE");
  const auto number = [&](const char* sql) {
    Statement statement(*impl_, sql);
    return statement.step() ? statement.count() : 0;
  };
  if (number("SELECT count(*) FROM sqlite_master") == 0) {
    impl_->execute(kTables);
    impl_->execute(("PRAGMA application_id = " + std::to_string(kApplicationId)).c_str());
    impl_->execute(("PRAGMA user_version = " + std::to_string(kSchema)).c_str());
  } else {
    if (number("PRAGMA application_id") != kApplicationId)
      throw InputError(file.string() + ": a database, but not a history of plumbline's; give another file");
    if (const auto version = number("PRAGMA user_version"); version != kSchema)
      throw InputError(file.string() + ": history of version " + std::to_string(version) +
                       ", this plumbline knows version " + std::to_string(kSchema) +
                       "; use the plumbline that wrote it, or give another file");
  }
  impl_->execute("COMMIT");
}

History::~History() = default;
History::History(History&&) noexcept = default;
History& History::operator=(History&&) noexcept = default;

void History::append_run(const RunRecord& run) {
  const RunSummary total = summarize(run);
  impl_->execute("BEGIN IMMEDIATE");
  try {
    Statement(*impl_, "DELETE FROM run WHERE started = ? AND seed = ? AND commit_id = ?")
        .bind(run.started)
        .bind(std::to_string(run.seed))
        .bind(run.commit)
        .run();
    Statement(
        *impl_,
        "INSERT INTO run (started, seed, commit_id, version, seconds, cases, passed, failed, errors, skipped, rays, "
        "without_verdict, unfinished) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .bind(run.started)
        .bind(std::to_string(run.seed))
        .bind(run.commit)
        .bind(run.version)
        .bind(number_or_zero(run.seconds))
        .bind(total.cases)
        .bind(total.passed)
        .bind(total.failed)
        .bind(total.errors)
        .bind(total.skipped)
        .bind(total.rays)
        .bind(total.without_verdict)
        .bind(total.unfinished)
        .run();
    const auto run_id = static_cast<std::uint64_t>(sqlite3_last_insert_rowid(impl_->database));
    Statement answer(*impl_,
                     "INSERT INTO answer (run_id, name, status, rays, seconds, message) VALUES (?, ?, ?, ?, ?, ?)");
    Statement verdict(*impl_, "INSERT INTO verdict (answer_id, name, rays) VALUES (?, ?, ?)");
    Statement figure(*impl_,
                     "INSERT INTO figure (answer_id, position, name, unit, value, low, high, rounds) "
                     "VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    for (const CaseRecord& record : run.cases) {
      answer.bind(run_id)
          .bind(record.name)
          .bind(status_name(outcome(record)))
          .bind(record.rays)
          .bind(number_or_zero(record.seconds))
          .bind(record.message)
          .run();
      const auto id = static_cast<std::uint64_t>(sqlite3_last_insert_rowid(impl_->database));
      for (const auto& [name, rays] : record.verdicts) verdict.bind(id).bind(name).bind(rays).run();
      std::uint64_t position = 0;
      for (const Figure& f : record.figures)
        figure.bind(id)
            .bind(position++)
            .bind(f.name)
            .bind(f.unit)
            .bind(f.value)
            .bind(f.low)
            .bind(f.high)
            .bind(static_cast<std::uint64_t>(std::max(0, f.rounds)))
            .run();
    }
    impl_->execute("COMMIT");
  } catch (...) {
    sqlite3_exec(impl_->database, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

std::vector<PastRun> History::last_runs(std::size_t count) const {
  std::vector<PastRun> runs;
  std::vector<std::uint64_t> ids;
  Statement query(
      *impl_,
      "SELECT id, started, version, commit_id, seed, seconds, cases, passed, failed, errors, skipped, rays, "
      "without_verdict, unfinished FROM run ORDER BY started DESC, id DESC LIMIT ?");
  query.bind(static_cast<std::uint64_t>(count));
  while (query.step()) {
    ids.push_back(query.count());
    PastRun& run = runs.emplace_back();
    run.started = query.text();
    run.version = query.text();
    run.commit = query.text();
    run.seed = std::strtoull(query.text().c_str(), nullptr, 10);
    run.seconds = query.real();
    RunSummary& total = run.summary;
    for (std::uint64_t* field : {&total.cases, &total.passed, &total.failed, &total.errors, &total.skipped, &total.rays,
                                 &total.without_verdict, &total.unfinished})
      *field = query.count();
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Statement verdicts(*impl_,
                       "SELECT verdict.name, sum(verdict.rays) FROM verdict JOIN answer ON answer.id = answer_id "
                       "WHERE run_id = ? GROUP BY verdict.name");
    verdicts.bind(ids[i]);
    while (verdicts.step()) {
      const std::string name = verdicts.text();
      runs[i].summary.verdicts[name] = verdicts.count();
    }
  }
  return runs;
}

std::vector<PastCase> History::last_answers(const std::string& case_name, std::size_t count) const {
  std::vector<PastCase> answers;
  Statement query(
      *impl_,
      "SELECT answer.id, started, status, answer.rays, answer.seconds, message FROM answer JOIN run ON run.id = run_id "
      "WHERE name = ? ORDER BY started DESC, run.id DESC LIMIT ?");
  query.bind(case_name).bind(static_cast<std::uint64_t>(count));
  while (query.step()) {
    const std::uint64_t id = query.count();
    PastCase& answer = answers.emplace_back();
    answer.started = query.text();
    answer.status = status_from(query.text());
    answer.rays = query.count();
    answer.seconds = query.real();
    answer.message = query.text();
    Statement verdicts(*impl_, "SELECT name, rays FROM verdict WHERE answer_id = ?");
    verdicts.bind(id);
    while (verdicts.step()) {
      const std::string name = verdicts.text();
      answer.verdicts[name] = verdicts.count();
    }
    Statement figures(*impl_,
                      "SELECT name, unit, value, low, high, rounds FROM figure WHERE answer_id = ? ORDER BY position");
    figures.bind(id);
    while (figures.step()) {
      Figure& figure = answer.figures.emplace_back();
      figure.name = figures.text();
      figure.unit = figures.text();
      figure.value = figures.real();
      figure.low = figures.real();
      figure.high = figures.real();
      figure.rounds = static_cast<int>(figures.count());
    }
  }
  return answers;
}

RunChanges History::changes_since_last(const RunRecord& run) const {
  RunChanges changes;
  const std::string seed = std::to_string(run.seed);
  constexpr const char* kNotThis = "NOT (started = ?1 AND seed = ?2 AND commit_id = ?3)";
  const auto bind_this = [&](Statement& statement) { statement.bind(run.started).bind(seed).bind(run.commit); };

  std::uint64_t last_id = 0;
  {
    Statement last(*impl_, (std::string("SELECT id, started FROM run WHERE ") + kNotThis +
                            " ORDER BY started DESC, id DESC LIMIT 1")
                               .c_str());
    bind_this(last);
    if (!last.step()) {
      changes.first_run = true;
      return changes;
    }
    last_id = last.count();
    changes.since = last.text();
  }

  // The last answer of each case that was one: a skipped case says nothing. Later rows replace earlier ones.
  std::map<std::string, bool> failed_before;
  std::set<std::string> ever;
  {
    Statement answers(*impl_, (std::string("SELECT name, status FROM answer JOIN run ON run.id = run_id WHERE ") +
                               kNotThis + " ORDER BY started, run.id")
                                  .c_str());
    bind_this(answers);
    while (answers.step()) {
      const std::string name = answers.text();
      const CaseStatus status = status_from(answers.text());
      ever.insert(name);
      if (status != CaseStatus::skipped) failed_before[name] = is_failure(status);
    }
  }
  std::set<std::string> now;
  for (const CaseRecord& record : run.cases) {
    now.insert(record.name);
    if (!ever.contains(record.name)) changes.new_cases.push_back(record.name);
    const auto before = failed_before.find(record.name);
    const bool failed = before != failed_before.end() && before->second;
    const bool passed = before != failed_before.end() && !before->second;
    const CaseStatus status = outcome(record);
    if (is_failure(status) && passed) changes.newly_failing.push_back(record.name);
    if (is_failure(status) && failed) changes.still_failing.push_back(record.name);
    if (status == CaseStatus::passed && failed) changes.newly_passing.push_back(record.name);
  }
  Statement last_cases(*impl_, "SELECT name FROM answer WHERE run_id = ? ORDER BY id");
  last_cases.bind(last_id);
  while (last_cases.step())
    if (const std::string name = last_cases.text(); !now.contains(name)) changes.gone_cases.push_back(name);
  return changes;
}

}  // namespace plumbline
