// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The database: rows come back as they were put, parts become one file whatever their order.

#include <algorithm>
#include <barrier>
#include <filesystem>
#include <random>
#include <thread>

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/error.h"
#include "study/fleet_generator.h"
#include "study/merge.h"
#include "study/summary.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada::study {
namespace {

class DatabaseTest : public ::testing::Test {
protected:
  std::vector<Row> draw(int sensors) {
    test::Laws laws;
    laws.sensors = sensors;
    std::vector<Row> rows = generator.draw(laws);
    rows[1].state = RowState::failed;
    rows[1].reason = "a sentence, with \"quotes\"; and \xc3\xa4";
    rows[2].signature.periods = 1;
    rows[2].signature.values.assign(4 * rows[2].signature.series_size(), 0.125);
    rows[2].checks = {{"radius", "failed", 1.5, 1.2, "1"}};
    return rows;
  }
  std::vector<std::string> names(const std::vector<Row> &rows) {
    std::vector<std::string> out;
    for (const Row &row : rows)
      out.push_back(row.capture);
    return out;
  }
  /// Rows dealt out to `shards` parts; some twice.
  std::vector<std::string> parts(const std::vector<Row> &rows, int shards, const std::string &tag) {
    std::vector<std::string> out;
    for (int k = 1; k <= shards; ++k) {
      out.push_back(folder / (tag + std::to_string(k) + ".db"));
      Database part(out.back(), {true, k, shards});
      part.list(names(rows));
      std::vector<Row> mine = rows;
      std::erase_if(mine, [&](const Row &r) { return shard_of(r.capture, shards) != k; });
      std::shuffle(mine.begin(), mine.end(), rng);
      for (const Row &row : mine)
        part.put(row);
      if (!mine.empty())
        part.put(mine.front());
    }
    return out;
  }

