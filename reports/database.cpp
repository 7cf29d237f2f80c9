// SPDX-License-Identifier: MIT
#include "reports/database.h"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>

#include "reports/files.h"
#include "scenes/error.h"

namespace plumbline {

namespace fs = std::filesystem;

struct Database::Impl {
  fs::path file;
  sqlite3* handle = nullptr;

  ~Impl() { sqlite3_close(handle); }

  [[noreturn]] void refuse(int code) const {
    const std::string why = handle ? sqlite3_errmsg(handle) : sqlite3_errstr(code);
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
};

Database::Database(const fs::path& file) : impl_(std::make_unique<Impl>()) {
  impl_->file = file;
  make_folder(file.parent_path());
  std::error_code error;
  if (fs::is_directory(file, error)) throw InputError(file.string() + ": this is a folder, not a history file");
  if (fs::exists(file, error) && !fs::is_regular_file(file, error))
    throw InputError(file.string() + ": a history is kept in a plain file, not in a device or a pipe");
  // SQLite takes a file of a few bytes for an empty one and writes over it.
  std::array<char, 16> begin{};
  std::ifstream in(file, std::ios::binary);
  if (in && in.peek() != std::ifstream::traits_type::eof()) {
    in.read(begin.data(), begin.size());
    if (std::string_view(begin.data(), begin.size()) != std::string_view("SQLite format 3\0", 16))
      impl_->refuse(SQLITE_NOTADB);
  }
  const int code = sqlite3_open_v2(file.c_str(), &impl_->handle,
                                   SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_EXRESCODE, nullptr);
  if (code != SQLITE_OK) impl_->refuse(code);
  sqlite3_busy_timeout(impl_->handle, 10000);
}

Database::~Database() = default;
Database::Database(Database&&) noexcept = default;
Database& Database::operator=(Database&&) noexcept = default;

const fs::path& Database::file() const { return impl_->file; }

void Database::execute(const std::string& sql) const {
  impl_->check(sqlite3_exec(impl_->handle, sql.c_str(), nullptr, nullptr, nullptr));
}

std::uint64_t Database::number(const std::string& sql) const {
  Statement statement(*this, sql);
  return statement.step() ? statement.count() : 0;
}

std::uint64_t Database::last_row() const {
  return static_cast<std::uint64_t>(sqlite3_last_insert_rowid(impl_->handle));
}

Transaction::Transaction(const Database& database) : database_(database) { database_.execute("BEGIN IMMEDIATE"); }

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.execute("ROLLBACK");
  } catch (const std::exception&) {  // SQLite has rolled back by itself; what went wrong is being thrown already
  }
}

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

Statement::Statement(const Database& database, const std::string& sql) : impl_(*database.impl_) {
  impl_.check(sqlite3_prepare_v2(impl_.handle, sql.c_str(), -1, &statement_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(statement_); }

Statement& Statement::bind(std::string_view text) {
  impl_.check(sqlite3_bind_text64(statement_, ++bound_, text.empty() ? "" : text.data(), text.size(), SQLITE_TRANSIENT,
                                  SQLITE_UTF8));
  return *this;
}

Statement& Statement::bind(double value) {
  impl_.check(sqlite3_bind_double(statement_, ++bound_, value));
  return *this;
}

Statement& Statement::bind(std::uint64_t value) {
  PLUMBLINE_ASSERT(value <= static_cast<std::uint64_t>(INT64_MAX));
  impl_.check(sqlite3_bind_int64(statement_, ++bound_, static_cast<sqlite3_int64>(value)));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  impl_.check(code);
  read_ = 0;
  return code == SQLITE_ROW;
}

void Statement::run() {
  while (step()) {
  }
  impl_.check(sqlite3_reset(statement_));
  bound_ = 0;
}

std::string Statement::text() {
  const int column = read_++;
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))) : std::string();
}

std::uint64_t Statement::count() {
  return static_cast<std::uint64_t>(std::max<sqlite3_int64>(0, sqlite3_column_int64(statement_, read_++)));
}

double Statement::real() {
  const int column = read_++;
  if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::numeric_limits<double>::quiet_NaN();
  return sqlite3_column_double(statement_, column);
}

}  // namespace plumbline
