// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "study/merge.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/descriptor.h"
#include "base/error.h"

namespace ada::study {

namespace {

/// Shards that all parts together hold. A study of all its captures is no shard, and goes with
/// parts of any deal.
struct Dealt {
  std::optional<Setup> setup;
  std::set<int> shards;

  void add(const Database &part) {
    const Setup its = part.setup();
    if (setup && its.diagnose != setup->diagnose)
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                  part.path() + ": only some of the parts were made with the diagnosis");
    if (setup && std::min(its.shards, setup->shards) > 1 && its.shards != setup->shards)
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                  fmt::format("{}: dealt out to {} shards, and the parts before it to {}",
                              part.path(), its.shards, setup->shards));
    if (!setup || its.shards > 1)
      setup = its;
    const std::vector<int> of = part.shards();
    if (its.shards > 1)
      shards.insert(of.begin(), of.end());
    else if (of.empty())
      refuse_unlisted(part.path());
  }
  /// Where the captures that it was begun for are missed nowhere else.
  [[noreturn]] static void refuse_unlisted(const std::string &part) {
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                part + ": begun, and no capture is listed in it yet: run it again");
  }
  bool complete() const {
    return setup->shards == 1 || shards.size() == static_cast<std::size_t>(setup->shards);
  }
};

/// A file beside the target that becomes it, or vanishes.
class Draft {
public:
  explicit Draft(std::string target)
      : target_(std::move(target)), path_(target_ + "." + std::to_string(::getpid()) + ".tmp") {
    struct stat is {};
    if (::stat(target_.c_str(), &is) == 0 && !S_ISREG(is.st_mode)) // it would be gone
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, target_ + ": no place for a database: it is no "
                                                            "regular file");
    std::remove(path_.c_str());
  }
  Draft(const Draft &) = delete;
  Draft &operator=(const Draft &) = delete;
  ~Draft() { std::remove(path_.c_str()); }
  const std::string &path() const { return path_; }
  void commit() {
    {
      const Descriptor file(::open(path_.c_str(), O_RDWR | O_CLOEXEC));
      if (file.get() < 0 || ::fsync(file.get()) != 0)
        throw system_error(errno, target_, "cannot write");
    }
    if (std::rename(path_.c_str(), target_.c_str()) != 0)
      throw system_error(errno, target_, "cannot write");
    sync_folder(folder_of(target_));
  }

private:
  std::string target_, path_;
};

/// Parts that are open at a time: a process may have 1024 files open on most machines.
constexpr std::size_t kAtOnce = 128;

/// The rows of a few parts in the order of their names, one a name.
void merge_few(std::span<const std::string> parts, Database &out) {
  struct Source {
    std::unique_ptr<StudyReader> reader;
    std::optional<Row> row;
  };
  std::vector<Source> sources;
  for (const std::string &part : parts) {
    auto reader = std::make_unique<StudyReader>(part);
    std::optional<Row> first = reader->next();
    sources.push_back({std::move(reader), std::move(first)});
  }
  for (;;) {
    const std::string *least = nullptr;
    for (const Source &s : sources)
      if (s.row && (least == nullptr || s.row->capture < *least))
        least = &s.row->capture;
    if (least == nullptr)
      return;
    const std::string name = *least;
    std::optional<Row> best;
    for (Source &s : sources)
      while (s.row && s.row->capture == name) {
        if (!best || better(*s.row, *best))
          best = std::move(s.row);
        s.row = s.reader->next();
      }
    out.put(*best);
  }
}

/// The same of any number: so many at a time become parts themselves. What better() keeps does not
/// depend on who met whom first.
void merge_rows(std::span<const std::string> parts, const std::string &beside, Database &out) {
  if (parts.size() <= kAtOnce)
    return merge_few(parts, out);
  std::vector<std::unique_ptr<Draft>> drafts;
  std::vector<std::string> larger;
  for (std::size_t at = 0; at < parts.size(); at += kAtOnce) {
    drafts.push_back(std::make_unique<Draft>(fmt::format("{}.{}", beside, at)));
    larger.push_back(drafts.back()->path());
    Database part(larger.back(), out.setup(), false);
    merge_few(parts.subspan(at, std::min(kAtOnce, parts.size() - at)), part);
  }
  merge_rows(larger, beside + ".0", out);
}

} // namespace

void merge(const std::vector<std::string> &parts, const std::string &path) {
  Dealt dealt;
  std::vector<std::string> held, empty;
  for (const std::string &part : parts) {
    if (file_id(part) == file_id(path) && file_id(path))
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, path + ": a part cannot be the result, too");
    (Database::is_empty(part) ? empty : held).push_back(part);
  }
  for (const std::string &part : held)
    dealt.add(Database(part));
  // Of a shard among others it shows that it is missing.
  if (!empty.empty() && (!dealt.setup || dealt.setup->shards == 1))
    Dealt::refuse_unlisted(empty.front());
  // However it was dealt out: once all is there, that no longer shows.
  Setup whole{dealt.setup->diagnose, 1, 1};
  if (!dealt.complete())
    whole = {dealt.setup->diagnose, 0, dealt.setup->shards};
  Draft draft(follow_links(path));
  {
    Database out(draft.path(), whole, false);
    if (!dealt.complete())
      out.add_shards({dealt.shards.begin(), dealt.shards.end()});
    merge_rows(held, draft.path(), out);
  }
  draft.commit();
}

std::string missing(const Database &study) {
  std::string out;
  const std::vector<int> shards = study.shards();
  for (int shard = 1; shard <= study.setup().shards; ++shard)
    if (!std::binary_search(shards.begin(), shards.end(), shard))
      out += fmt::format("shard {} of {} is missing\n", shard, study.setup().shards);
  study.each([&out](const Row &row) {
    if (row.state == RowState::waiting)
      out += row.capture + " was not done\n";
  });
  return out;
}

} // namespace ada::study
