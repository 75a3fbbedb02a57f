// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The reading half of sigmf_meta.h.

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/text.h"
#include "recording/columns.h"
#include "recording/json_place.h"
#include "recording/metadata.h"
#include "recording/sigmf_meta.h"

namespace ada {

namespace {

using Json = nlohmann::ordered_json;
using Path = std::vector<std::string>;

constexpr std::string_view kExtension = "ada4571";
constexpr std::size_t kMaxFrameBytes = 1 << 16;
/// Of a sample that can be counted here.
constexpr std::uint64_t kMaxPlace =
    std::min<std::uint64_t>(std::uint64_t{1} << 62, std::numeric_limits<std::size_t>::max());

/// From the unit that a channel states to volts; 0 for any other unit.
double volt_factor(std::string_view unit) {
  return unit == "V" ? 1.0 : unit == "mV" ? 1e-3 : 0.0;
}

Path operator/(Path path, std::string step) {
  path.push_back(std::move(step));
  return path;
}

class MetaReader {
public:
  MetaReader(std::string_view text, const std::string &shown) : text_(text), shown_(shown) {}

  SigmfMeta read() {
    try {
      parse();
    } catch (const Json::parse_error &e) {
      const auto at = place_of_offset(text_, e.byte > 0 ? e.byte - 1 : 0);
      fail_at(at, "this is no JSON: " + reason(e.what()));
    } catch (const Json::out_of_range &e) { // "number overflow parsing '1e999'"
      const std::string what = reason(e.what());
      const auto open = what.find('\''), close = what.rfind('\'');
      const auto token = open < close ? what.substr(open + 1, close - open - 1) : std::string();
      fail_at(place_of_offset(text_, text_.find(token)), what);
    }
    const Json &global = object(root_, {}, "global");
    const Path path{"global"};
    check_form(global, path);
    check_extensions(global, path);
    read_channels(global, path);
    read_metadata(global, path);
    read_segments();
    return std::move(out_);
  }

private:
  /// Of two values of one key the parser would keep the last.
  void parse() {
    std::vector<std::set<std::string>> open;
    std::vector<std::string> keys; // all, up to the first that is there twice
    bool twice = false;
    root_ = Json::parse(text_, [&](int, Json::parse_event_t event, Json &value) {
      if (event == Json::parse_event_t::object_start)
        open.emplace_back();
      else if (event == Json::parse_event_t::object_end)
        open.pop_back();
      else if (event == Json::parse_event_t::key && !twice) {
        keys.push_back(value.get<std::string>());
        twice = !open.back().insert(keys.back()).second;
      }
      return true;
    });
    if (!twice)
      return;
    const auto before = std::count(keys.begin(), keys.end() - 1, keys.back());
    fail_at(place_of_offset(text_, place_of_key(keys.back(), before)),
            "the key \"" + printable(keys.back()) + "\" is there twice");
  }

  /// Where a key stands for the first time after so many times; of one that is written in escapes,
  /// the beginning.
  std::size_t place_of_key(const std::string &key, std::ptrdiff_t after) const {
    const std::string quoted = '"' + key + '"';
    for (std::size_t at = text_.find(quoted); at != text_.npos; at = text_.find(quoted, at + 1)) {
      const std::size_t next = text_.find_first_not_of(" \t\r\n", at + quoted.size());
      if (next != text_.npos && text_[next] == ':' && after-- == 0)
        return at;
    }
    return 0;
  }

  [[noreturn]] void fail_at(const TextPlace &at, const std::string &what) const {
    throw Error(ADA4571_ERROR_FORMAT, shown_ + ":" + std::to_string(at.line) + ":" +
                                          std::to_string(at.column) + ": " + what);
  }
  [[noreturn]] void fail(const Path &path, const std::string &what) const {
    fail_at(place_in_json(text_, path), what);
  }

  /// What the parser says after its own name and place, printable.
  static std::string reason(std::string_view what) {
    for (const std::string_view mark : {"] ", ": "})
      if (const auto at = what.find(mark); at != what.npos)
        what.remove_prefix(at + mark.size());
    std::string clause(what);
    for (char &c : clause)
      c = c >= 0x20 && c < 0x7f ? c : '?';
    return clause.substr(0, 200);
  }

  const Json &object(const Json &parent, const Path &path, const std::string &key) const {
    const Json *value = get(parent, key);
    if (value == nullptr || !value->is_object())
      fail(path / key, "the object \"" + key + "\" is missing: this is no SigMF meta file");
    return *value;
  }

