// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/emulated_device.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>

#include "base/text.h"

namespace ada {

namespace {

/// After so long without a reading of `raw` its run begins anew: catching up takes time.
constexpr double kLongestPause_s = 10.0;

std::int64_t counts(const EmulatedChannel &channel, double volts) {
  const int bits = static_cast<int>(channel.format.bits);
  const double top = std::ldexp(1.0, bits - channel.format.is_signed) - 1.0;
  const double bottom = channel.format.is_signed ? -top - 1.0 : 0.0;
  return std::llround(std::clamp(std::round(volts / channel.volts_per_count), bottom, top));
}

/// The frames of one run in counts.
class SourceCounts final : public FrameCounts {
public:
  SourceCounts(std::vector<EmulatedChannel> channels, std::unique_ptr<Source> source)
      : channels_(std::move(channels)), source_(std::move(source)) {
    source_->start();
  }

  std::size_t next(std::span<std::int64_t> out, std::size_t frames) override {
    std::size_t done = 0;
    while (done < frames) {
      const std::size_t want = std::min(frames - done, block_.size());
      const ReadResult r = source_->read(std::span(block_).first(want), std::chrono::seconds(1));
      if (r.outcome != ReadOutcome::frames)
        break;
      for (std::size_t i = 0; i < r.count; ++i)
        for (std::size_t c = 0; c < channels_.size(); ++c)
          out[(done + i) * channels_.size() + c] =
              counts(channels_[c], block_[i].*channels_[c].member);
      done += r.count;
    }
    return done;
  }

private:
  std::vector<EmulatedChannel> channels_;
  std::unique_ptr<Source> source_;
  std::array<Frame, 1024> block_{};
};

/// What the converter gives now: a run that begins with the first reading and goes on by the clock.
class Present {
public:
  Frame now(const EmulatedSensor &sensor, double rate_hz) {
    const auto clock = Clock::now();
    const std::chrono::duration<double> pause = clock - last_read_;
    if (!source_ || rate_hz != rate_hz_ || pause.count() > kLongestPause_s)
      begin(sensor, rate_hz);
    last_read_ = clock;
    const std::chrono::duration<double> since = clock - began_;
    const double due_s = block_first_s_ + sensor.speed * since.count();
    while (due_s >= next_due_s())
      if (!advance()) { // at its end: from the beginning
        begin(sensor, rate_hz);
        break;
      }
    return frame_;
  }

private:
  using Clock = std::chrono::steady_clock;

  void begin(const EmulatedSensor &sensor, double rate_hz) {
    source_ = sensor.play(rate_hz);
    source_->start();
    rate_hz_ = rate_hz;
    began_ = Clock::now();
    used_ = there_ = 0;
    advance();
    block_first_s_ = frame_.time_s;
  }

  double next_due_s() { return fill() ? block_[used_].time_s : -HUGE_VAL; }

  bool fill() {
    if (used_ < there_)
      return true;
    const ReadResult r = source_->read(block_, std::chrono::seconds(1));
    used_ = 0;
    there_ = r.outcome == ReadOutcome::frames ? r.count : 0;
    return there_ > 0;
  }

  bool advance() {
    if (!fill())
      return false;
    frame_ = block_[used_++];
    return true;
  }

  std::unique_ptr<Source> source_;
  double rate_hz_ = 0.0, block_first_s_ = 0.0;
  Clock::time_point began_{}, last_read_{};
  std::array<Frame, 1024> block_{};
  std::size_t used_ = 0, there_ = 0;
  Frame frame_ = empty_frame();
};

int any_number(const std::string &text) {
  return parse_number(text) ? 0 : EINVAL;
}
int positive_number(const std::string &text) {
  return parse_number(text).value_or(0.0) > 0.0 ? 0 : EINVAL;
}

/// All that the attributes of one device share; guarded by the context's mutex.
struct Shared {
  EmulatedSensor sensor;
  Present present{};
  ServedDevice *device = nullptr; ///< in the context, whose attributes hold this

  Frame now() { return present.now(sensor, device->rate_hz); }

  /// As a driver: only what the converter can do, and not while it captures.
  int set_rate(const std::string &text) {
    const auto wanted = parse_number(text);
    if (!wanted || std::find(sensor.rates.begin(), sensor.rates.end(), *wanted) ==
                       sensor.rates.end())
      return EINVAL;
    if (device->open_buffers > 0)
      return EBUSY;
    device->rate_hz = *wanted;
    return 0;
  }
};

ServedAttribute rate_attribute(const std::shared_ptr<Shared> &shared) {
  return {"sampling_frequency", "", [shared] { return in_full(shared->device->rate_hz); },
          [shared](const std::string &text) { return shared->set_rate(text); }};
}

ServedAttribute available_rates(const EmulatedSensor &sensor) {
  std::string text;
  for (const double rate : sensor.rates)
    text += (text.empty() ? "" : " ") + in_full(rate);
  return {"sampling_frequency_available", text};
}

ServedChannel served_channel(const std::shared_ptr<Shared> &shared, std::size_t i) {
  const EmulatedChannel &channel = shared->sensor.channels[i];
  const double scale_mv = 1e3 * channel.volts_per_count;
  const auto raw = [shared, i] {
    const EmulatedChannel &c = shared->sensor.channels[i];
    return std::to_string(counts(c, shared->now().*c.member));
  };
  return {"voltage" + std::to_string(i),
          static_cast<int>(i),
          channel.format,
          scale_mv,
          {{"calibbias", "0", {}, any_number},
           {"calibscale", "1", {}, positive_number},
           {"label", channel.label},
           {"offset", "0"},
           {"raw", "", raw},
           {"scale", in_full(scale_mv)}}};
}

} // namespace

std::shared_ptr<ServedContext> emulated_context(EmulatedSensor wanted) {
  const auto shared = std::make_shared<Shared>(Shared{std::move(wanted)});
  const EmulatedSensor &sensor = shared->sensor;
  ServedDevice device{"iio:device0", sensor.device, "", {}, {}, sensor.rate_hz};
  for (std::size_t i = 0; i < sensor.channels.size(); ++i)
    device.channels.push_back(served_channel(shared, i));
  ScanFormat stamp;
  stamp.bits = stamp.storage = 64;
  stamp.is_signed = true;
  device.channels.push_back(
      {"timestamp", static_cast<int>(sensor.channels.size()), stamp, std::nullopt, {}});
  device.attributes = {{"current_timestamp_clock", "realtime"},
                       rate_attribute(shared),
                       available_rates(sensor)};
  device.time_s = sensor.time_s;
  device.frames = [shared] {
    return std::make_unique<SourceCounts>(shared->sensor.channels,
                                          shared->sensor.play(shared->device->rate_hz));
  };
  auto context = std::make_shared<ServedContext>();
  context->description = sensor.description;
  context->attributes = {{"hw_serial", sensor.serial}};
  context->devices.push_back(std::move(device));
  context->devices.push_back(
      {"trigger0", "simulated-timer", "", {}, {rate_attribute(shared)}, 0.0});
  shared->device = &context->devices.front();
  return context;
}

} // namespace ada
