// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <memory>
#include <string>
#include <vector>

#include "ada4571.h"
#include "capi/guard.h"
#include "study/analyse.h"
#include "study/database.h"
#include "study/merge.h"
#include "study/page.h"
#include "study/summary.h"

using namespace ada;
using namespace ada::capi;

namespace {

/// What a study says, and of which state of the database.
struct Reading {
  std::pair<std::int64_t, std::int64_t> version;
  study::Fleet fleet;
  study::Summary summary;
};

} // namespace

struct ada4571_study {
  study::Database database;
  bool writable;
  std::unique_ptr<Reading> reading{};
  std::vector<std::string> waiting{};
  std::string json{}, text{}, missing{};
};

struct ada4571_study_row {
  std::string text, reason;
};

namespace {

ada4571_study_row *new_row(const study::Row &row) {
  return new ada4571_study_row{study::row_to_text(row), row.reason};
}

void require_writable(const ada4571_study *study) {
  require(study, "study");
  if (!study->writable)
    throw Error(ADA4571_ERROR_STATE, study->database.path() + ": opened to be read only");
}

/// Text and page of one study are one reading: of many captures it takes minutes.
const Reading &read(ada4571_study *study) {
  const auto version = study->database.version();
  if (study->reading == nullptr || study->reading->version != version) {
    study->reading.reset();
    study::Fleet fleet = study::read_fleet(study->database);
    study::Summary summary = study::summarise(fleet);
    study->reading =
        std::make_unique<Reading>(Reading{version, std::move(fleet), std::move(summary)});
  }
  return *study->reading;
}

study::Setup setup_of(const ada4571_study_options &options) {
  if (options.shards < 1 || options.shard < 1 || options.shard > options.shards)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "a shard is one of 1 to the number of shards, not " +
                    std::to_string(options.shard) + " of " + std::to_string(options.shards));
  return {options.diagnose != 0, options.shard, options.shards};
}

} // namespace

extern "C" {

void ada4571_study_options_init(ada4571_study_options *options) {
  if (options != nullptr)
    *options = {sizeof *options, 1, 1, 1, nullptr, nullptr, nullptr};
}

ada4571_status ada4571_study_open(const char *path, const ada4571_study_options *options,
                                  ada4571_study **study) {
  return guard([&] {
    require(path, "path");
    require(study, "study");
    if (options == nullptr) {
      *study = new ada4571_study{study::Database(path), false};
      return;
    }
    require_struct(options, "options");
    *study = new ada4571_study{study::Database(path, setup_of(*options)), true};
  });
}

ada4571_status ada4571_study_list(ada4571_study *study, const char *const *captures, size_t count) {
  return guard([&] {
    require_writable(study);
    if (count > 0)
      require(captures, "captures");
    std::vector<std::string> names;
    for (size_t k = 0; k < count; ++k) {
      require(captures[k], "captures");
      names.emplace_back(captures[k]);
    }
    study->database.list(names);
  });
}

ada4571_status ada4571_study_find_waiting(ada4571_study *study, int again, size_t *count) {
  return guard([&] {
    require(study, "study");
    require(count, "count");
    study->waiting = study->database.waiting(again != 0);
    *count = study->waiting.size();
  });
}

const char *ada4571_study_waiting(const ada4571_study *study, size_t index) {
  return study != nullptr && index < study->waiting.size() ? study->waiting[index].c_str()
                                                           : nullptr;
}

ada4571_status ada4571_study_analyse(const char *capture, const ada4571_study_options *options,
                                     ada4571_study_row **row) {
  return guard([&] {
    require(capture, "capture");
    require(row, "row");
    require_struct(options, "options");
    study::AnalysisOptions how{options->diagnose != 0, text_or_empty(options->report_folder), {}};
    if (options->progress != nullptr)
      how.progress = [options](double fraction, const char *what) {
        if (options->progress(fraction, what, options->user) != 0)
          throw study::Stopped(ADA4571_ERROR_STATE, "the analysis was stopped");
      };
    *row = new_row(study::analyse(capture, how));
  });
}

ada4571_status ada4571_study_row_failed(const char *capture, const char *reason,
                                        ada4571_study_row **row) {
  return guard([&] {
    require(capture, "capture");
    require(reason, "reason");
    require(row, "row");
    *row = new_row(study::failed_row(capture, reason));
  });
}

const char *ada4571_study_row_text(const ada4571_study_row *row) {
  return row != nullptr ? row->text.c_str() : "";
}

const char *ada4571_study_row_reason(const ada4571_study_row *row) {
  return row != nullptr ? row->reason.c_str() : "";
}

void ada4571_study_row_free(ada4571_study_row *row) {
  delete row;
}

ada4571_status ada4571_study_put(ada4571_study *study, const char *row_text) {
  return guard([&] {
    require_writable(study);
    require(row_text, "row_text");
    study->database.put(study::row_from_text(row_text));
  });
}

ada4571_status ada4571_study_merge(const char *const *parts, size_t count, const char *path) {
  return guard([&] {
    require(path, "path");
    require(parts, "parts");
    std::vector<std::string> names;
    for (size_t k = 0; k < count; ++k) {
      require(parts[k], "parts");
      names.emplace_back(parts[k]);
    }
    if (names.empty())
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "there are no parts to merge");
    study::merge(names, path);
  });
}

const char *ada4571_study_missing(ada4571_study *study) {
  const ada4571_status status = guard([&] {
    require(study, "study");
    study->missing = study::missing(study->database);
  });
  return status == ADA4571_OK ? study->missing.c_str() : "";
}

ada4571_status ada4571_study_json(ada4571_study *study, const char **json) {
  return guard([&] {
    require(study, "study");
    require(json, "json");
    study->json = study::to_json(read(study).summary);
    *json = study->json.c_str();
  });
}

ada4571_status ada4571_study_text(ada4571_study *study, const char **text) {
  return guard([&] {
    require(study, "study");
    require(text, "text");
    study->text = study::to_text(read(study).summary);
    *text = study->text.c_str();
  });
}

ada4571_status ada4571_study_report(ada4571_study *study, const char *path) {
  return guard([&] {
    require(study, "study");
    require(path, "path");
    const Reading &r = read(study);
    study::write_page(r.summary, r.fleet, path);
  });
}

void ada4571_study_free(ada4571_study *study) {
  delete study;
}

} // extern "C"
