// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/iio_attributes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <ctime>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text.h"

namespace ada {

namespace {

std::string place(const IioDevice &device, const std::string &channel, const char *attribute) {
  return display_name(device) + (channel.empty() ? "" : ", channel " + channel) + ", attribute " +
         attribute;
}

/// Strict and independent of the locale: the whole text is one finite number.
double parse_number(const std::string &text, const std::string &where) {
  std::string_view rest = text;
  while (!rest.empty() && (rest.back() == '\n' || rest.back() == ' '))
    rest.remove_suffix(1);
  if (rest.starts_with('+'))
    rest.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc{} || end != rest.data() + rest.size() || rest.empty() ||
      !std::isfinite(value))
    throw Error(ADA4571_ERROR_FORMAT, where + ": \"" + text.substr(0, 64) + "\" is not a number");
  return value;
}

std::optional<double> read_number(const IioContext &context, const IioDevice &device,
                                  const std::string &channel, const char *name) {
  const auto text = context.read(device.id, channel, name);
  if (!text)
    return std::nullopt;
  return parse_number(*text, place(device, channel, name));
}

/// Shortest text that reads back as the same number; sysfs takes no exponent.
std::string number_text(double value) {
  std::array<char, 400> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  return std::string(text.data(), end.ptr);
}

constexpr const char *kRate = "sampling_frequency", *kAvailable = "sampling_frequency_available";

constexpr double kSlowest_hz = 1e-6, kFastest_hz = 1e9;

/// Device and channel (empty: the device itself) that hold the sampling frequency. A device that is
/// triggered runs at the rate of its trigger.
std::optional<std::pair<IioDevice, std::string>>
find_rate(const IioContext &context, const IioDevice &device, const IioChannel &channel) {
  const std::string trigger = context.trigger(device.id);
  if (!trigger.empty() && context.read(trigger, "", kRate))
    return std::pair(IioDevice{trigger, {}, {}, {}}, std::string());
  if (context.read(device.id, "", kRate))
    return std::pair(device, std::string());
  if (context.read(device.id, channel.id, kRate))
    return std::pair(device, channel.id);
  return std::nullopt;
}

} // namespace

LinearScale read_scale(const IioContext &context, const IioDevice &device,
                       const IioChannel &channel) {
  const auto scale_mv = read_number(context, device, channel.id, "scale");
  if (!scale_mv)
    throw Error(ADA4571_ERROR_UNSUPPORTED,
                place(device, channel.id, "scale") +
                    ": there is none or it cannot be read, so counts cannot become volts");
  if (*scale_mv <= 0.0)
    throw Error(ADA4571_ERROR_FORMAT, place(device, channel.id, "scale") +
                                          ": must be greater than 0, is " + number_text(*scale_mv));
  const double offset = read_number(context, device, channel.id, "offset").value_or(0.0);
  return LinearScale{offset, *scale_mv * 1e-3};
}

double read_sample_rate(const IioContext &context, const IioDevice &device,
                        const IioChannel &channel) {
  const auto found = find_rate(context, device, channel);
  if (!found)
    return 0.0;
  const double rate = read_number(context, found->first, found->second, kRate).value_or(0.0);
  if (rate > kFastest_hz || (rate > 0.0 && rate < kSlowest_hz))
    throw Error(ADA4571_ERROR_FORMAT, place(found->first, found->second, kRate) +
                                          ": no converter samples at " + shortest(rate) + " Hz");
  return rate > 0.0 ? rate : 0.0;
}

double write_sample_rate(IioContext &context, const IioDevice &device, const IioChannel &channel,
                         double rate_hz) {
  const auto found = find_rate(context, device, channel);
  if (!found)
    return rate_hz;
  const int error = context.write(found->first.id, found->second, kRate, number_text(rate_hz));
  if (error != 0) {
    const auto available = context.read(found->first.id, found->second, kAvailable);
    throw Error(status_of_errno(error), place(found->first, found->second, kRate) +
                                            ": cannot be set to " + number_text(rate_hz) + ": " +
                                            errno_text(error) +
                                            (available ? "; it has " + *available : ""));
  }
  return read_sample_rate(context, device, channel);
}

DriverCalibration::Channel read_driver_calibration(const IioContext &context,
                                                   const IioDevice &device,
                                                   const IioChannel &channel) {
  DriverCalibration::Channel out;
  out.bias = read_number(context, device, channel.id, "calibbias");
  out.scale = read_number(context, device, channel.id, "calibscale");
  out.volts_per_count = read_scale(context, device, channel).scale_v;
  return out;
}

void write_driver_calibration(IioContext &context, const IioDevice &device, const IioChannel &sin,
                              const IioChannel &cos, const DriverCalibration &calibration) {
  struct Item {
    std::string channel;
    const char *name;
    std::optional<double> value;
  };
  const std::array<Item, 4> items{{{sin.id, "calibbias", calibration.sin.bias},
                                   {sin.id, "calibscale", calibration.sin.scale},
                                   {cos.id, "calibbias", calibration.cos.bias},
                                   {cos.id, "calibscale", calibration.cos.scale}}};
  std::vector<std::pair<const Item *, std::string>> written; // with the value before
  for (const Item &item : items) {
    if (!item.value)
      continue;
    const auto before = context.read(device.id, item.channel, item.name);
    const int error =
        before ? context.write(device.id, item.channel, item.name, number_text(*item.value))
               : ENOENT;
    if (error == 0) {
      written.emplace_back(&item, *before);
      continue;
    }
    for (const auto &[done, old] : written)
      context.write(device.id, done->channel, done->name, old);
    throw Error(error == ENOENT ? ADA4571_ERROR_UNSUPPORTED : status_of_errno(error),
                place(device, item.channel, item.name) +
                    (error == ENOENT ? ": the driver has none"
                                     : ": cannot be set to " + number_text(*item.value) + ": " +
                                           errno_text(error)));
  }
}

bool is_this_machine(const IioContext &context, const std::string &uri) {
  return context.is_local() || uri.starts_with("ip:127.") || uri.starts_with("ip:localhost") ||
         uri.starts_with("ip:[::1]");
}

int read_timestamp_clock(const IioContext &context, const IioDevice &device) {
  constexpr std::pair<const char *, int> kClocks[] = {{"realtime", CLOCK_REALTIME},
                                                      {"monotonic", CLOCK_MONOTONIC},
                                                      {"monotonic_raw", CLOCK_MONOTONIC_RAW},
                                                      {"realtime_coarse", CLOCK_REALTIME_COARSE},
                                                      {"monotonic_coarse", CLOCK_MONOTONIC_COARSE},
                                                      {"boottime", CLOCK_BOOTTIME},
                                                      {"tai", CLOCK_TAI}};
  // Without the attribute it is what the kernel takes by default.
  const std::string name =
      context.read(device.id, "", "current_timestamp_clock").value_or("realtime");
  for (const auto &[clock, id] : kClocks)
    if (name == clock)
      return id;
  return -1;
}

std::string permission_hint(const std::string &uri) {
  if (!uri.starts_with("local:"))
    return "; the server must be allowed to do it";
  return "; install the project's udev rules and join the group they name, or run as root";
}

} // namespace ada
