// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/config.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <sstream>

#include <toml++/toml.h>

#include "base/angle.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file_bytes.h"
#include "base/toml_text.h"

namespace ada {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = 1u << 20;

/// Errors with the place in the file.
class Place {
public:
  explicit Place(std::string path) : path_(std::move(path)) {}
  [[noreturn]] void refuse(const toml::source_region &at, const std::string &why) const {
    throw Error(ADA4571_ERROR_FORMAT, path_ + ":" + std::to_string(at.begin.line) + ":" +
                                          std::to_string(at.begin.column) + ": " + why);
  }

private:
  std::string path_;
};

/// One key of one section: how its node is stored.
using Store = std::function<void(const toml::node &)>;
using Section = std::map<std::string_view, Store>;

class Reader {
public:
  explicit Reader(const Place &place) : place_(place) {}

  Store text(std::string &target) const {
    return [this, &target](const toml::node &node) {
      const auto value = node.value_exact<std::string>();
      if (!value || value->empty())
        place_.refuse(node.source(), "expected a text in quotes that is not empty");
      if (value->find_first_of(std::string("\0\n\r", 3)) != std::string::npos)
        place_.refuse(node.source(), "line ends are not allowed here");
      target = *value;
    };
  }
  Store text(std::optional<std::string> &target) const {
    return [this, &target](const toml::node &node) {
      std::string value;
      text(value)(node);
      target = value;
    };
  }
  Store flag(bool &target) const {
    return [this, &target](const toml::node &node) {
      const auto value = node.value_exact<bool>();
      if (!value)
        place_.refuse(node.source(), "expected true or false");
      target = *value;
    };
  }
  Store number(double &target, double low, double high) const {
    return [this, &target, low, high](const toml::node &node) {
      const auto value = node.is_number() ? node.value<double>() : std::nullopt;
      if (!value || !(*value >= low && *value <= high))
        place_.refuse(node.source(),
                      "expected a number from " + trimmed(low) + " to " + trimmed(high));
      target = *value;
    };
  }
  Store integer(int &target, int low, int high) const {
    return [this, &target, low, high](const toml::node &node) {
      const auto value = node.value_exact<std::int64_t>();
      if (!value || *value < low || *value > high)
        place_.refuse(node.source(), "expected a whole number from " + std::to_string(low) +
                                         " to " + std::to_string(high));
      target = static_cast<int>(*value);
    };
  }

  void read(const toml::table &document,
            const std::map<std::string_view, Section> &sections) const {
    for (const auto &[section_key, section_node] : document) {
      const auto section = sections.find(section_key.str());
      if (section == sections.end())
        place_.refuse(section_key.source(), "unknown entry \"" + std::string(section_key.str()) +
                                                "\"; known are [source], [pins], [calibration]");
      if (!section_node.is_table())
        place_.refuse(section_node.source(),
                      "[" + std::string(section_key.str()) + "] must be a section");
      for (const auto &[key, node] : *section_node.as_table()) {
        const auto store = section->second.find(key.str());
        if (store == section->second.end())
          place_.refuse(key.source(), "unknown key \"" + std::string(key.str()) + "\" in [" +
                                          std::string(section_key.str()) + "]");
        store->second(node);
      }
    }
  }

private:
  static std::string trimmed(double value) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out << value;
    return out.str();
  }

  const Place &place_;
};

std::string environment(const char *name) {
  const char *value = std::getenv(name);
  return value ? value : "";
}

bool plain_name(const std::string &name) {
  constexpr std::string_view kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  return !name.empty() && name.size() <= 200 && name.front() != '.' && name.front() != '-' &&
         name.find_first_not_of(kAllowed) == std::string::npos;
}

void require_plain(const std::string &name) {
  if (!plain_name(name))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "\"" + name +
                    "\" is no name for a configuration: use letters, digits, and . _ - "
                    "inside, or a path with a slash");
}

std::string user_folder() {
  const std::string base = environment("XDG_CONFIG_HOME");
  if (base.starts_with('/')) // a relative one is invalid by the XDG specification
    return base + "/ada4571";
  const std::string home = environment("HOME");
  return home.starts_with('/') ? home + "/.config/ada4571" : "";
}

/// NAME.toml in the user's folder, or the path that a name with a slash is.
std::string path_to_save(const std::string &name) {
  if (name.find('/') != std::string::npos)
    return name;
  require_plain(name);
  const std::string folder = user_folder();
  if (folder.empty())
    throw Error(
        ADA4571_ERROR_NOT_FOUND,
        "no folder for configurations: neither XDG_CONFIG_HOME nor HOME is an absolute path");
  return folder + "/" + name + ".toml";
}

/// Of anything but a regular file, the open alone may wait for ever or move a machine.
std::string read_file(const std::string &path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::none || status.type() == fs::file_type::not_found)
    throw system_error(error.value(), path, "cannot open");
  if (status.type() != fs::file_type::regular)
    throw Error(ADA4571_ERROR_FORMAT, path + ": this is no regular file");
  const FileBytes file(path);
  if (file.size() > kLargestFile)
    throw Error(ADA4571_ERROR_FORMAT, path + ": too large for a configuration");
  const BytesRead read = file.all();
  const std::span<const std::byte> bytes = read;
  return {reinterpret_cast<const char *>(bytes.data()), bytes.size()};
}

/// Text in TOML's quotes.
std::string quoted(const std::string &text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

std::string number(double value) {
  std::ostringstream out;
  out << toml::value<double>(value);
  return out.str();
}

} // namespace

