// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/source_options.h"

#include <algorithm>
#include <string>
#include <vector>

#include "common/file_roles.h"
#include "common/known_names.h"
#include "common/option_checks.h"
#include "common/progress.h"
#include "common/spelling.h"

namespace cli {

namespace {

/// An option that was not given is NULL for the library.
const char *given(const std::string &text) {
  return text.empty() ? nullptr : text.c_str();
}

constexpr auto kDeviceOptions = {"--uri",  "--device",  "--sin",  "--cos",    "--temp",   "--vdd",
                                 "--trigger", "--rate", "--supply", "--periods", "--within"};

/// A stored configuration, or a recording, says all of it.
void refuse_both_ways(const CLI::App &verb) {
  refuse_beside_capture(verb, kDeviceOptions);
  refuse_beside_capture(verb, {"--stored"});
  if (verb.count("--stored") == 0)
    return;
  for (const char *name : kDeviceOptions)
    if (verb.count(name) > 0)
      throw CLI::ExcludesError("--stored", name);
}

Source open_replay(const SourceOptions &options) {
  const Busy busy("reading " + options.capture); // all of it: a long one takes its time
  const auto recording = open_capture(options.capture);
  const auto *played = static_cast<const ada4571_recording *>(recording.get());
  if (options.speed == 0)
    return make<Source>(ada4571_source_open_recording, played);
  return make_as_asked<Source>(ada4571_source_open_replay, played, options.speed);
}

/// "; did you mean 'ada4571-sim'?" where the device that was named is none of those that are there.
std::string device_meant(const SourceOptions &options) {
  ada4571_device_list *list = nullptr;
  if (options.device.empty() || ada4571_device_list_new(given(options.uri), &list) != ADA4571_OK)
    return {};
  const DeviceList devices(list);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < ada4571_device_list_count(list); ++i) {
    ada4571_device device{};
    device.struct_size = sizeof device;
    check(ada4571_device_list_get(list, i, &device));
    for (const char *name : {device.id, device.name, device.label})
      if (*name)
        names.emplace_back(name);
  }
  const bool there = std::find(names.begin(), names.end(), options.device) != names.end();
  return there ? "" : did_you_mean(options.device, names);
}

} // namespace

void add_uri_option(CLI::App &verb, SourceOptions &options) {
  verb.add_option("-u,--uri", options.uri,
                  "libiio context: local:, ip:HOST, ip:HOST:PORT, usb:... (default local:)")
      ->type_name("URI");
}

void add_source_options(CLI::App &verb, SourceOptions &options, const std::string &before) {
  verb.add_option("-s,--stored", options.stored,
                  "stored configuration, made by `list --save NAME`, instead of the options below")
      ->type_name("NAME");
  add_uri_option(verb, options);
  verb.add_option("-d,--device", options.device,
                  "name, label or id of the IIO device (default: the only usable one)")
      ->type_name("DEVICE");
  const auto channel = [&verb](const char *name, std::string &value, const char *help) {
    verb.add_option(name, value, help)->type_name("CHANNEL");
  };
  channel("--sin", options.sin, "channel of VSIN (default: the one labelled vsin)");
  channel("--cos", options.cos, "channel of VCOS (default: the one labelled vcos)");
  channel("--temp", options.temp, "channel of VTEMP (default: labelled vtemp, or none)");
  channel("--vdd", options.vdd, "channel of VDD (default: labelled vdd, or none)");
  verb.add_option("--trigger", options.trigger, "IIO trigger to use (default: what is set)")
      ->type_name("NAME");
  verb.add_option("--rate", options.rate_hz, "sample rate to set (default: what is set)")
      ->transform(positive("Hz"))
      ->type_name("HZ");
  verb.add_option("--supply", options.supply_v, "supply of the sensor (default: " + before + "5)")
      ->transform(positive("V"))
      ->type_name("V");
  verb.add_option("--periods", options.periods_per_turn,
                  "electrical periods a turn: 2 for AMR, 1 for GMR, TMR and Hall (default: " +
                      before + "2)")
      ->transform(whole(1, 1000))
      ->type_name("N");
  verb.add_option("--within", options.latency_s,
                  "longest wait of a sample for its buffer: short costs processor time "
                  "(default 0.05)")
      ->transform(between(1e-6, 60.0, "s"))
      ->type_name("S");
  verb.parse_complete_callback([&verb] { refuse_both_ways(verb); });
}

void add_replay_options(CLI::App &verb, std::string &capture, double &speed) {
  auto *file = verb.add_option("--capture", capture, "play this capture instead of a device")
                   ->type_name("CAPTURE");
  verb.add_option("--speed", speed, "play it so many times as fast as it was recorded")
      ->capture_default_str()
      ->transform(between(0.0, 1e6))
      ->needs(file)
      ->type_name("N");
}

void refuse_beside_capture(const CLI::App &verb, std::initializer_list<const char *> names) {
  if (verb.get_option_no_throw("--capture") == nullptr || verb.count("--capture") == 0)
    return;
  for (const char *name : names)
    if (verb.get_option_no_throw(name) != nullptr && verb.count(name) > 0)
      throw CLI::ExcludesError("--capture", name);
}

Source open_source(const SourceOptions &options) {
  if (options.replays())
    return open_replay(options);
  if (!options.stored.empty())
    return open_stored(options.stored, [&options] {
      return make_as_asked<Source>(ada4571_open, options.stored.c_str());
    });
  auto wanted = initialised(ada4571_source_options_init);
  wanted.uri = given(options.uri);
  wanted.device = given(options.device);
  wanted.sin_channel = given(options.sin);
  wanted.cos_channel = given(options.cos);
  wanted.temp_channel = given(options.temp);
  wanted.vdd_channel = given(options.vdd);
  wanted.trigger = given(options.trigger);
  wanted.sample_rate_hz = options.rate_hz;
  if (options.supply_v > 0)
    wanted.supply_v = options.supply_v;
  if (options.periods_per_turn > 0)
    wanted.periods_per_turn = options.periods_per_turn;
  wanted.latency_s = options.latency_s;
  const Busy busy("opening " + (options.uri.empty() ? "the device" : options.uri));
  try {
    return make_as_asked<Source>(ada4571_source_open, &wanted);
  } catch (const Failure &e) {
    throw Failure(e.exit_status(), e.what() + device_meant(options));
  }
}

ada4571_source_info source_info(const Source &source) {
  auto info = initialised(ada4571_source_info_init);
  check(ada4571_source_get_info(source.get(), &info));
  return info;
}

} // namespace cli
