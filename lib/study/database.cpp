// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "study/database.h"

#include <charconv>
#include <cstdio>

#include <fmt/format.h>

#include "base/error.h"
#include "base/utf8.h"

namespace ada::study {

namespace {

// A table of names and numbers for each kind of thing, so that a query needs no knowledge of
// causes.
constexpr const char *kTables = R"sql(
CREATE TABLE study(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE shards(shard INTEGER PRIMARY KEY);
CREATE TABLE captures(id INTEGER PRIMARY KEY, capture TEXT NOT NULL UNIQUE, state TEXT NOT NULL,
  reason TEXT, serial TEXT, verdict TEXT, sound INTEGER, has_reference INTEGER, samples INTEGER,
  duration_s REAL, extended_angle_rms_deg REAL, bytes INTEGER, modified_ns INTEGER, identity TEXT,
  program TEXT, report TEXT, periods INTEGER, signature BLOB);
CREATE TABLE factors(capture_id INTEGER, key TEXT, value TEXT, PRIMARY KEY(capture_id, key))
  WITHOUT ROWID;
CREATE TABLE checks(capture_id INTEGER, place INTEGER, check_id TEXT, state TEXT, measured REAL,
  allowed REAL, unit TEXT, PRIMARY KEY(capture_id, place)) WITHOUT ROWID;
CREATE TABLE findings(capture_id INTEGER, place INTEGER, cause TEXT, alternatives TEXT,
  angle_rms_deg REAL, correctable INTEGER, PRIMARY KEY(capture_id, place)) WITHOUT ROWID;
CREATE TABLE parameters(capture_id INTEGER, place INTEGER, number INTEGER, cause TEXT,
  parameter TEXT, value REAL, std_error REAL, unit TEXT,
  PRIMARY KEY(capture_id, place, number)) WITHOUT ROWID;
)sql";
constexpr const char *kSchema = "ada4571-study-database/1";

const char *state_word(RowState state) {
  return state == RowState::done ? "done" : state == RowState::failed ? "failed" : "waiting";
}

std::string joined(const std::vector<std::string> &words) {
  std::string out;
  for (const std::string &word : words)
    out += (out.empty() ? "" : ",") + word;
  return out;
}

std::vector<std::string> split(const std::string &text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

int whole_number(const std::string &text) {
  int n = 0;
  std::from_chars(text.data(), text.data() + text.size(), n);
  return n;
}

} // namespace

int shard_of(const std::string &capture, int shards) {
  std::uint64_t hash = UINT64_C(14695981039346656037);
  for (const char c : capture)
    hash = (hash ^ static_cast<unsigned char>(c)) * UINT64_C(1099511628211);
  return 1 + static_cast<int>(hash % static_cast<std::uint64_t>(shards));
}

bool Database::is_empty(const std::string &path) {
  return Sqlite(path, Sqlite::Mode::read).is_empty();
}

Database::Database(const std::string &path) : path_(path), sqlite_(path, Sqlite::Mode::read) {
  read_setup();
}

Database::Database(const std::string &path, const Setup &setup, bool shared)
    : path_(path), sqlite_(path, Sqlite::Mode::write), setup_(setup), shared_(shared) {
  if (shared)
    sqlite_.share();
  else
    sqlite_.run("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF");
  if (!sqlite_.has_table("study"))
    make_tables();
  if (!made_)
    check_setup(setup);
  if (!shared) // made in one go, by one process, and nowhere before it is whole
    hold_shard();
}

Database::~Database() {
  try {
    if (shared_) // one plain file, which can be copied and read from anywhere
      sqlite_.run("PRAGMA busy_timeout = 0; PRAGMA journal_mode = DELETE");
  } catch (...) { // somebody is reading: then it stays as it is, which is as good
  }
  if (unwanted_)
    std::remove(path_.c_str());
}

void Database::make_tables() {
  Transaction all(sqlite_);
  if (sqlite_.has_table("study"))
    return; // by another process that was asked for the same shard, between the first look and this
  if (!sqlite_.is_empty())
    throw Error(ADA4571_ERROR_FORMAT, path_ + ": this is a database, but no study");
  sqlite_.run(kTables);
  Statement put(sqlite_, "INSERT INTO study VALUES(?, ?)");
  const auto set = [&put](std::string_view key, const std::string &value) {
    put.bind(1, key).bind(2, std::string_view(value)).run();
  };
  set("schema", kSchema);
  set("diagnose", setup_.diagnose ? "yes" : "no");
  set("shards", std::to_string(setup_.shards));
  all.commit();
  made_ = true;
}

/// Together with what the shard holds: a part whose captures were never listed does not pass for
/// one that has them.
void Database::hold_shard() {
  if (setup_.shard == 0)
    return;
  const std::vector<int> of = shards();
  if (of.empty())
    add_shards({setup_.shard});
  else if (of != std::vector<int>{setup_.shard}) // another process was first
    refuse_shard(of.size() == 1 ? of.front() : 0, setup_);
}

void Database::refuse_shard(int held, const Setup &wanted) const {
  throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
              fmt::format("{}: this study holds shard {} of {}, not {} of {}", path_, held,
                          setup_.shards, wanted.shard, wanted.shards));
}

void Database::read_setup() {
  if (!sqlite_.has_table("study"))
    throw Error(ADA4571_ERROR_FORMAT,
                path_ + (sqlite_.is_empty() ? ": a database with nothing in it yet"
                                            : ": this is a database, but no study"));
  Statement get(sqlite_, "SELECT key, value FROM study");
  std::string schema;
  while (get.step()) {
    const std::string key = get.text(0), value = get.text(1);
    if (key == "schema")
      schema = value;
    else if (key == "diagnose")
      setup_.diagnose = value == "yes";
    else if (key == "shards")
      setup_.shards = std::max(1, whole_number(value));
  }
  if (schema != kSchema)
    throw Error(
        ADA4571_ERROR_FORMAT,
        fmt::format("{}: its schema is '{}', and this program reads '{}'", path_, schema, kSchema));
  const std::vector<int> of = shards();
  setup_.shard = of.size() == 1 ? of.front() : 0;
}

void Database::check_setup(const Setup &wanted) {
  read_setup();
  if (setup_.diagnose != wanted.diagnose)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, path_ + ": this study was made " +
                                                    (setup_.diagnose ? "with" : "without") +
                                                    " the diagnosis; its rows would not compare");
  if (setup_.shards == wanted.shards && shards().empty())
    setup_.shard = wanted.shard; // begun, and nothing was listed yet
  if (setup_ != wanted)
    refuse_shard(setup_.shard, wanted);
}