std::vector<std::string> config_folders() {
  std::vector<std::string> folders;
  if (const std::string user = user_folder(); !user.empty())
    folders.push_back(user);
  folders.push_back("/etc/ada4571");
  return folders;
}

std::string find_config(const std::string &name) {
  if (name.find('/') != std::string::npos)
    return name;
  require_plain(name);
  std::string searched, unreachable;
  for (const std::string &folder : config_folders()) {
    const std::string path = folder + "/" + name + ".toml";
    // A link that leads nowhere is there, too: what is wrong with it is said where it is opened.
    std::error_code error;
    const fs::file_type type = fs::symlink_status(path, error).type();
    if (type == fs::file_type::none)
      unreachable = unreachable.empty() ? path : unreachable;
    else if (type != fs::file_type::not_found)
      return path;
    searched += (searched.empty() ? "" : " nor ") + path;
  }
  if (!unreachable.empty())
    return unreachable;
  throw Error(ADA4571_ERROR_NOT_FOUND,
              "no stored configuration \"" + name + "\": " +
                  (config_folders().size() == 1 ? searched + " does not exist"
                                                : "neither " + searched + " exists"));
}

StoredConfig parse_config(std::string_view text, const std::string &path) {
  const Place place(path);
  StoredConfig config;
  IioSourceOptions &s = config.source;
  const Reader r(place);
  const std::map<std::string_view, Section> sections{
      {"source",
       {{"uri", r.text(s.uri)},
        {"device", r.text(s.device)},
        {"sin", r.text(s.channels.sin)},
        {"cos", r.text(s.channels.cos)},
        {"temp", r.text(s.channels.temp)},
        {"vdd", r.text(s.channels.vdd)},
        {"trigger", r.text(s.trigger)},
        {"sample_rate_hz", r.number(s.sample_rate_hz, 1e-3, 1e9)},
        {"latency_s", r.number(s.latency_s, 1e-6, 60.0)},
        {"supply_v", r.number(s.supply_v, 0.1, 50.0)},
        {"periods_per_turn", r.integer(s.periods_per_turn, 1, kMostPeriodsATurn)}}},
      {"pins",
       {{"gc", r.text(config.pins.gc)},
        {"pd", r.text(config.pins.pd)},
        {"gc_active_low", r.flag(config.pins.gc_active_low)},
        {"pd_active_low", r.flag(config.pins.pd_active_low)}}},
      {"calibration", {{"file", r.text(config.calibration_file)}}}};
  try {
    r.read(toml::parse(ascii_toml(text, path), path), sections);
  } catch (const toml::parse_error &e) {
    place.refuse(e.source(), std::string(e.description()));
  }
  return config;
}

StoredConfig load_config(const std::string &name) {
  const std::string path = find_config(name);
  StoredConfig config = parse_config(read_file(path), path);
  const fs::path file(config.calibration_file);
  if (!file.empty() && file.is_relative())
    config.calibration_file = (fs::path(path).parent_path() / file).string();
  return config;
}

std::optional<StoredConfig> load_config_if_any(const std::string &name) {
  const std::string path = path_to_save(name);
  std::error_code error;
  if (!fs::exists(path, error))
    return std::nullopt;
  return load_config(path);
}

std::vector<std::string> config_names() {
  std::set<std::string> names;
  for (const std::string &folder : config_folders()) {
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
      const fs::path &file = entry->path();
      if (file.extension() == ".toml" && plain_name(file.stem().string()))
        names.insert(file.stem().string());
    }
  }
  return {names.begin(), names.end()};
}

std::string config_text(const StoredConfig &config) {
  const IioSourceOptions &s = config.source;
  std::ostringstream out;
  const auto text = [&](const char *key, const std::string &value) {
    if (!value.empty())
      out << key << " = " << quoted(value) << "\n";
  };
  out << "[source]\n";
  text("uri", s.uri);
  text("device", s.device);
  text("sin", s.channels.sin);
  text("cos", s.channels.cos);
  text("temp", s.channels.temp);
  text("vdd", s.channels.vdd);
  text("trigger", s.trigger);
  if (s.sample_rate_hz > 0.0)
    out << "sample_rate_hz = " << number(s.sample_rate_hz) << "\n";
  if (s.latency_s > 0.0)
    out << "latency_s = " << number(s.latency_s) << "\n";
  out << "supply_v = " << number(s.supply_v) << "\n";
  out << "periods_per_turn = " << s.periods_per_turn << "\n";
  const PinsConfig &p = config.pins;
  if (p.gc || p.pd || p.gc_active_low || p.pd_active_low) {
    out << "\n[pins]\n";
    text("gc", p.gc.value_or(""));
    text("pd", p.pd.value_or(""));
    if (p.gc_active_low)
      out << "gc_active_low = true\n";
    if (p.pd_active_low)
      out << "pd_active_low = true\n";
  }
  if (!config.calibration_file.empty()) {
    out << "\n[calibration]\n";
    text("file", config.calibration_file);
  }
  return out.str();
}

std::string save_config(const std::string &name, const StoredConfig &config) {
  const std::string path = path_to_save(name);
  if (path != name) {
    const std::string folder = fs::path(path).parent_path().string();
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
      throw system_error(error.value(), folder, "cannot make the folder");
  }
  StoredConfig absolute = config;
  if (!config.calibration_file.empty())
    absolute.calibration_file = fs::absolute(config.calibration_file).lexically_normal().string();
  const std::string text = config_text(absolute);
  parse_config(text, path); // never write what could not be read again
  AtomicFile file(path);
  file.write(text);
  file.commit();
  return path;
}

} // namespace ada