  std::uint64_t seed = test::fresh_seed();
  test::FleetGenerator generator{seed};
  std::mt19937_64 rng{seed};
  test::TempFolder folder;
};

TEST_F(DatabaseTest, RowsComeBackAsTheyWerePut) {
  const std::vector<Row> rows = draw(20);
  const std::string path = parts(rows, 1, "whole")[0];
  std::vector<std::string> put, got;
  for (const Row &row : rows)
    put.push_back(row_to_text(row_from_text(row_to_text(row))));
  Database(path).each([&](const Row &row) { got.push_back(row_to_text(row)); });
  std::sort(put.begin(), put.end());
  std::sort(got.begin(), got.end());
  EXPECT_EQ(put, got);
}

TEST_F(DatabaseTest, MergedFilesAreTheSameByteForByte) {
  const std::vector<Row> rows = draw(60);
  const std::vector<std::string> one = parts(rows, 1, "one"), seven = parts(rows, 7, "seven");
  merge(one, folder / "a.db");
  std::vector<std::string> several = seven;
  several.push_back(seven[3]); // a shard that ran twice
  std::shuffle(several.begin(), several.end(), rng);
  merge(several, folder / "b.db");
  EXPECT_EQ(test::read_file(folder / "a.db"), test::read_file(folder / "b.db"));
  merge({folder / "a.db", folder / "b.db"}, folder / "c.db");
  EXPECT_EQ(test::read_file(folder / "a.db"), test::read_file(folder / "c.db"));
  EXPECT_EQ(missing(Database(folder / "b.db")), "");
  const auto json = [](const std::string &path) {
    return to_json(summarise(read_fleet(Database(path))));
  };
  EXPECT_EQ(json(one[0]), json(folder / "b.db"));
}

/// Fewer files than there are parts may be open while it lives.
class FewFiles {
public:
  explicit FewFiles(rlim_t most) {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit few{most, before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &few);
  }
  ~FewFiles() { setrlimit(RLIMIT_NOFILE, &before_); }

private:
  rlimit before_{};
};

TEST_F(DatabaseTest, MorePartsThanFilesMayBeOpenAreMergedToTheSameFile) {
  const std::vector<Row> rows = draw(40);
  merge(parts(rows, 1, "one"), folder / "a.db");
  std::vector<std::string> many = parts(rows, 7, "part");
  // Shards that were run again and again, each a file of its own.
  for (std::size_t k = 0; many.size() < 300; ++k) {
    many.push_back(folder / ("again" + std::to_string(k) + ".db"));
    std::filesystem::copy_file(many[k % 7], many.back());
  }
  std::shuffle(many.begin(), many.end(), rng);
  {
    const FewFiles few(200);
    merge(many, folder / "b.db");
  }
  EXPECT_EQ(test::read_file(folder / "a.db"), test::read_file(folder / "b.db"));
  for (const auto &entry : std::filesystem::directory_iterator(folder / ""))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
}

TEST_F(DatabaseTest, ANameThatIsNoTextIsRefusedAndNothingIsListed) {
  Database study(folder / "s.db", {false, 1, 1});
  for (const char *name : {"sch\xf6n.csv", "\xc3", "\xed\xa0\x80.csv", "\xc0\xaf.csv"}) {
    try {
      study.list({"good.csv", name});
      ADD_FAILURE() << "taken: " << name;
    } catch (const Error &e) {
      EXPECT_NE(std::string(e.what()).find("not UTF-8"), std::string::npos) << e.what();
    }
  }
  EXPECT_TRUE(study.waiting(false).empty());
  study.list({"good.csv", "sch\xc3\xb6n.csv", "\xf0\x9f\xa7\xb2.csv"});
  EXPECT_EQ(study.waiting(false).size(), 3u);
}

TEST_F(DatabaseTest, WhatIsMissingIsNamed) {
  const std::vector<Row> rows = draw(40);
  std::vector<std::string> some = parts(rows, 4, "part");
  some.erase(some.begin() + 2);
  {
    Database part(some[0], {true, 1, 4});
    std::string mine;
    for (int k = 0; mine.empty(); ++k)
      if (shard_of("late-" + std::to_string(k), 4) == 1)
        mine = "late-" + std::to_string(k);
    part.list({mine});
  }
  merge(some, folder / "merged.db");
  const std::string what = missing(Database(folder / "merged.db"));
  EXPECT_NE(what.find("shard 3 of 4 is missing"), std::string::npos) << what;
  EXPECT_NE(what.find("late-"), std::string::npos) << what;
  merge({folder / "merged.db", folder / "part3.db"}, folder / "whole.db");
  EXPECT_EQ(missing(Database(folder / "whole.db")).find("shard"), std::string::npos);
}

/// Runs it in a process of its own, which ends without a word: at once, or within `patience_s`.
template <class Work> void in_a_process_that_dies(Work work, double patience_s) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    work();
    ::_exit(0);
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(patience_s));
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
}

TEST_F(DatabaseTest, WhateverMomentATaskIsKilledAtTheMergeIsMadeAndNamesWhatIsLost) {
  const std::vector<Row> rows = draw(24);
  const std::vector<std::string> all = parts(rows, 4, "part");
  const std::string killed = folder / "killed.db";
  const auto begin = std::chrono::steady_clock::now();
  parts(rows, 1, "timed");
  const double whole_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  int empty = 0, partial = 0;
  for (int k = 0; k < 60; ++k) {
    for (const char *end : {"", "-wal", "-shm", "-journal"})
      std::filesystem::remove(killed + end);
    // Half of them while the file is begun.
    const double at_s = whole_s * std::uniform_real_distribution(0.0, k % 2 == 0 ? 1.0 : 0.1)(rng);
    in_a_process_that_dies(
        [&] {
          Database part(killed, {true, 1, 4});
          part.list(names(rows));
          for (const Row &row : rows)
            if (shard_of(row.capture, 4) == 1)
              part.put(row);
        },
        at_s);
    if (!std::filesystem::exists(killed))
      continue;
    const std::string merged = folder / "merged.db";
    ASSERT_NO_THROW(merge({killed, all[1], all[2], all[3]}, merged)) << "killed after " << at_s;
    const std::string lost = missing(Database(merged));
    std::size_t there = 0;
    Database(merged).each([&](const Row &row) { there += row.state != RowState::waiting; });
    if (lost.find("shard 1 of 4 is missing") != std::string::npos) {
      ++empty;
      continue;
    }
    partial += !lost.empty();
    EXPECT_EQ(there + static_cast<std::size_t>(std::count(lost.begin(), lost.end(), '\n')),
              rows.size())
        << lost;
  }
  RecordProperty("nothing_listed", empty);
  RecordProperty("some_done", partial);
}