std::vector<int> Database::shards() const {
  std::vector<int> out;
  Statement get(sqlite_, "SELECT shard FROM shards ORDER BY shard");
  while (get.step())
    out.push_back(static_cast<int>(get.integer(0)));
  return out;
}

void Database::add_shards(const std::vector<int> &shards) {
  Statement put(sqlite_, "INSERT OR IGNORE INTO shards VALUES(?)");
  for (const int shard : shards)
    put.bind(1, std::int64_t{shard}).run();
}

void Database::list(const std::vector<std::string> &captures) {
  for (const std::string &capture : captures)
    if (!is_utf8(capture)) {
      unwanted_ = made_;
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                  capture +
                      ": a study keeps names as text, and this one is not UTF-8: rename the file");
    }
  Transaction all(sqlite_);
  hold_shard();
  Statement put(sqlite_, "INSERT OR IGNORE INTO captures(capture, state) VALUES(?, 'waiting')");
  for (const std::string &capture : captures)
    if (shard_of(capture, setup_.shards) == setup_.shard)
      put.bind(1, std::string_view(capture)).run();
  all.commit();
  made_ = unwanted_ = false;
}

std::vector<std::string> Database::waiting(bool again) const {
  std::vector<std::string> out;
  Statement get(
      sqlite_, "SELECT capture, state, bytes, modified_ns, program FROM captures ORDER BY capture");
  while (get.step()) {
    const std::string capture = get.text(0), state = get.text(1);
    const FileStamp now = stamp_of(capture);
    const bool changed = get.integer(2) != now.bytes || get.integer(3) != now.modified_ns;
    if (state == "waiting" || changed ||
        (again && (state == "failed" || get.text(4) != ADA4571_VERSION_STRING)))
      out.push_back(capture);
  }
  return out;
}

