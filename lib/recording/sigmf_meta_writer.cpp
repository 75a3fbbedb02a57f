// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The writing half of sigmf_meta.h.

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "recording/metadata.h"
#include "recording/sigmf_meta.h"

namespace ada {

namespace {

using Json = nlohmann::ordered_json;

std::string unit_of(const SigmfChannel &channel) {
  if (channel.name == "time_s")
    return channel.type.is_float ? "s" : "ns";
  if (channel.name == "radius" || channel.name == "status")
    return "1";
  return channel.name.ends_with("_deg") ? "deg" : "V";
}

/// Whether all words are of one SigMF datatype, so that any reader of SigMF finds them.
bool is_uniform(const SigmfMeta &meta) {
  const SampleType &first = meta.channels.front().type;
  return !datatype_of(first).empty() &&
         std::all_of(meta.channels.begin(), meta.channels.end(),
                     [&](const SigmfChannel &c) { return c.type == first; });
}

Json channels_json(const SigmfMeta &meta, bool uniform) {
  Json list = Json::array();
  for (const SigmfChannel &channel : meta.channels) {
    Json item{{"name", channel.name}, {"unit", unit_of(channel)}};
    if (!uniform || channel.type.word.bits != channel.type.word.storage)
      item["type"] = to_string(channel.type);
    if (!uniform)
      item["byte"] = channel.byte;
    if (!channel.type.is_float && channel.name != "time_s") {
      item["scale"] = channel.scale;
      item["offset"] = channel.offset;
    }
    list.push_back(std::move(item));
  }
  return list;
}

void put_metadata(Json &global, const CaptureMetadata &meta) {
  Json others = Json::object();
  for (const auto &[key, value] : metadata_entries(meta)) {
    const auto as_number = parse_number(value);
    if (!is_known_metadata(key))
      others[key] = value;
    else if (key == "sample_rate_hz" && *as_number >= 1) // SigMF allows no lower rate
      global["core:sample_rate"] = *as_number;
    else if (as_number && key != "serial" && key != "origin")
      global[std::string(kSigmfPrefix) + key] = *as_number;
    else
      global[std::string(kSigmfPrefix) + key] = value;
  }
  if (!others.empty())
    global["ada4571:metadata"] = std::move(others);
}

} // namespace

std::string sigmf_meta_to_json(const SigmfMeta &meta) {
  const bool uniform = is_uniform(meta);
  Json global;
  global["core:datatype"] = uniform ? datatype_of(meta.channels.front().type) : "ru8";
  global["core:num_channels"] = uniform ? meta.channels.size() : meta.frame_bytes;
  global["core:version"] = "1.2.0";
  global["core:recorder"] = "libada4571 " ADA4571_VERSION_STRING;
  // Without the extension uniform samples are still samples; frames of bytes would be noise.
  global["core:extensions"] =
      Json::array({{{"name", "ada4571"}, {"version", "1.0.0"}, {"optional", uniform}}});
  if (!uniform)
    global["ada4571:frame_bytes"] = meta.frame_bytes;
  global["ada4571:channels"] = channels_json(meta, uniform);
  put_metadata(global, meta.meta);
  if (meta.data_crc32) {
    std::array<char, 16> text;
    std::snprintf(text.data(), text.size(), "%08x", *meta.data_crc32);
    global["ada4571:data_crc32"] = text.data();
  }
  if (meta.unfinished)
    global["ada4571:unfinished"] = "true";
  if (!meta.dataset.empty())
    global["core:dataset"] = meta.dataset;
  Json captures = Json::array();
  for (const SigmfSegment &segment : meta.segments)
    captures.push_back({{"core:sample_start", segment.sample_start},
                        {"core:global_index", segment.global_index},
                        {"ada4571:time_s", segment.time_s}});
  if (!meta.datetime.empty() && !captures.empty())
    captures.front()["core:datetime"] = meta.datetime;
  const Json root{{"global", std::move(global)},
                  {"captures", std::move(captures)},
                  {"annotations", Json::array()}};
  return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace ada