  static const Json *get(const Json &parent, const std::string &key) {
    const auto it = parent.is_object() ? parent.find(key) : parent.end();
    return it == parent.end() ? nullptr : &*it;
  }

  std::optional<double> number(const Json &parent, const Path &path, const std::string &key,
                               double least, double most) const {
    const Json *value = get(parent, key);
    if (value == nullptr)
      return std::nullopt;
    if (!value->is_number() || !(value->get<double>() >= least && value->get<double>() <= most))
      fail(path / key, key + " must be a number from " + shortest(least) + " to " + shortest(most));
    return value->get<double>();
  }

  std::optional<std::uint64_t> count(const Json &parent, const Path &path, const std::string &key,
                                     std::uint64_t most = std::uint64_t{1} << 62) const {
    const Json *value = get(parent, key);
    if (value == nullptr)
      return std::nullopt;
    if (!value->is_number_unsigned() || value->get<std::uint64_t>() > most)
      fail(path / key, key + " must be a whole number from 0 to " + std::to_string(most));
    return value->get<std::uint64_t>();
  }

  std::optional<std::string> words(const Json &parent, const Path &path,
                                   const std::string &key) const {
    const Json *value = get(parent, key);
    if (value == nullptr)
      return std::nullopt;
    if (!value->is_string())
      fail(path / key, key + " must be text");
    return value->get<std::string>();
  }

  /// What this reader does not do, said rather than read wrongly.
  void check_form(const Json &global, const Path &path) {
    for (const char *key : {"core:trailing_bytes", "core:offset"})
      if (count(global, path, key).value_or(0) != 0)
        fail(path / key, std::string(key) + " is not supported");
    if (const Json *only = get(global, "core:metadata_only"); only && *only == true)
      fail(path / "core:metadata_only", "this meta file has no data file");
    if (const auto name = words(global, path, "core:dataset")) {
      if (name->empty() || name->find('/') != name->npos || *name == "." || *name == "..")
        fail(path / "core:dataset", "core:dataset must be a file name without a folder");
      out_.dataset = *name;
    }
    out_.unfinished = words(global, path, "ada4571:unfinished").has_value();
    if (const auto crc = words(global, path, "ada4571:data_crc32")) {
      unsigned value = 0;
      const auto result = std::from_chars(crc->data(), crc->data() + crc->size(), value, 16);
      if (crc->size() != 8 || result.ec != std::errc() || result.ptr != crc->data() + crc->size())
        fail(path / "ada4571:data_crc32", "ada4571:data_crc32 must be eight hexadecimal digits");
      out_.data_crc32 = value;
    }
  }

  void check_extensions(const Json &global, const Path &path) const {
    bool declared = false;
    const Json *list = get(global, "core:extensions");
    for (std::size_t i = 0; list && list->is_array() && i < list->size(); ++i) {
      const Path at = path / "core:extensions" / std::to_string(i);
      const Json &item = (*list)[i];
      const auto name = words(item, at, "name");
      if (!name)
        fail(at, "an extension has no name");
      if (*name == kExtension) {
        declared = true;
        if (!words(item, at, "version").value_or("").starts_with("1."))
          fail(at, "only version 1 of the ada4571 extension is known here");
      } else if (const Json *optional = get(item, "optional"); optional && *optional == false) {
        fail(at, "the extension " + excerpt(*name) + " is needed, and is not known here");
      }
    }
    if (!declared)
      fail(path / "core:extensions",
           "core:extensions does not declare the extension ada4571, which names the channels");
  }

  void read_channels(const Json &global, const Path &path) {
    const auto datatype = words(global, path, "core:datatype");
    if (!datatype)
      fail(path, "core:datatype is missing");
    SampleType type;
    rethrow_at(path / "core:datatype", [&] { type = type_of_datatype(*datatype); });
    const Json *list = get(global, "ada4571:channels");
    if (list == nullptr || !list->is_array() || list->empty() || list->size() > 1000)
      fail(path / "ada4571:channels", "ada4571:channels must list 1 to 1000 channels");
    const auto frame_bytes = count(global, path, "ada4571:frame_bytes", kMaxFrameBytes);
    for (std::size_t i = 0; i < list->size(); ++i)
      read_channel((*list)[i], path / "ada4571:channels" / std::to_string(i), type,
                   frame_bytes.has_value());
    const auto channels = count(global, path, "core:num_channels").value_or(1);
    if (frame_bytes)
      place_in_frame(*frame_bytes, channels, type, path);
    else
      out_.frame_bytes = place_channels(out_.channels);
    if (!frame_bytes && channels != out_.channels.size())
      fail(path / "core:num_channels", "core:num_channels is " + std::to_string(channels) +
                                           ", but ada4571:channels lists " +
                                           std::to_string(out_.channels.size()));
    for (const Column &column : kColumns)
      if (column.required && column.name != "time_s" && out_.find(column.name) == nullptr)
        fail(path / "ada4571:channels", "the channel " + std::string(column.name) + " is missing");
  }

