// SPDX-License-Identifier: MIT
// An SQLite file and its statements, with errors that say what to do. The only file that names SQLite's interface is
// database.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct sqlite3_stmt;

namespace plumbline {

/// Owns an open database. Everything throws InputError where the file is damaged or not as its reader expects, and
/// EnvironmentError where the disk refuses or another program holds it for more than ten seconds.
class Database {
 public:
  /// Opens `file`, or makes it (and its folder) where it is missing.
  explicit Database(const std::filesystem::path& file);
  ~Database();
  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;

  const std::filesystem::path& file() const;
  /// Runs statements that answer nothing.
  void execute(const std::string& sql) const;
  /// The first value that a query answers; 0 where it answers none.
  std::uint64_t number(const std::string& sql) const;
  /// Of the row that was inserted last.
  std::uint64_t last_row() const;

 private:
  friend class Statement;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All or nothing: what is not committed when this goes is undone.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  const Database& database_;
  bool open_ = true;
};

/// A prepared statement: values are bound in order, columns are read in order.
class Statement {
 public:
  Statement(const Database& database, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(std::string_view text);
  Statement& bind(double value);  ///< NaN is stored as NULL
  Statement& bind(std::uint64_t value);
  bool step();  ///< true: there is a row to read
  void run();   ///< to its end; the statement is ready for the next values
  std::string text();
  std::uint64_t count();  ///< what is below 0 reads as 0
  double real();          ///< NULL reads as NaN

 private:
  const Database::Impl& impl_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0, read_ = 0;
};

}  // namespace plumbline