TEST_F(DatabaseTest, WhatAKilledWriterLeftIsRolledBackByWhoReads) {
  const std::string path = folder / "s.db";
  std::vector<Row> rows = draw(40);
  {
    Database study(path, {true, 1, 1});
    study.list(names(rows));
    for (const Row &row : rows)
      study.put(row);
  }
  const std::string before = test::read_file(path);
  in_a_process_that_dies(
      [&] { // no room to keep the change in memory: half of it stands in the file
        Sqlite half(path, Sqlite::Mode::write);
        half.run("PRAGMA cache_size = 1; BEGIN; UPDATE captures SET report = hex(zeroblob(9000))");
        ::_exit(0);
      },
      1.0);
  ASSERT_TRUE(std::filesystem::exists(path + "-journal"));
  ASSERT_NE(test::read_file(path), before);
  std::size_t count = 0;
  Database(path).each([&](const Row &row) {
    ++count;
    EXPECT_NE(row.report.size(), 18000u);
  });
  EXPECT_EQ(count, rows.size());
}

TEST_F(DatabaseTest, AFileThatWasOnlyBegunIsAPartWithoutCaptures) {
  const std::vector<Row> rows = draw(24);
  const std::vector<std::string> all = parts(rows, 3, "part");
  const std::string bare = folder / "bare.db", tables = folder / "tables.db";
  Sqlite(bare, Sqlite::Mode::write).share();
  { Database(tables, {true, 2, 3}); }
  for (const std::string &begun : {bare, tables}) {
    merge({all[0], begun, all[2]}, folder / "merged.db");
    EXPECT_EQ(missing(Database(folder / "merged.db")), "shard 2 of 3 is missing\n");
    { // and it goes on from there
      Database part(begun, {true, 2, 3});
      part.list(names(rows));
    }
    EXPECT_EQ(Database(begun).shards(), std::vector<int>{2});
  }
  // Where nothing else would show it.
  const std::string whole = folder / "whole.db";
  { Database(whole, {true, 1, 1}); }
  EXPECT_THROW(merge({parts(rows, 1, "one")[0], whole}, folder / "none.db"), Error);
  EXPECT_THROW(merge({whole}, folder / "none.db"), Error);
}