  void read_channel(const Json &item, const Path &at, const SampleType &datatype, bool in_frame) {
    SigmfChannel channel;
    const auto name = words(item, at, "name");
    if (!name || name->empty())
      fail(at, "a channel has no name");
    channel.name = *name;
    if (out_.find(channel.name) != nullptr)
      fail(at, "the channel " + excerpt(channel.name) + " is there twice");
    channel.type = datatype;
    if (const auto text = words(item, at, "type"))
      rethrow_at(at / "type", [&] { channel.type = parse_sample_type(*text); });
    else if (in_frame)
      fail(at, "the channel " + excerpt(channel.name) + " has no type");
    if (!in_frame && (channel.type.word.storage != datatype.word.storage ||
                      channel.type.is_float != datatype.is_float || channel.type.word.repeat != 1))
      fail(at / "type", "the type " + to_string(channel.type) + " does not fit core:datatype");
    if (const auto byte = count(item, at, "byte", kMaxFrameBytes))
      given_bytes_.emplace_back(out_.channels.size(), *byte);
    read_scale(item, at, channel);
    out_.channels.push_back(std::move(channel));
  }

  void read_scale(const Json &item, const Path &at, SigmfChannel &channel) const {
    constexpr double kMost = 1e12;
    const auto scale = number(item, at, "scale", -kMost, kMost);
    const auto offset = number(item, at, "offset", -1e19, 1e19);
    const auto unit = words(item, at, "unit");
    const auto refuse_unit = [&](const char *wanted) {
      if (unit)
        fail(at / "unit", "the unit of " + channel.name + " must be " + wanted);
    };
    const bool known = std::any_of(kColumns.begin(), kColumns.end(),
                                   [&](const Column &c) { return c.name == channel.name; });
    if (!known)
      return;
    if (channel.name == "time_s") {
      if (scale || offset)
        fail(at, "time_s takes neither scale nor offset, only a unit");
      if (channel.type.is_float ? unit.value_or("s") != "s" : unit.value_or("ns") != "ns")
        refuse_unit(channel.type.is_float ? "s" : "ns");
      return;
    }
    if (!channel.type.is_float && !scale)
      fail(at, "the channel " + channel.name + " has no scale");
    if (scale && *scale == 0)
      fail(at / "scale", "the scale of " + channel.name + " is zero");
    double factor = unit.value_or("deg") == "deg" ? 1.0 : 0.0;
    if (channel.name != "reference_deg")
      factor = volt_factor(unit.value_or("V"));
    if (factor == 0)
      refuse_unit(channel.name == "reference_deg" ? "deg" : "V or mV");
    channel.scale = scale.value_or(1.0) * factor;
    channel.offset = offset.value_or(0.0);
  }

  void place_in_frame(std::uint64_t bytes, std::uint64_t channels, const SampleType &type,
                      const Path &path) {
    if (datatype_of(type) != "ru8" || channels != bytes)
      fail(path / "ada4571:frame_bytes",
           "with ada4571:frame_bytes, core:datatype must be ru8 and core:num_channels the same");
    const std::size_t needed = place_channels(out_.channels);
    for (const auto &[index, byte] : given_bytes_)
      out_.channels[index].byte = byte;
    for (const SigmfChannel &channel : out_.channels)
      if (channel.byte + channel.type.word.element_bytes() > bytes)
        fail(path / "ada4571:frame_bytes",
             "the channel " + excerpt(channel.name) + " does not fit into a frame of " +
                 std::to_string(bytes) + " bytes; laid out as IIO does, a frame has " +
                 std::to_string(needed));
    out_.frame_bytes = static_cast<std::size_t>(bytes);
  }

