// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "import/importer.h"

#include <cmath>
#include <memory>
#include <string_view>

#include "capi/guard.h"

using namespace ada;
using namespace ada::capi;

struct ada4571_import {
  std::unique_ptr<Importer> impl;
};

namespace {

std::optional<char> one_character(const char *text, const char *name) {
  if (!text)
    return std::nullopt;
  if (std::string_view(text).size() != 1)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, std::string(name) + " must be one character");
  return text[0];
}

ImportColumn translate(const ada4571_import_column &column) {
  ImportColumn out;
  if (column.column)
    out.column = column.column;
  if (!std::isnan(column.scale))
    out.scale = column.scale;
  out.offset = column.offset;
  return out;
}

ImportOptions translate(const ada4571_import_options &o) {
  ImportOptions out;
  out.separator = one_character(o.separator, "separator");
  out.decimal = one_character(o.decimal, "decimal");
  if (o.header_lines >= 0)
    out.header_lines = static_cast<std::size_t>(o.header_lines);
  out.columns = {translate(o.time),  translate(o.vsin), translate(o.vcos),
                 translate(o.vtemp), translate(o.vdd),  translate(o.reference)};
  out.sample_rate_hz = o.sample_rate_hz;
  out.supply_v = o.supply_v;
  out.periods_per_turn = o.periods_per_turn;
  return out;
}

} // namespace

extern "C" {

void ada4571_import_options_init(ada4571_import_options *options) {
  if (!options)
    return;
  const ImportOptions defaults;
  const ada4571_import_column column{nullptr, kAbsent, 0.0};
  *options = {};
  options->struct_size = sizeof *options;
  options->header_lines = -1;
  options->time = options->vsin = options->vcos = column;
  options->vtemp = options->vdd = options->reference = column;
  options->supply_v = defaults.supply_v;
  options->periods_per_turn = defaults.periods_per_turn;
}

ada4571_status ada4571_import_open(const char *path, const ada4571_import_options *options,
                                   ada4571_import **import) {
  return guard([&] {
    require(path, "path");
    require_struct(options, "options");
    require(import, "import");
    *import = new ada4571_import{open_import(path, translate(*options))};
  });
}

const char *ada4571_import_text(const ada4571_import *import) {
  return import ? import->impl->text().c_str() : "";
}

ada4571_status ada4571_import_get_info(const ada4571_import *import,
                                       ada4571_recording_info *info) {
  return guard([&] {
    require(import, "import");
    require_struct(info, "info");
    const CaptureMetadata &meta = import->impl->meta();
    ada4571_recording_info out;
    ada4571_recording_info_init(&out);
    out.supply_v = meta.supply_v;
    out.periods_per_turn = meta.periods_per_turn;
    out.sample_rate_hz = meta.sample_rate_hz.value_or(kAbsent);
    out.has_vtemp = import->impl->channels().vtemp;
    out.has_vdd = import->impl->channels().vdd;
    out.has_reference = import->impl->channels().reference;
    *info = out;
  });
}

ada4571_status ada4571_import_read(ada4571_import *import, ada4571_frame *frames, size_t capacity,
                                   size_t *count) {
  return guard([&] {
    require(import, "import");
    require(frames, "frames");
    require(count, "count");
    *count = import->impl->read({frames, capacity});
  });
}

void ada4571_import_free(ada4571_import *import) {
  delete import;
}

} // extern "C"
