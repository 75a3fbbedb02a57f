// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "study/sqlite.h"

#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>
#include <vector>

#include <sqlite3.h>
#include <unistd.h>

#include "base/error.h"

namespace ada::study {

namespace {

/// Another process may hold the file for as long as it writes one row.
constexpr int kPatienceMs = 20000;

ada4571_status status_of(int code) {
  switch (code & 0xff) {
  case SQLITE_BUSY:
  case SQLITE_LOCKED:
    return ADA4571_ERROR_BUSY;
  case SQLITE_NOTADB:
  case SQLITE_CORRUPT:
  case SQLITE_ERROR: // a table that is not as it should be
  case SQLITE_MISMATCH:
    return ADA4571_ERROR_FORMAT;
  case SQLITE_NOMEM:
    return ADA4571_ERROR_NO_MEMORY;
  case SQLITE_PERM:
  case SQLITE_READONLY:
    return ADA4571_ERROR_PERMISSION;
  default:
    return ADA4571_ERROR_IO;
  }
}

} // namespace

void Sqlite::Close::operator()(sqlite3 *d) const noexcept {
  sqlite3_close(d);
}

void Statement::Finalize::operator()(sqlite3_stmt *s) const noexcept {
  sqlite3_finalize(s);
}

Sqlite::Sqlite(const std::string &path, Mode mode) : path_(path) {
  if (mode == Mode::read && ::access(path.c_str(), F_OK) != 0)
    throw Error(ADA4571_ERROR_NOT_FOUND, path + ": there is no such study");
  constexpr const char *kLook = "SELECT 1 FROM sqlite_master";
  open(mode == Mode::read ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  if (mode == Mode::write ||
      sqlite3_exec(database_.get(), kLook, nullptr, nullptr, nullptr) != SQLITE_READONLY_ROLLBACK)
    return; // any other failure comes again, where it is handled
  open(SQLITE_OPEN_READWRITE);
  run(kLook);
  run("PRAGMA query_only = 1");
}

void Sqlite::open(int flags) {
  sqlite3 *raw = nullptr;
  const int code = sqlite3_open_v2(path_.c_str(), &raw, flags, nullptr);
  database_.reset(raw);
  if (raw == nullptr)
    throw Error(ADA4571_ERROR_NO_MEMORY, "out of memory");
  if (code != SQLITE_OK)
    fail();
  sqlite3_extended_result_codes(raw, 1);
  sqlite3_busy_timeout(raw, kPatienceMs);
}

void Sqlite::fail() const {
  const int code = sqlite3_errcode(database_.get());
  if ((code & 0xff) == SQLITE_NOTADB)
    throw Error(ADA4571_ERROR_FORMAT, path_ + ": this is no study (no SQLite database)");
  throw Error(status_of(code), path_ + ": " + sqlite3_errmsg(database_.get()));
}

void Sqlite::run(const std::string &sql) {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    fail();
}

void Sqlite::share() {
  constexpr auto kPause = std::chrono::milliseconds(5);
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(kPatienceMs);
  while (sqlite3_exec(database_.get(), "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr) !=
         SQLITE_OK) {
    if (status_of(sqlite3_errcode(database_.get())) != ADA4571_ERROR_BUSY ||
        std::chrono::steady_clock::now() > until)
      fail();
    std::this_thread::sleep_for(kPause);
  }
  run("PRAGMA synchronous = NORMAL");
}

bool Sqlite::is_empty() {
  return !Statement(*this, "SELECT 1 FROM sqlite_master").step();
}

bool Sqlite::has_table(const std::string &name) {
  Statement s(*this, "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?");
  return s.bind(1, std::string_view(name)).step();
}

std::int64_t Sqlite::last_id() const {
  return sqlite3_last_insert_rowid(database_.get());
}

Statement::Statement(Sqlite &database, std::string_view sql) : database_(database) {
  sqlite3_stmt *raw = nullptr;
  if (sqlite3_prepare_v2(database.database_.get(), sql.data(), static_cast<int>(sql.size()), &raw,
                         nullptr) != SQLITE_OK)
    database_.fail();
  statement_.reset(raw);
}

Statement &Statement::bind(int place, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), place, value);
  return *this;
}

Statement &Statement::bind(int place, double value) {
  if (std::isfinite(value))
    sqlite3_bind_double(statement_.get(), place, value);
  else
    sqlite3_bind_null(statement_.get(), place);
  return *this;
}

Statement &Statement::bind(int place, std::string_view text) {
  sqlite3_bind_text64(statement_.get(), place, text.data(), text.size(), SQLITE_TRANSIENT,
                      SQLITE_UTF8);
  return *this;
}

Statement &Statement::bind_blob(int place, std::span<const double> values) {
  sqlite3_bind_blob64(statement_.get(), place, values.data(), values.size_bytes(),
                      SQLITE_TRANSIENT);
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE)
    database_.fail();
  return code == SQLITE_ROW;
}

void Statement::run() {
  step();
  reset();
}

void Statement::reset() {
  sqlite3_reset(statement_.get());
  sqlite3_clear_bindings(statement_.get());
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::number(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL
             ? std::numeric_limits<double>::quiet_NaN()
             : sqlite3_column_double(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const auto *text = reinterpret_cast<const char *>(sqlite3_column_text(statement_.get(), column));
  return text == nullptr ? std::string()
                         : std::string(text, static_cast<std::size_t>(
                                                 sqlite3_column_bytes(statement_.get(), column)));
}

std::span<const double> Statement::blob(int column) const {
  const void *data = sqlite3_column_blob(statement_.get(), column);
  const auto bytes = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  // SQLite aligns what it hands out to eight bytes.
  return data == nullptr ? std::span<const double>()
                         : std::span(static_cast<const double *>(data), bytes / sizeof(double));
}

Transaction::Transaction(Sqlite &database) : database_(database) {
  database_.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  try {
    if (open_)
      database_.run("ROLLBACK");
  } catch (...) { // the failure that led here is on its way already
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  open_ = false;
}

} // namespace ada::study
