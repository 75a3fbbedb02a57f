// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// SQLite as the study uses it. No type of sqlite3.h leaves this file's .cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace ada::study {

class Sqlite;

/// A prepared statement; bind from 1 on, columns from 0 on. NaN is NULL in both directions.
class Statement {
public:
  Statement(Sqlite &database, std::string_view sql);
  Statement &bind(int place, std::int64_t value);
  Statement &bind(int place, double value);
  Statement &bind(int place, std::string_view text);
  Statement &bind_blob(int place, std::span<const double> values);
  /// True while there is a row.
  bool step();
  /// For statements that give no row.
  void run();
  void reset();

  std::int64_t integer(int column) const;
  double number(int column) const;
  std::string text(int column) const;
  /// Appends the numbers of a blob to `out`.
  template <class Vector> void numbers(int column, Vector &out) const {
    const std::span<const double> from = blob(column);
    out.assign(from.begin(), from.end());
  }

private:
  std::span<const double> blob(int column) const;

  struct Finalize {
    void operator()(sqlite3_stmt *s) const noexcept;
  };
  Sqlite &database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

class Sqlite {
public:
  enum class Mode { read, write };
  /// Write: made where it is not there. Read: what a process that was killed had half written is
  /// rolled back first, for which SQLite asks to write. Throws Error as every method here does,
  /// with the file's name.
  Sqlite(const std::string &path, Mode mode);
  void run(const std::string &sql);
  /// For several processes at once: they read while one writes. To change over needs the file for
  /// oneself, for which SQLite does not wait when another changes it over at the same moment or gives
  /// it back: that is waited for here.
  void share();
  /// Whether there is no table at all: a process that was killed had got no further.
  bool is_empty();
  /// Whether there is a table of this name.
  bool has_table(const std::string &name);
  std::int64_t last_id() const;
  [[noreturn]] void fail() const;

private:
  friend class Statement;
  struct Close {
    void operator()(sqlite3 *d) const noexcept;
  };
  void open(int flags);

  std::string path_;
  std::unique_ptr<sqlite3, Close> database_;
};

/// BEGIN, and ROLLBACK where commit() was not reached.
class Transaction {
public:
  explicit Transaction(Sqlite &database);
  Transaction(const Transaction &) = delete;
  Transaction &operator=(const Transaction &) = delete;
  ~Transaction();
  void commit();

private:
  Sqlite &database_;
  bool open_ = true;
};

} // namespace ada::study