TEST_F(DatabaseTest, AStudyOfAllItsCapturesGoesWithPartsOfAnyDeal) {
  const std::vector<Row> rows = draw(40);
  const std::vector<Row> monday(rows.begin(), rows.begin() + 25),
      tuesday(rows.begin() + 20, rows.end());
  merge(parts(rows, 1, "one"), folder / "one.db");
  merge(parts(monday, 3, "monday"), folder / "monday.db");
  std::vector<std::string> more = parts(tuesday, 5, "tuesday");
  more.push_back(folder / "monday.db");
  std::shuffle(more.begin(), more.end(), rng);
  merge(more, folder / "both.db");
  EXPECT_EQ(test::read_file(folder / "one.db"), test::read_file(folder / "both.db"));
  std::erase(more, folder / "tuesday2.db");
  merge(more, folder / "some.db");
  EXPECT_NE(missing(Database(folder / "some.db")).find("shard 2 of 5 is missing"),
            std::string::npos);
  more.push_back(folder / "monday1.db");
  EXPECT_THROW(merge(more, folder / "none.db"), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.db"));
}

TEST_F(DatabaseTest, SeveralThatBeginOneStudyAtOnceShareIt) {
  const std::vector<Row> rows = draw(8);
  for (int round = 0; round < 20; ++round) {
    const std::string path = folder / ("s" + std::to_string(round) + ".db");
    std::barrier begin(4);
    const auto run = [&] {
      begin.arrive_and_wait();
      try {
        Database study(path, {true, 1, 1});
        study.list(names(rows));
        for (const Row &row : rows)
          study.put(row);
      } catch (const std::exception &e) {
        ADD_FAILURE() << e.what();
      }
    };
    {
      std::vector<std::jthread> all;
      for (int k = 0; k < 4; ++k)
        all.emplace_back(run);
    }
    std::vector<std::string> got;
    Database(path).each([&](const Row &row) { got.push_back(row.capture); });
    EXPECT_EQ(got.size(), rows.size());
  }
}

TEST_F(DatabaseTest, ABetterRowWinsInEitherOrder) {
  Row failed = draw(3)[1], done = failed;
  done.state = RowState::done;
  failed.modified_ns = 10;
  EXPECT_TRUE(better(done, failed));
  EXPECT_FALSE(better(failed, done));
  Row younger = done;
  younger.modified_ns = 5;
  EXPECT_TRUE(better(younger, done));
}

TEST_F(DatabaseTest, ChangedFilesWaitAgain) {
  const std::string capture = folder / "capture.csv", path = folder / "study.db";
  test::write_file(capture, "x");
  Database study(path, {});
  study.list({capture, capture});
  EXPECT_EQ(study.waiting(false), std::vector<std::string>{capture});
  Row row = draw(3)[0];
  row.capture = capture;
  row.bytes = stamp_of(capture).bytes;
  row.modified_ns = stamp_of(capture).modified_ns;
  study.put(row);
  EXPECT_TRUE(study.waiting(false).empty());
  row.state = RowState::failed;
  study.put(row);
  EXPECT_TRUE(study.waiting(false).empty());
  EXPECT_EQ(study.waiting(true).size(), 1u);
  test::write_file(capture, "xy");
  EXPECT_EQ(study.waiting(false).size(), 1u);
}

TEST_F(DatabaseTest, AChangeByWhomeverIsAnotherVersion) {
  const std::vector<Row> rows = draw(3);
  const std::string path = parts(rows, 1, "s")[0];
  Database own(path, {}), other(path, {});
  const auto first = own.version();
  EXPECT_EQ(own.version(), first);
  own.put(rows[0]);
  const auto second = own.version();
  EXPECT_NE(second, first);
  other.put(rows[0]);
  EXPECT_NE(own.version(), second);
}

TEST_F(DatabaseTest, WhatIsKeptOfACaptureIsAFractionOfItsRow) {
  const std::vector<Row> rows = draw(1000);
  const auto used = [] { return static_cast<double>(mallinfo2().uordblks); };
  const double before = used();
  const std::vector<Row> copy = rows;
  const double whole = used() - before;
  if (!(whole > 0.0))
    GTEST_SKIP() << "the allocator of a sanitizer does not count";
  const Fleet fleet = make_fleet(rows, true);
  const double kept = used() - before - whole;
  EXPECT_LT(kept, 0.5 * whole) << kept / 1000.0 << " bytes a capture, of " << whole / 1000.0;
  EXPECT_EQ(fleet.rows.size(), rows.size());
}

TEST_F(DatabaseTest, RefusesWhatItIsNot) {
  test::write_file(folder / "text.db",
                   "no database at all, but long enough to be read as one.....");
  EXPECT_THROW(Database(folder / "text.db"), Error);
  EXPECT_THROW(Database(folder / "absent.db"), Error);
  { Sqlite(folder / "other.db", Sqlite::Mode::write).run("CREATE TABLE captures(x)"); }
  EXPECT_THROW(Database(folder / "other.db"), Error);
  EXPECT_THROW(Database(folder / "other.db", {}), Error);
  { Sqlite(folder / "people.db", Sqlite::Mode::write).run("CREATE TABLE people(x)"); }
  EXPECT_THROW(Database(folder / "people.db", {}), Error);
  { Database(folder / "whole.db", {}); }
  EXPECT_THROW(Database(folder / "whole.db", {true, 1, 2}), Error);
  EXPECT_THROW(Database(folder / "whole.db", {false, 1, 1}), Error);
  EXPECT_THROW(row_from_text("{}"), Error);
  EXPECT_THROW(row_from_text("not json"), Error);
}

TEST_F(DatabaseTest, ShardsShareTheNamesOutEvenly) {
  std::vector<int> count(8, 0);
  for (int k = 0; k < 8000; ++k)
    ++count[static_cast<std::size_t>(shard_of("captures/ring-" + std::to_string(k) + ".csv", 8) -
                                     1)];
  for (int c : count)
    EXPECT_NEAR(c, 1000, 6 * 30); // six standard deviations of a binomial count
}

} // namespace
} // namespace ada::study
