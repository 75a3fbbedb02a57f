// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/channel_choice.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace ada {

namespace {

bool can_capture(const IioChannel &c) {
  return c.index >= 0 && !c.is_output;
}
bool usable(const IioChannel &c) {
  return can_capture(c) && c.is_voltage;
}

std::optional<std::size_t> find_labelled(const IioDevice &device, const char *label) {
  for (std::size_t i = 0; i < device.channels.size(); ++i)
    if (usable(device.channels[i]) && device.channels[i].label == label)
      return i;
  return std::nullopt;
}

/// By id first, then by label, then by name; never an output.
std::optional<std::size_t> find_named(const IioDevice &device, const std::string &name) {
  for (const auto member : {&IioChannel::id, &IioChannel::label, &IioChannel::name})
    for (std::size_t i = 0; i < device.channels.size(); ++i)
      if (!device.channels[i].is_output && device.channels[i].*member == name)
        return i;
  return std::nullopt;
}

/// The channel of one role, by option or by label; nullopt when neither names one.
std::optional<std::size_t> find_role(const IioDevice &device, const std::string &option,
                                     const char *label) {
  if (option.empty())
    return find_labelled(device, label);
  const auto found = find_named(device, option);
  if (!found)
    throw Error(ADA4571_ERROR_NOT_FOUND, display_name(device) + " has no input channel \"" +
                                             option + "\"; it has " + list_channels(device));
  const IioChannel &channel = device.channels[*found];
  if (!channel.is_voltage)
    throw Error(ADA4571_ERROR_UNSUPPORTED,
                "channel " + channel.id + " of " + display_name(device) + " is not a voltage");
  if (channel.index < 0)
    throw Error(ADA4571_ERROR_UNSUPPORTED, "channel " + channel.id + " of " + display_name(device) +
                                               " cannot be captured in a buffer");
  return found;
}

std::size_t require_role(const IioDevice &device, const std::string &option, const char *label) {
  const auto found = find_role(device, option, label);
  if (!found)
    throw Error(ADA4571_ERROR_NOT_FOUND, display_name(device) + " has no channel labelled " +
                                             label + ": name it by option; it has " +
                                             list_channels(device));
  return *found;
}

bool has_role(const IioDevice &device, const std::string &option, const char *label) {
  const auto i = option.empty() ? find_labelled(device, label) : find_named(device, option);
  return i && usable(device.channels[*i]);
}

bool serves(const IioDevice &device, const ChannelSelection &selection) {
  return has_role(device, selection.sin, "vsin") && has_role(device, selection.cos, "vcos");
}

/// "a voltage channel "foo"", "a channel labelled vcos", or both: what no device has, or no device
/// has together.
std::string what_is_missing(std::span<const IioDevice> devices, const ChannelSelection &selection) {
  std::string all, missing;
  const auto look_for = [&](const std::string &option, const char *label) {
    const std::string what = option.empty() ? std::string("a channel labelled ") + label
                                            : "a voltage channel \"" + option + "\" to capture";
    all += (all.empty() ? "" : " and ") + what;
    if (std::none_of(devices.begin(), devices.end(),
                     [&](const IioDevice &d) { return has_role(d, option, label); }))
      missing += (missing.empty() ? "" : " or ") + what;
  };
  look_for(selection.sin, "vsin");
  look_for(selection.cos, "vcos");
  return missing.empty() ? all : missing;
}

} // namespace

std::string display_name(const IioDevice &device) {
  const std::string label = device.label.empty() ? "" : ", label " + device.label;
  return device.name.empty() ? device.id + label : device.name + " (" + device.id + label + ")";
}

std::string list_channels(const IioDevice &device) {
  std::string text;
  for (const IioChannel &channel : device.channels) {
    if (!can_capture(channel) || channel.is_timestamp)
      continue;
    text += (text.empty() ? "" : ", ") + channel.id;
    if (!channel.label.empty())
      text += " (" + channel.label + ")";
  }
  return text.empty() ? "no channel that can be captured" : text;
}

bool labels_name_pair(const IioDevice &device) {
  return serves(device, {});
}

bool has_usable_pair(const IioDevice &device) {
  return std::count_if(device.channels.begin(), device.channels.end(), usable) >= 2;
}

ChannelChoice choose_channels(const IioDevice &device, const ChannelSelection &selection) {
  ChannelChoice choice;
  choice.sin = require_role(device, selection.sin, "vsin");
  choice.cos = require_role(device, selection.cos, "vcos");
  choice.temp = find_role(device, selection.temp, "vtemp");
  choice.vdd = find_role(device, selection.vdd, "vdd");
  for (std::size_t i = 0; i < device.channels.size(); ++i)
    if (device.channels[i].is_timestamp && can_capture(device.channels[i]))
      choice.timestamp = i;

  std::vector<std::size_t> roles{choice.sin, choice.cos};
  for (const auto &role : {choice.temp, choice.vdd})
    if (role)
      roles.push_back(*role);
  std::sort(roles.begin(), roles.end());
  const auto twice = std::adjacent_find(roles.begin(), roles.end());
  if (twice != roles.end())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "channel " + device.channels[*twice].id + " of " +
                                                    display_name(device) +
                                                    " is named for two signals");
  return choice;
}

const IioDevice &choose_device(std::span<const IioDevice> devices, const std::string &name,
                               const ChannelSelection &selection) {
  if (!name.empty()) {
    for (const auto member : {&IioDevice::id, &IioDevice::label, &IioDevice::name})
      for (const IioDevice &device : devices)
        if (device.*member == name)
          return device;
    std::string known;
    for (const IioDevice &device : devices)
      known += (known.empty() ? "" : ", ") + display_name(device);
    throw Error(ADA4571_ERROR_NOT_FOUND,
                "no IIO device \"" + name + "\"; there is " + (known.empty() ? "none" : known));
  }

  const bool named = !selection.sin.empty() || !selection.cos.empty();
  if (named && devices.size() == 1)
    return devices.front(); // what does not fit is said of it, channel by channel

  std::vector<const IioDevice *> fitting;
  for (const IioDevice &device : devices)
    if (serves(device, selection))
      fitting.push_back(&device);
  if (fitting.size() == 1)
    return *fitting.front();
  std::string listed;
  if (fitting.empty()) {
    for (const IioDevice &device : devices)
      listed += (listed.empty() ? "" : "; ") + display_name(device) + ": " + list_channels(device);
    throw Error(ADA4571_ERROR_NOT_FOUND, "no IIO device has " +
                                             what_is_missing(devices, selection) +
                                             ": name device and channels by option; there is " +
                                             (listed.empty() ? "no IIO device" : listed));
  }
  for (const IioDevice *device : fitting)
    listed += (listed.empty() ? "" : ", ") + display_name(*device);
  throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
              "several IIO devices fit, name one of them: " + listed);
}

} // namespace ada