void Database::put(const Row &row) {
  std::int64_t id = 0;
  Transaction all(sqlite_);
  hold_shard();
  {
    Statement old(sqlite_, "SELECT id FROM captures WHERE capture = ?");
    if (old.bind(1, std::string_view(row.capture)).step())
      id = old.integer(0);
  }
  if (id != 0)
    for (const char *table : {"factors", "checks", "findings", "parameters"})
      Statement(sqlite_, fmt::format("DELETE FROM {} WHERE capture_id = ?", table))
          .bind(1, id)
          .run();
  Statement put(sqlite_,
                "INSERT OR REPLACE INTO captures VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  if (id != 0)
    put.bind(1, id);
  put.bind(2, std::string_view(row.capture)).bind(3, std::string_view(state_word(row.state)));
  if (row.state != RowState::waiting)
    put.bind(4, std::string_view(row.reason))
        .bind(5, std::string_view(row.serial))
        .bind(6, std::string_view(row.verdict))
        .bind(7, std::int64_t{row.sound})
        .bind(8, std::int64_t{row.has_reference})
        .bind(9, row.samples)
        .bind(10, row.duration_s)
        .bind(11, row.extended_angle_rms_deg)
        .bind(12, row.bytes)
        .bind(13, row.modified_ns)
        .bind(14, std::string_view(row.identity))
        .bind(15, std::string_view(row.program))
        .bind(16, std::string_view(row.report))
        .bind(17, std::int64_t{row.signature.periods})
        .bind_blob(18, row.signature.values);
  put.run();
  id = id != 0 ? id : sqlite_.last_id();
  Statement factor(sqlite_, "INSERT OR REPLACE INTO factors VALUES(?,?,?)");
  for (const auto &[key, value] : row.factors)
    factor.bind(1, id).bind(2, std::string_view(key)).bind(3, std::string_view(value)).run();
  Statement check(sqlite_, "INSERT INTO checks VALUES(?,?,?,?,?,?,?)");
  for (std::size_t k = 0; k < row.checks.size(); ++k) {
    const CheckLine &c = row.checks[k];
    check.bind(1, id)
        .bind(2, static_cast<std::int64_t>(k))
        .bind(3, std::string_view(c.check))
        .bind(4, std::string_view(c.state))
        .bind(5, c.measured)
        .bind(6, c.limit)
        .bind(7, std::string_view(c.unit))
        .run();
  }
  Statement finding(sqlite_, "INSERT INTO findings VALUES(?,?,?,?,?,?)");
  for (std::size_t k = 0; k < row.findings.size(); ++k) {
    const FoundCause &f = row.findings[k];
    finding.bind(1, id)
        .bind(2, static_cast<std::int64_t>(k + 1))
        .bind(3, std::string_view(f.cause))
        .bind(4, std::string_view(joined(f.alternatives)))
        .bind(5, f.angle_rms_deg)
        .bind(6, std::int64_t{f.correctable})
        .run();
  }
  Statement parameter(sqlite_, "INSERT INTO parameters VALUES(?,?,?,?,?,?,?,?)");
  for (std::size_t k = 0; k < row.quantities.size(); ++k) {
    const Quantity &q = row.quantities[k];
    parameter.bind(1, id)
        .bind(2, std::int64_t{q.place})
        .bind(3, static_cast<std::int64_t>(k))
        .bind(4, std::string_view(q.cause))
        .bind(5, std::string_view(q.parameter))
        .bind(6, q.value)
        .bind(7, q.std_error)
        .bind(8, std::string_view(q.unit))
        .run();
  }
  all.commit();
  unwanted_ = false;
}

std::pair<std::int64_t, std::int64_t> Database::version() const {
  Statement get(sqlite_, "SELECT data_version, total_changes() FROM pragma_data_version");
  get.step();
  return {get.integer(0), get.integer(1)};
}

void Database::each(const std::function<void(const Row &)> &visit) const {
  RowCursor cursor(sqlite_);
  while (const std::optional<Row> row = cursor.next())
    visit(*row);
}

RowCursor::RowCursor(Sqlite &sqlite)
    : rows_(sqlite, "SELECT id, capture, state, reason, serial, verdict, sound, has_reference, "
                    "samples, duration_s, extended_angle_rms_deg, bytes, modified_ns, identity, "
                    "program, report, periods, signature FROM captures ORDER BY capture"),
      factors_(sqlite, "SELECT key, value FROM factors WHERE capture_id = ? ORDER BY key"),
      checks_(sqlite, "SELECT check_id, state, measured, allowed, unit FROM checks WHERE "
                      "capture_id = ? ORDER BY place"),
      findings_(sqlite, "SELECT cause, alternatives, angle_rms_deg, correctable FROM findings "
                        "WHERE capture_id = ? ORDER BY place"),
      quantities_(sqlite, "SELECT place, cause, parameter, unit, value, std_error FROM parameters "
                          "WHERE capture_id = ? ORDER BY place, number") {}

std::optional<Row> RowCursor::next() {
  if (!rows_.step())
    return std::nullopt;
  Row row;
  row.capture = rows_.text(1);
  const std::string state = rows_.text(2);
  row.state = state == "done"     ? RowState::done
              : state == "failed" ? RowState::failed
                                  : RowState::waiting;
  row.reason = rows_.text(3);
  row.serial = rows_.text(4);
  row.verdict = rows_.text(5);
  row.sound = rows_.integer(6) != 0;
  row.has_reference = rows_.integer(7) != 0;
  row.samples = rows_.integer(8);
  row.duration_s = rows_.number(9);
  row.extended_angle_rms_deg = rows_.number(10);
  row.bytes = rows_.integer(11);
  row.modified_ns = rows_.integer(12);
  row.identity = rows_.text(13);
  row.program = rows_.text(14);
  row.report = rows_.text(15);
  row.signature.periods = static_cast<int>(rows_.integer(16));
  rows_.numbers(17, row.signature.values);
  if (!row.signature.consistent())
    row.signature = {};
  if (row.state != RowState::waiting)
    read_parts(row, rows_.integer(0));
  return row;
}

void RowCursor::read_parts(Row &row, std::int64_t id) {
  for (factors_.bind(1, id); factors_.step();)
    row.factors.emplace_back(factors_.text(0), factors_.text(1));
  for (checks_.bind(1, id); checks_.step();)
    row.checks.push_back(
        {checks_.text(0), checks_.text(1), checks_.number(2), checks_.number(3), checks_.text(4)});
  for (findings_.bind(1, id); findings_.step();)
    row.findings.push_back({findings_.text(0), split(findings_.text(1)), findings_.number(2),
                            findings_.integer(3) != 0});
  for (quantities_.bind(1, id); quantities_.step();)
    row.quantities.push_back({static_cast<int>(quantities_.integer(0)), quantities_.text(1),
                              quantities_.text(2), quantities_.text(3), quantities_.number(4),
                              quantities_.number(5)});
  for (Statement *s : {&factors_, &checks_, &findings_, &quantities_})
    s->reset();
}

} // namespace ada::study
