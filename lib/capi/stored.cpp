// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <memory>
#include <string>
#include <vector>

#include "acquisition/config.h"
#include "capi/guard.h"

using namespace ada;
using namespace ada::capi;

namespace {

struct Entry {
  std::string name, path, problem;
  StoredConfig config;
};

Entry entry_of(const std::string &name) {
  return {name, find_config(name), "", load_config(name)};
}

/// In a list of all, one that cannot be used is no reason not to show the others.
Entry entry_or_problem(const std::string &name) {
  Entry entry{name, "", "", {}};
  try {
    entry.path = find_config(name);
    entry.config = load_config(name);
  } catch (const Error &e) {
    entry.problem = e.what();
  }
  return entry;
}

} // namespace

/// The strings of a list live in it.
struct ada4571_stored_list {
  std::vector<Entry> entries;
};

extern "C" {

void ada4571_stored_init(ada4571_stored *stored) {
  if (stored)
    *stored = {sizeof *stored, "", "", "", "", "", "", "", "", "", ""};
}

ada4571_status ada4571_stored_list_new(const char *name, ada4571_stored_list **list) {
  return guard([&] {
    require(list, "list");
    auto out = std::make_unique<ada4571_stored_list>();
    if (name)
      out->entries.push_back(entry_of(name));
    else
      for (const std::string &each : config_names())
        out->entries.push_back(entry_or_problem(each));
    *list = out.release();
  });
}

size_t ada4571_stored_list_count(const ada4571_stored_list *list) {
  return list ? list->entries.size() : 0;
}

ada4571_status ada4571_stored_list_get(const ada4571_stored_list *list, size_t index,
                                       ada4571_stored *stored) {
  return guard([&] {
    require(list, "list");
    require_struct(stored, "stored");
    const Entry &entry = at(list->entries, index, "stored configuration");
    const IioSourceOptions &source = entry.config.source;
    stored->name = entry.name.c_str();
    stored->path = entry.path.c_str();
    stored->uri = source.uri.c_str();
    stored->device = source.device.c_str();
    stored->sin_channel = source.channels.sin.c_str();
    stored->cos_channel = source.channels.cos.c_str();
    stored->temp_channel = source.channels.temp.c_str();
    stored->vdd_channel = source.channels.vdd.c_str();
    stored->calibration_file = entry.config.calibration_file.c_str();
    stored->problem = entry.problem.c_str();
  });
}

void ada4571_stored_list_free(ada4571_stored_list *list) {
  delete list;
}

} // extern "C"
