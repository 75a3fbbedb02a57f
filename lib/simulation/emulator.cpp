// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/emulator.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>

namespace ada {

namespace {

/// A simulation that is not quantised is served by a converter that hardly matters.
constexpr int kFineBits = 24;

struct Converter {
  int bits;
  double reference_v;

  double lsb_v() const { return reference_v / std::ldexp(1.0, bits); }
  std::int64_t counts(double volts) const {
    const double top = std::ldexp(1.0, bits) - 1.0;
    return std::llround(std::clamp(std::round(volts / lsb_v()), 0.0, top));
  }
};

struct Signal {
  const char *label;
  double Frame::*member;
  double divider; ///< volts at the sensor = divider * volts at the converter
};

std::vector<Signal> signals_of(const Simulation &simulation) {
  std::vector<Signal> signals{{"vsin", &Frame::vsin_v, 1.0}, {"vcos", &Frame::vcos_v, 1.0}};
  if (simulation.options().has_vtemp)
    signals.push_back({"vtemp", &Frame::vtemp_v, 1.0});
  if (simulation.options().has_vdd)
    signals.push_back({"vdd", &Frame::vdd_v, 2.0});
  return signals;
}

Converter converter_of(const Simulation &simulation) {
  const SimulationOptions &o = simulation.options();
  return {o.adc_bits > 0 ? o.adc_bits : kFineBits, o.adc_reference_v};
}

/// The frames of one run of the simulation in counts.
class SimulatedCounts final : public FrameCounts {
public:
  explicit SimulatedCounts(std::shared_ptr<const Simulation> simulation)
      : simulation_(std::move(simulation)), signals_(signals_of(*simulation_)),
        converter_(converter_of(*simulation_)), source_(simulation_->source(false)) {
    source_->start();
  }

  std::size_t next(std::span<std::int64_t> counts, std::size_t frames) override {
    std::size_t done = 0;
    while (done < frames) {
      const std::size_t want = std::min(frames - done, block_.size());
      const ReadResult r = source_->read(std::span(block_).first(want), std::chrono::seconds(1));
      if (r.outcome != ReadOutcome::frames)
        break;
      for (std::size_t i = 0; i < r.count; ++i)
        for (std::size_t s = 0; s < signals_.size(); ++s)
          counts[(done + i) * signals_.size() + s] =
              converter_.counts(block_[i].*signals_[s].member / signals_[s].divider);
      done += r.count;
    }
    return done;
  }

private:
  std::shared_ptr<const Simulation> simulation_;
  std::vector<Signal> signals_;
  Converter converter_;
  std::unique_ptr<Source> source_;
  std::array<Frame, 1024> block_{};
};

/// The raw attributes: each reading of a channel gives its count in the next frame of a run of
/// their own, so that equally many readings of two channels belong together.
class RawReader {
public:
  RawReader(std::shared_ptr<const Simulation> simulation, std::size_t channel)
      : simulation_(std::move(simulation)), channel_(channel),
        row_(signals_of(*simulation_).size()) {}

  std::int64_t next() {
    if (!run_)
      run_ = std::make_unique<SimulatedCounts>(simulation_);
    if (run_->next(row_, 1) == 0) { // at its end: from the beginning
      run_ = std::make_unique<SimulatedCounts>(simulation_);
      run_->next(row_, 1);
    }
    return row_[channel_];
  }

private:
  std::shared_ptr<const Simulation> simulation_;
  std::size_t channel_;
  std::vector<std::int64_t> row_;
  std::unique_ptr<SimulatedCounts> run_;
};

std::string decimal(double value) {
  std::array<char, 400> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  return {text.data(), end.ptr};
}

std::optional<double> number(const std::string &text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

int any_number(const std::string &text) {
  return number(text) ? 0 : EINVAL;
}
int positive_number(const std::string &text) {
  return number(text).value_or(0.0) > 0.0 ? 0 : EINVAL;
}

} // namespace

std::shared_ptr<ServedContext> emulated_context(std::shared_ptr<const Simulation> simulation) {
  const Converter converter = converter_of(*simulation);
  const std::vector<Signal> signals = signals_of(*simulation);
  const double rate = simulation->options().sample_rate_hz;

  ServedDevice device{"iio:device0", "ada4571-sim", "", {}, {}, rate, {}, {}};
  ScanFormat format;
  format.bits = static_cast<unsigned>(converter.bits);
  format.storage = converter.bits <= 16 ? 16 : 32;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    auto raw = std::make_shared<RawReader>(simulation, i);
    const double scale_mv = 1e3 * converter.lsb_v() * signals[i].divider;
    device.channels.push_back({"voltage" + std::to_string(i),
                               static_cast<int>(i),
                               format,
                               scale_mv,
                               {{"calibbias", "0", {}, any_number},
                                {"calibscale", "1", {}, positive_number},
                                {"label", signals[i].label, {}, {}},
                                {"offset", "0", {}, {}},
                                {"raw", "", [raw] { return std::to_string(raw->next()); }, {}},
                                {"scale", decimal(scale_mv), {}, {}}}});
  }
  ScanFormat stamp;
  stamp.bits = stamp.storage = 64;
  stamp.is_signed = true;
  device.channels.push_back(
      {"timestamp", static_cast<int>(signals.size()), stamp, std::nullopt, {}});
  device.attributes = {{"current_timestamp_clock", "realtime", {}, {}},
                       {"sampling_frequency", decimal(rate), {}, [rate](const std::string &text) {
                          return number(text) == rate ? 0 : EINVAL;
                        }}};
  device.frames = [simulation] { return std::make_unique<SimulatedCounts>(simulation); };

  auto context = std::make_shared<ServedContext>();
  context->description = "simulated ADA4571 of libada4571 " ADA4571_VERSION_STRING;
  context->attributes = {{"hw_serial", "simulated-" + std::to_string(simulation->seed())}};
  context->devices.push_back(std::move(device));
  context->devices.push_back({"trigger0",
                              "simulated-timer",
                              "",
                              {},
                              {{"sampling_frequency", decimal(rate), {}, {}}},
                              0.0,
                              {},
                              {}});
  return context;
}

} // namespace ada