  void read_metadata(const Json &global, const Path &path) {
    for (const auto &[key, value] : global.items()) {
      if (key == "core:sample_rate") {
        assign("sample_rate_hz", value, path / key);
      } else if (key.starts_with(kSigmfPrefix)) {
        const std::string name = key.substr(kSigmfPrefix.size());
        if (is_known_metadata(name))
          assign(name, value, path / key);
        else if (std::set<std::string>{"channels", "frame_bytes", "data_crc32", "metadata",
                                       "unfinished"}
                     .count(name) == 0)
          fail(path / key, "the key " + excerpt(key) + " of the ada4571 extension is not known");
      }
    }
    const Json *others = get(global, "ada4571:metadata");
    if (others == nullptr)
      return;
    if (!others->is_object())
      fail(path / "ada4571:metadata", "ada4571:metadata must be an object");
    for (const auto &[key, value] : others->items()) {
      if (is_known_metadata(key))
        fail(path / "ada4571:metadata" / key,
             "the key " + excerpt(key) + " belongs to the global object, as ada4571:" + key);
      assign(key, value, path / "ada4571:metadata" / key);
    }
  }

  void assign(const std::string &key, const Json &value, const Path &at) {
    if (!value.is_string() && !value.is_number())
      fail(at, excerpt(key) + " must be a number or text");
    const std::string text =
        value.is_string() ? value.get<std::string>() : shortest(value.get<double>());
    if (const std::string problem = assign_metadata(out_.meta, key, text); !problem.empty())
      fail(at, problem);
  }

  void read_segments() {
    const Json *list = get(root_, "captures");
    const Path path{"captures"};
    if (list && !list->is_array())
      fail(path, "captures must be an array");
    for (std::size_t i = 0; list && i < list->size(); ++i)
      read_segment((*list)[i], path / std::to_string(i));
    if (out_.segments.empty())
      out_.segments.emplace_back(); // as SigMF says: an empty array means one segment
  }

  /// Where a segment does not state its time: counted on from the one before, lost samples too.
  double time_by_index(std::uint64_t global_index) const {
    if (!out_.meta.sample_rate_hz)
      return out_.segments.empty() ? 0.0 : out_.segments.back().time_s;
    const SigmfSegment before = out_.segments.empty() ? SigmfSegment() : out_.segments.back();
    return before.time_s +
           static_cast<double>(global_index - before.global_index) / *out_.meta.sample_rate_hz;
  }

  void read_segment(const Json &item, const Path &at) {
    SigmfSegment segment;
    const auto start = count(item, at, "core:sample_start", kMaxPlace);
    if (!start)
      fail(at, "core:sample_start is missing");
    segment.sample_start = static_cast<std::size_t>(*start);
    if (out_.segments.empty() ? *start != 0 : *start <= out_.segments.back().sample_start)
      fail(at / "core:sample_start",
           "core:sample_start must be 0 in the first segment and grow from each to the next");
    if (count(item, at, "core:header_bytes").value_or(0) != 0)
      fail(at / "core:header_bytes", "core:header_bytes is not supported");
    if (out_.segments.empty())
      out_.datetime = words(item, at, "core:datetime").value_or("");
    segment.global_index = count(item, at, "core:global_index").value_or(*start);
    if (!out_.segments.empty() && segment.global_index <= out_.segments.back().global_index)
      fail(at / "core:global_index", "core:global_index must grow from each segment to the next");
    segment.time_s = number(item, at, "ada4571:time_s", -kMaxTimeS, kMaxTimeS)
                         .value_or(time_by_index(segment.global_index));
    out_.segments.push_back(segment);
  }

  /// Runs `body`; an Error of it gets the place.
  template <class Body> void rethrow_at(const Path &path, Body body) const {
    try {
      body();
    } catch (const Error &e) {
      fail(path, e.what());
    }
  }

  std::string_view text_;
  const std::string &shown_;
  Json root_;
  SigmfMeta out_;
  std::vector<std::pair<std::size_t, std::size_t>> given_bytes_; ///< channel and its stated byte
};

} // namespace

const SigmfChannel *SigmfMeta::find(std::string_view name) const {
  const auto it = std::find_if(channels.begin(), channels.end(),
                               [&](const SigmfChannel &c) { return c.name == name; });
  return it == channels.end() ? nullptr : &*it;
}

SigmfMeta parse_sigmf_meta(std::string_view json, const std::string &shown) {
  return MetaReader(json, shown).read();
}

} // namespace ada
