// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/iio_opened_device.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "acquisition/iio_attributes.h"
#include "base/angle.h"
#include "base/error.h"
#include "base/text.h"

namespace ada {

namespace {

constexpr std::size_t kFramesWithoutRate = 64;
constexpr std::size_t kMostFrames = 1u << 16, kMostFramesAsked = 1u << 24;
/// How long a frame waits for its buffer where nobody asks for less.
constexpr double kLatency_s = 0.05;
/// The kernel's FIFO comes from kmalloc, which ends at 4 MiB on most machines.
constexpr std::size_t kKernelBytes = 4u << 20;
/// What the kernel holds for a reader that is late.
constexpr double kKernelSeconds = 1.0;

void plan_scan(OpenedDevice &o) {
  std::vector<std::pair<std::size_t, double Frame::*>> wanted{{o.choice.sin, &Frame::vsin_v},
                                                              {o.choice.cos, &Frame::vcos_v}};
  if (o.choice.temp)
    wanted.emplace_back(*o.choice.temp, &Frame::vtemp_v);
  if (o.choice.vdd)
    wanted.emplace_back(*o.choice.vdd, &Frame::vdd_v);
  if (o.choice.timestamp)
    wanted.emplace_back(*o.choice.timestamp, nullptr);
  const auto &channels = o.device.channels;
  std::sort(wanted.begin(), wanted.end(), [&](const auto &a, const auto &b) {
    return channels[a.first].index < channels[b.first].index;
  });
  for (const auto &[position, target] : wanted) {
    const IioChannel &channel = channels[position];
    if (!channel.odd_format.empty())
      throw Error(ADA4571_ERROR_UNSUPPORTED,
                  "channel " + channel.id + ": its values have the format " +
                      excerpt(channel.odd_format) + ", which is no whole number of known size");
    if (!target && (channel.format.storage != 64 || channel.format.bits != 64))
      throw Error(ADA4571_ERROR_UNSUPPORTED, "channel " + channel.id +
                                                 ": a timestamp has 64 bits, " + "not " +
                                                 to_string(channel.format));
    const std::size_t element = o.scan.size();
    o.scan.push_back(channel.id);
    o.formats.push_back(channel.format);
    if (target)
      o.signals.push_back(
          {ElementDecoder(channel.format, read_scale(*o.context, o.device, channel), channel.id),
           target, element});
    else
      o.timestamp = {ElementDecoder(channel.format, {}, channel.id), element};
  }
}

/// Timestamps of the monotonic clock cannot be set back. Not every kernel has the attribute and not
/// every user may write it; either is fine.
void prefer_monotonic_clock(OpenedDevice &o) {
  constexpr const char *kClock = "current_timestamp_clock";
  const auto now = o.context->read(o.device.id, "", kClock);
  if (now && !now->starts_with("monotonic"))
    o.context->write(o.device.id, "", kClock, "monotonic");
}

void describe_source(OpenedDevice &o, const IioSourceOptions &options) {
  const IioChannel &sin = o.device.channels[o.choice.sin];
  o.info.description = options.uri + " " + display_name(o.device);
  o.info.serial = o.context->attribute("hw_serial");
  const double found_hz = read_sample_rate(*o.context, o.device, sin);
  o.info.sample_rate_hz = found_hz;
  if (options.sample_rate_hz > 0.0) {
    o.info.sample_rate_hz = write_sample_rate(*o.context, o.device, sin, options.sample_rate_hz);
    if (found_hz > 0.0 && found_hz != o.info.sample_rate_hz)
      o.rate_before = found_hz;
  }
  o.info.supply_v = options.supply_v;
  o.info.periods_per_turn = options.periods_per_turn;
  o.info.has_vtemp = o.choice.temp.has_value();
  o.info.has_vdd = o.choice.vdd.has_value();
  o.info.adc_bits = static_cast<int>(sin.format.bits);
  if (o.timestamp && is_this_machine(*o.context, options.uri))
    o.info.timestamp_clock = read_timestamp_clock(*o.context, o.device);
  if (!o.timestamp && o.info.sample_rate_hz <= 0.0)
    throw Error(ADA4571_ERROR_UNSUPPORTED,
                display_name(o.device) + " has neither timestamps nor a sampling frequency: give "
                                         "the sample rate");
}

} // namespace

void check_options(const IioSourceOptions &options) {
  const auto refuse = [](const char *why) { throw Error(ADA4571_ERROR_INVALID_ARGUMENT, why); };
  if (!(options.sample_rate_hz >= 0.0 && options.sample_rate_hz <= 1e9))
    refuse("sample_rate_hz must be from 0 to 1e9");
  if (!(options.supply_v > 0.0 && options.supply_v <= 50.0))
    refuse("supply_v must be greater than 0 and at most 50");
  if (options.periods_per_turn < 1 || options.periods_per_turn > kMostPeriodsATurn)
    refuse("periods_per_turn must be from 1 to 65536");
  if (options.buffer_frames > kMostFramesAsked)
    refuse("buffer_frames must be at most 16777216");
  if (!(options.latency_s >= 0.0 && options.latency_s <= 60.0))
    refuse("latency_s must be from 0 to 60");
}

OpenedDevice open_iio_device(const IioSourceOptions &options, const Cancellation *cancellation) {
  OpenedDevice o;
  o.context = open_iio_context(options.uri, cancellation);
  const std::vector<IioDevice> devices = o.context->devices();
  o.device = choose_device(devices, options.device, options.channels);
  o.choice = choose_channels(o.device, options.channels);
  plan_scan(o);
  if (!options.trigger.empty()) // before the buffer: a running buffer keeps its trigger
    o.context->set_trigger(o.device.id, options.trigger);
  prefer_monotonic_clock(o);
  describe_source(o, options);
  return o;
}

void set_rate_back(OpenedDevice &opened) noexcept {
  if (!opened.rate_before || !opened.context)
    return;
  try {
    write_sample_rate(*opened.context, opened.device, opened.channel(opened.choice.sin),
                      *opened.rate_before);
  } catch (const std::exception &) { // the device is gone, or another program reads it by now
  }
}

std::size_t buffer_frames(const OpenedDevice &opened, const IioSourceOptions &options) {
  std::size_t frames = options.buffer_frames;
  const double wait_s = options.latency_s > 0.0 ? options.latency_s : kLatency_s;
  if (frames == 0 && opened.info.sample_rate_hz > 0.0)
    frames = static_cast<std::size_t>(
        std::clamp(opened.info.sample_rate_hz * wait_s, 1.0, double(kMostFrames)));
  else if (frames == 0)
    frames = options.latency_s > 0.0 ? 1 : kFramesWithoutRate;
  // libiio 0.24 sizes its buffer by a frame that may be too short (scan_format.h). A multiple of
  // the true frame makes the two end together, so that the kernel is never asked for half a frame.
  if (!opened.timestamp) {
    const std::size_t unit = compute_layout(opened.formats).frame_bytes;
    frames = (frames + unit - 1) / unit * unit;
  }
  return frames;
}

unsigned kernel_buffers(const OpenedDevice &opened, std::size_t frames) {
  const std::size_t frame_bytes = compute_layout(opened.formats).frame_bytes;
  const double rate = std::max(opened.info.sample_rate_hz, 20.0 * static_cast<double>(frames));
  unsigned count = static_cast<unsigned>(
      std::clamp(std::ceil(kKernelSeconds * rate / static_cast<double>(frames)), 4.0, 64.0));
  while (count > 1 && std::bit_ceil(frames * count) * frame_bytes > kKernelBytes)
    --count;
  return count;
}

IioSourceOptions named_as_found(const OpenedDevice &opened, const IioSourceOptions &options) {
  IioSourceOptions out = options;
  if (!opened.context)
    return out;
  // A label or a name that is the only one of its kind; the id may change from boot to boot.
  const std::vector<IioDevice> devices = opened.context->devices();
  const auto unique = [&](std::string IioDevice::*member) {
    const std::string &value = opened.device.*member;
    return !value.empty() && std::count_if(devices.begin(), devices.end(),
                                           [&](const auto &d) { return d.*member == value; }) == 1;
  };
  out.device = unique(&IioDevice::label)  ? opened.device.label
               : unique(&IioDevice::name) ? opened.device.name
                                          : opened.device.id;
  const auto id = [&](std::size_t i) {
    return opened.channel(i).label.empty() ? opened.channel(i).id : opened.channel(i).label;
  };
  out.channels.sin = id(opened.choice.sin);
  out.channels.cos = id(opened.choice.cos);
  out.channels.temp = opened.choice.temp ? id(*opened.choice.temp) : "";
  out.channels.vdd = opened.choice.vdd ? id(*opened.choice.vdd) : "";
  return out;
}

} // namespace ada
