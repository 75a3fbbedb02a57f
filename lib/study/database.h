// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The study as an SQLite database; docs/studies.md describes its tables, which scripts read.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/row.h"
#include "study/sqlite.h"

namespace ada::study {

/// What all rows of a study have in common.
struct Setup {
  bool diagnose = true;
  int shard = 1, shards = 1;
  bool operator==(const Setup &) const = default;
};

/// Which shard of `shards` a capture falls to, 1 to `shards`: by its name alone (FNV-1a), so that
/// every machine deals out alike.
int shard_of(const std::string &capture, int shards);

class Database {
public:
  /// Opens to read.
  explicit Database(const std::string &path);
  /// Opens to write; made where it is not there. Throws INVALID_ARGUMENT where it was made with
  /// another setup. `shared`: others may read while it is written (WAL); else it is a plain file.
  Database(const std::string &path, const Setup &setup, bool shared = true);
  Database(const Database &) = delete;
  Database &operator=(const Database &) = delete;
  ~Database();

  /// Whether the process that began this file was killed before it had made a study of it.
  static bool is_empty(const std::string &path);

  const std::string &path() const { return path_; }
  const Setup &setup() const { return setup_; }
  /// Shards of `setup().shards` that this study was merged from; for a part its own, once its
  /// captures are listed.
  std::vector<int> shards() const;
  void add_shards(const std::vector<int> &shards);

  /// New names become rows that wait; names of other shards are left out. Where one is refused a
  /// database that was made for them is no longer wanted.
  void list(const std::vector<std::string> &captures);
  /// Names to be done: waiting, or changed since; `again`: failed or done by another version, too.
  std::vector<std::string> waiting(bool again) const;
  /// Replaces the row of this capture.
  void put(const Row &row);
  /// Another one after any change, by whomever.
  std::pair<std::int64_t, std::int64_t> version() const;
  /// All rows, by name.
  void each(const std::function<void(const Row &)> &visit) const;

private:
  void make_tables();
  void hold_shard();
  [[noreturn]] void refuse_shard(int held, const Setup &wanted) const;
  void check_setup(const Setup &wanted);
  void read_setup();

  std::string path_;
  mutable Sqlite sqlite_;
  Setup setup_;
  bool shared_ = false;
  bool made_ = false, unwanted_ = false;
};

/// Rows of a study one by one, by name.
class RowCursor {
public:
  explicit RowCursor(Sqlite &sqlite);
  std::optional<Row> next();

private:
  void read_parts(Row &row, std::int64_t id);

  Statement rows_, factors_, checks_, findings_, quantities_;
};

/// Keeps its own database open.
class StudyReader {
public:
  explicit StudyReader(const std::string &path)
      : sqlite_(path, Sqlite::Mode::read), cursor_(sqlite_) {}
  std::optional<Row> next() { return cursor_.next(); }

private:
  Sqlite sqlite_;
  RowCursor cursor_;
};

} // namespace ada::study
