// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <algorithm>
#include <array>
#include <charconv>
#include <climits>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sched.h>
#include <unistd.h>

#include "common/file_roles.h"
#include "common/handles.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/progress.h"
#include "common/verb.h"
#include "common/workers.h"

namespace cli {

namespace {

using Study = std::unique_ptr<ada4571_study, Freed<ada4571_study_free>>;
using StudyRow = std::unique_ptr<ada4571_study_row, Freed<ada4571_study_row_free>>;

constexpr std::size_t kMostRemarks = 20;

struct RunOptions {
  std::size_t jobs = 0;
  double limit_s = 600.0;
  std::string shard, list, output, reports, without;
  std::vector<std::string> captures;
  bool again = false;
};

/// "2/5"
void read_shard(const std::string &text, ada4571_study_options &options) {
  const char *end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, options.shard);
  const bool slash = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, options.shards) : first;
  if (!slash || second.ec != std::errc() || second.ptr != end || options.shard < 1 ||
      options.shard > options.shards)
    throw Failure(kWrongUsage, fmt::format("--shard takes K/N, K from 1 to N, not '{}'", text));
}

/// Refuses what is no list at all, a capture, say, before every line of it becomes a capture that
/// cannot be read. One name may be wrong, and some of many; not all.
void check_names(const std::string &list, const std::vector<std::string> &names) {
  constexpr std::ptrdiff_t kLookedAt = 100;
  const auto end = names.begin() + std::min(std::ssize(names), kLookedAt);
  const auto is_there = [](const std::string &name) { return access(name.c_str(), F_OK) == 0; };
  if (names.size() > 1 && std::none_of(names.begin(), end, is_there))
    throw Failure(kUnusable,
                  fmt::format("{}: this is no list of names: none of its first {} lines is the name "
                              "of a file",
                              list, end - names.begin()));
}

constexpr std::size_t kMostNames = 1'000'000; ///< a list may be a pipe without an end

/// A name a line.
std::vector<std::string> names_of(const std::string &list) {
  std::ifstream file;
  if (list != "-") {
    file.open(list);
    if (!file)
      throw Failure(kUnusable, fmt::format("{}: cannot read: {}", list, std::strerror(errno)));
  }
  std::istream &in = list == "-" ? std::cin : file;
  std::vector<std::string> names;
  std::array<char, PATH_MAX> part; // no name is longer
  while (in.getline(part.data(), part.size())) {
    std::string line = part.data();
    if (line.ends_with('\r'))
      line.pop_back();
    if (!line.empty())
      names.push_back(line);
    if (names.size() > kMostNames)
      throw Failure(kUnusable, fmt::format("{}: this is no list of names: there are more than {}",
                                           list == "-" ? "standard input" : list, kMostNames));
  }
  if (in.bad())
    throw Failure(kUnusable, list + ": cannot be read");
  if (!in.eof())
    throw Failure(kUnusable, list + ": this is no list of names: a line is longer than any name");
  check_names(list, names);
  return names;
}

/// Processors that this program may use, which a batch system may have limited.
std::size_t processors() {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) != 0)
    return 1;
  return static_cast<std::size_t>(std::max(1, CPU_COUNT(&set)));
}

std::string captures_words(std::size_t count) {
  return fmt::format("{} capture{}", count, count == 1 ? "" : "s");
}

/// A database is written at any place of its file.
void refuse_standard_output(const std::string &output) {
  if (output == "-")
    throw Failure(kWrongUsage, "--output: a study is a database, which needs a file with a name");
}

/// Before the first analysis, whose result would be lost without it.
void make_folder(const std::string &name) {
  std::error_code failed;
  std::filesystem::create_directories(name, failed);
  if (failed || access(name.c_str(), W_OK) != 0)
    throw Failure(kUnusable, fmt::format("{}: cannot hold reports: {}", name,
                                         failed ? failed.message() : std::strerror(errno)));
}

std::string time_words(double s) {
  if (s < 90.0)
    return fmt::format("{:.0f} s", s);
  return s < 5400.0 ? fmt::format("{:.0f} min", s / 60.0) : fmt::format("{:.1f} h", s / 3600.0);
}

