// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/emulator.h"

#include <algorithm>
#include <cmath>

#include "acquisition/recording_source.h"
#include "base/error.h"
#include "recording/columns.h"
#include "simulation/emulated_device.h"

namespace ada {

namespace {

/// A simulation that is not quantised is served by a converter that hardly matters.
constexpr int kFineBits = 24;
/// The steps in which converters offer their rates.
constexpr double kRates[] = {100, 200, 500, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5};

ScanFormat unsigned_format(int bits) {
  ScanFormat format;
  format.bits = static_cast<unsigned>(bits);
  format.storage = bits <= 16 ? 16 : 32;
  return format;
}

/// Those that a bounded simulation can hold, and its own.
std::vector<double> rates_of(const SimulationOptions &o) {
  std::vector<double> rates{o.sample_rate_hz};
  for (const double rate : kRates)
    if (o.duration_s * rate <= kMostSimulatedSamples)
      rates.push_back(rate);
  std::sort(rates.begin(), rates.end());
  rates.erase(std::unique(rates.begin(), rates.end()), rates.end());
  return rates;
}

std::vector<EmulatedChannel> channels_of(const SimulationOptions &o) {
  const int bits = o.adc_bits > 0 ? o.adc_bits : kFineBits;
  const ScanFormat format = unsigned_format(bits);
  const double lsb_v = o.adc_reference_v / std::ldexp(1.0, bits);
  std::vector<EmulatedChannel> channels{{"vsin", &Frame::vsin_v, format, lsb_v},
                                        {"vcos", &Frame::vcos_v, format, lsb_v}};
  if (o.has_vtemp)
    channels.push_back({"vtemp", &Frame::vtemp_v, format, lsb_v});
  if (o.has_vdd)
    channels.push_back({"vdd", &Frame::vdd_v, format, 2.0 * lsb_v});
  return channels;
}

/// Whether every value is one of the codes of a converter, as near as a file keeps them.
bool are_codes(const std::vector<double> &volts, double lsb_v, double codes) {
  return std::all_of(volts.begin(), volts.end(), [&](double v) {
    const double code = v / lsb_v;
    return code > -0.5 && code < codes - 0.5 && std::fabs(code - std::round(code)) < 0.1;
  });
}

EmulatedChannel replayed_channel(const char *label, const Column &column, const Capture &capture) {
  const std::vector<double> &volts = capture.*column.values;
  const int bits = static_cast<int>(std::lround(capture.meta.adc_bits.value_or(0.0)));
  const double lsb_v = capture.meta.adc_reference_v.value_or(0.0) / std::ldexp(1.0, bits);
  if (bits > 0 && bits <= 32 && lsb_v > 0.0 && are_codes(volts, lsb_v, std::ldexp(1.0, bits)))
    return {label, column.field, unsigned_format(bits), lsb_v};
  double most = 0.0;
  for (const double v : volts)
    most = std::max(most, std::fabs(v));
  ScanFormat format;
  format.bits = format.storage = 32;
  format.is_signed = true;
  const int exponent = most > 0.0 ? std::ilogb(most) + 2 : 0; // 2^(exponent - 1) > most
  return {label, column.field, format, std::ldexp(1.0, exponent - 32)};
}

/// Of a recording that does not say it: samples over time.
double rate_of(const Capture &capture) {
  if (capture.meta.sample_rate_hz)
    return *capture.meta.sample_rate_hz;
  const double span_s = capture.time_s.back() - capture.time_s.front();
  return span_s > 0.0 ? static_cast<double>(capture.size() - 1) / span_s : 1.0;
}

} // namespace

std::shared_ptr<ServedContext> emulated_context(std::shared_ptr<const Simulation> simulation) {
  const SimulationOptions &o = simulation->options();
  EmulatedSensor sensor{"simulated ADA4571 of libada4571 " ADA4571_VERSION_STRING,
                        "ada4571-sim",
                        "simulated-" + std::to_string(simulation->seed()),
                        channels_of(o),
                        o.sample_rate_hz,
                        rates_of(o),
                        {}};
  sensor.play = [simulation](double rate_hz) {
    SimulationOptions options = simulation->options();
    options.sample_rate_hz = rate_hz;
    return Simulation(simulation->model(), options, simulation->seed()).source(false);
  };
  return emulated_context(std::move(sensor));
}

std::shared_ptr<ServedContext> replayed_context(std::shared_ptr<const Capture> capture,
                                                double speed) {
  check_speed(speed);
  if (capture->size() == 0)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, "the recording has no samples");
  constexpr const char *kLabels[] = {"vsin", "vcos", "vtemp", "vdd"};
  std::vector<EmulatedChannel> channels;
  for (std::size_t i = 0; i < std::size(kLabels); ++i)
    if (const Column &column = kColumns[1 + i]; !((*capture).*column.values).empty())
      channels.push_back(replayed_channel(kLabels[i], column, *capture));
  const double rate_hz = speed * rate_of(*capture);
  EmulatedSensor sensor{"recording played by libada4571 " ADA4571_VERSION_STRING,
                        "ada4571-replay",
                        capture->meta.serial,
                        std::move(channels),
                        rate_hz,
                        {rate_hz},
                        [capture](double) { return make_recording_source(capture); },
                        speed};
  sensor.time_s = [capture, speed, rate_hz](std::uint64_t frame) {
    const auto &times = capture->time_s;
    const auto i = static_cast<std::size_t>(std::min<std::uint64_t>(frame, times.size() - 1));
    return (times[i] - times.front()) / speed + static_cast<double>(frame - i) / rate_hz;
  };
  return emulated_context(std::move(sensor));
}

} // namespace ada