/// How far it is, for a terminal, and how it went, at the end.
class Course {
public:
  explicit Course(std::size_t all) : all_(all) {}
  /// `why_not`: empty where it is done.
  void ended(std::string_view capture, const std::string &why_not) {
    ++done_;
    failed_ += why_not.empty() ? 0 : 1;
    if (!why_not.empty() && failed_ <= kMostRemarks) {
      progress_.clear();
      if (why_not.starts_with(capture)) // the file, with the line
        note("{}\n", why_not);
      else
        note("{}: {}\n", capture, why_not);
    }
    const double rate = static_cast<double>(done_) / seconds();
    progress_.show(static_cast<double>(done_) / static_cast<double>(all_),
                   fmt::format("{} of {}, {:.3g} a second, {} left, {} failed", done_,
                               captures_words(all_), rate, time_words(static_cast<double>(all_ - done_) / rate),
                               failed_));
  }
  void close(bool complete) {
    progress_.clear();
    note("{} in {}, {:.3g} a second, {} failed\n", captures_words(done_), time_words(seconds()),
         static_cast<double>(done_) / seconds(), failed_);
    if (!complete)
      note("stopped: not done yet: {}; the same command goes on with them\n",
           captures_words(all_ - done_));
  }

private:
  double seconds() const {
    return std::max(1e-3, std::chrono::duration<double>(Clock::now() - begin_).count());
  }
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
  std::size_t all_, done_ = 0, failed_ = 0;
  Progress progress_;
};

/// All captures that the command names.
std::vector<std::string> captures_of(const RunOptions &options) {
  std::vector<std::string> names = options.captures;
  if (!options.list.empty())
    for (std::string &name : names_of(options.list))
      names.push_back(std::move(name));
  return names;
}

void list_captures(const std::vector<std::string> &names, const Study &study) {
  std::vector<const char *> bare;
  for (const std::string &name : names)
    bare.push_back(name.c_str());
  check(ada4571_study_list(study.get(), bare.data(), bare.size()));
}

int run(const RunOptions &options) {
  auto wanted = initialised(ada4571_study_options_init);
  wanted.diagnose = options.without.empty();
  wanted.report_folder = options.reports.empty() ? nullptr : options.reports.c_str();
  if (!options.shard.empty())
    read_shard(options.shard, wanted);
  if (options.captures.empty() && options.list.empty() && access(options.output.c_str(), F_OK) != 0)
    throw Failure(kWrongUsage, "a new study needs captures, by name or by --list");
  FileRoles roles;
  roles.reads(options.list);
  for (const std::string &capture : options.captures)
    try {
      roles.reads(capture);
    } catch (const Failure &failure) {
      if (failure.exit_status() != kUnusable) // its row will say what is wrong with it
        throw;
    }
  refuse_standard_output(options.output);
  roles.writes(options.output);
  const std::vector<std::string> captures = captures_of(options); // before a study is made for them
  for (const std::string &capture : captures)
    refuse_redirection_into(capture);
  if (!options.reports.empty())
    make_folder(options.reports);
  const auto study = make_as_asked<Study>(ada4571_study_open, options.output.c_str(),
                                          static_cast<const ada4571_study_options *>(&wanted));
  list_captures(captures, study);
  std::size_t count = 0;
  check(ada4571_study_find_waiting(study.get(), options.again ? 1 : 0, &count));
  Course course(count);
  Work work;
  work.jobs = options.jobs > 0 ? options.jobs : processors();
  work.limit_s = options.limit_s;
  work.pieces = count;
  work.run = [&](std::size_t k) {
    ada4571_set_jobs(1); // of this process: the captures share the processors out
    const auto row = make<StudyRow>(ada4571_study_analyse, ada4571_study_waiting(study.get(), k),
                                    static_cast<const ada4571_study_options *>(&wanted));
    return std::string(ada4571_study_row_text(row.get()));
  };
  work.ended = [&](std::size_t k, const std::string &text, const std::string &why_not) {
    const char *name = ada4571_study_waiting(study.get(), k);
    if (why_not.empty()) {
      check(ada4571_study_put(study.get(), text.c_str()));
      course.ended(name, nlohmann::json::parse(text).value("reason", ""));
      return;
    }
    const auto row = make<StudyRow>(ada4571_study_row_failed, name,
                                    fmt::format("{}: {}", name, why_not).c_str());
    check(ada4571_study_put(study.get(), ada4571_study_row_text(row.get())));
    course.ended(name, ada4571_study_row_reason(row.get()));
  };
  const bool complete = work_through(work);
  course.close(complete);
  return complete ? kDone : kUnusable;
}

struct MergeOptions {
  std::string output;
  std::vector<std::string> parts;
};

int merge(const MergeOptions &options) {
  FileRoles roles;
  std::vector<const char *> parts;
  for (const std::string &part : options.parts) {
    roles.reads(part);
    parts.push_back(part.c_str());
  }
  refuse_standard_output(options.output);
  roles.writes(options.output);
  std::error_code none;
  if (const auto bytes = std::filesystem::file_size(options.output, none); !none && bytes > 0)
    make<Study>(ada4571_study_open, options.output.c_str(), // what is replaced is a study
                static_cast<const ada4571_study_options *>(nullptr));
  check(ada4571_study_merge(parts.data(), parts.size(), options.output.c_str()));
  const auto study = make<Study>(ada4571_study_open, options.output.c_str(),
                                 static_cast<const ada4571_study_options *>(nullptr));
  const std::string missing = ada4571_study_missing(study.get());
  remark(missing);
  return missing.empty() ? kDone : kUnusable;
}

struct ReportOptions {
  std::string study, page;
  bool json = false;
};

int report(const ReportOptions &options) {
  FileRoles().reads(options.study).writes("-").writes(options.page);
  const auto study = make<Study>(ada4571_study_open, options.study.c_str(),
                                 static_cast<const ada4571_study_options *>(nullptr));
  const char *result = "";
  check((options.json ? ada4571_study_json : ada4571_study_text)(study.get(), &result));
  const std::string_view text = result;
  print("{}{}", text, text.ends_with('\n') ? "" : "\n");
  // Last: whatever becomes of the page, the result is out.
  if (!options.page.empty())
    check(ada4571_study_report(study.get(), options.page.c_str()));
  return kDone;
}

void add_run(CLI::App &study, Action &action) {
  auto *verb = study.add_subcommand(
      "run", "check, calibrate and diagnose captures; restarted, it goes on where it stopped");
  auto options = std::make_shared<RunOptions>();
  verb->add_option("--jobs", options->jobs, "processes at once (default: all processors)")
      ->type_name("N")
      ->transform(whole(1, 4096));
  verb->add_option("--shard", options->shard,
                   "do only part K of N of the captures, for one machine of N")
      ->type_name("K/N");
  verb->add_option("--list", options->list, "names of captures, one a line; - for standard input")
      ->type_name("FILE");
  verb->add_option("--without", options->without,
                   "leave the diagnosis out: 20 to 500 times as fast, the ellipse and the tables "
                   "remain")
      ->type_name("STEP")
      ->transform(one_of({"diagnose"}));
  verb->add_option("--reports", options->reports, "folder for a page of each capture")
      ->type_name("FOLDER");
  verb->add_option("--limit", options->limit_s, "longest time of one capture, in s; 0 for none")
      ->capture_default_str()
      ->type_name("S")
      ->transform(from_zero("s"));
  verb->add_flag("--again", options->again,
                 "repeat captures that failed, or that another version of the program did");
  verb->add_option("-o,--output", options->output, "study, an SQLite database")
      ->type_name("STUDY.db")
      ->required();
  verb->add_option("CAPTURE", options->captures, "capture files")->type_name("...");
  example(*verb, "  iio-angle study run -o bench.db captures/*.csv\n"
                 "  find captures -name '*.sigmf-meta' >names\n"
                 "  iio-angle study run --shard 1/2 --list names -o part-1.db");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

void add_merge(CLI::App &study, Action &action) {
  auto *verb = study.add_subcommand("merge", "merge parts into one study, in any order");
  auto options = std::make_shared<MergeOptions>();
  verb->add_option("-o,--output", options->output, "study to write")
      ->type_name("STUDY.db")
      ->required();
  verb->add_option("PART", options->parts, "studies, of the shards or of other captures")
      ->type_name("...")
      ->required();
  example(*verb, "  iio-angle study merge -o bench.db part-1.db part-2.db\n"
                 "Exit status 1 when shards or captures are missing; they are named, and the study "
                 "of the others is written.");
  verb->callback([options, &action] { action = [options] { return merge(*options); }; });
}

void add_report(CLI::App &study, Action &action) {
  auto *verb = study.add_subcommand(
      "report", "what the captures have in common, what differs, what goes with what");
  auto options = std::make_shared<ReportOptions>();
  verb->add_flag("--json", options->json, "print JSON (ada4571-study/1) instead of text");
  verb->add_option("--report", options->page, "write one self-contained HTML page")
      ->transform(ends_in({".html", ".htm"}, "an HTML page"))
      ->type_name("FILE.html");
  verb->add_option("STUDY", options->study, "study, or a part of one")->type_name("")->required();
  example(*verb, "  iio-angle study report --report bench.html bench.db");
  verb->callback([options, &action] { action = [options] { return report(*options); }; });
}

} // namespace

void add_study(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("study", "many captures, many sensors, one answer");
  verb->require_subcommand(1);
  example(*verb, "  iio-angle study run -o bench.db captures/*.csv\n"
                 "  iio-angle study report --report bench.html bench.db");
  add_run(*verb, action);
  add_merge(*verb, action);
  add_report(*verb, action);
}

} // namespace cli
