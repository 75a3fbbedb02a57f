// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/simulated_source.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace ada {

namespace {
constexpr std::size_t kChunk = 1024;
}

SimulatedSource::SimulatedSource(const Simulation &simulation, bool realtime)
    : simulation_(simulation), pace_(realtime ? 1.0 : 0.0) {
  const SimulationOptions &o = simulation_.options();
  info_.description = "simulated sensor, seed " + std::to_string(simulation_.seed());
  info_.serial = "simulated-" + std::to_string(simulation_.seed());
  info_.sample_rate_hz = o.sample_rate_hz;
  info_.supply_v = simulation_.model().supply_v;
  info_.periods_per_turn = simulation_.model().periods_per_turn;
  info_.has_vtemp = o.has_vtemp;
  info_.has_vdd = o.has_vdd;
  info_.has_reference = o.has_reference;
  info_.gain_control = o.gain_control;
  if (o.adc_bits > 0)
    info_.adc_bits = o.adc_bits;
  total_ = static_cast<std::size_t>(std::llround(o.duration_s * o.sample_rate_hz));
}

void SimulatedSource::start() {
  generator_ = std::make_unique<Generator>(simulation_);
  // Effects that act on the record as a whole need it whole.
  chunk_ = total_ > 0 ? simulation_.run() : Capture{};
  generated_ = chunk_.size();
  next_in_chunk_ = 0;
  statistics_ = {};
  pace_.start();
  pace_.announce(due_s(0));
}

void SimulatedSource::stop() noexcept {
  generator_.reset();
  pace_.stop();
}

void SimulatedSource::refill() {
  if (total_ > 0)
    return;
  chunk_ = generator_->next(kChunk);
  generated_ += chunk_.size();
  next_in_chunk_ = 0;
}

ReadResult SimulatedSource::read(std::span<Frame> out, std::chrono::milliseconds timeout) {
  if (!generator_)
    throw Error(ADA4571_ERROR_STATE, "the source is not started");
  if (out.empty())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "room for at least one frame is needed");
  if (next_in_chunk_ == chunk_.size())
    refill();
  if (next_in_chunk_ == chunk_.size())
    return {ReadOutcome::end, 0};
  switch (pace_.wait(due_s(statistics_.frames), timeout)) {
  case Pace::Wake::cancelled:
    return {ReadOutcome::cancelled, 0};
  case Pace::Wake::timeout:
    return {ReadOutcome::timeout, 0};
  case Pace::Wake::due:
    break;
  }
  std::size_t count = std::min(out.size(), chunk_.size() - next_in_chunk_);
  // No frame before its time.
  const double due =
      std::floor(pace_.elapsed_s() * info_.sample_rate_hz) - static_cast<double>(statistics_.frames);
  if (due < static_cast<double>(count))
    count = static_cast<std::size_t>(std::max(1.0, due));
  for (std::size_t k = 0; k < count; ++k)
    out[k] = chunk_.frame(next_in_chunk_ + k);
  next_in_chunk_ += count;
  statistics_.frames += count;
  const bool last = total_ > 0 && statistics_.frames == total_; // the end comes with it
  pace_.announce(due_s(statistics_.frames - (last ? 1 : 0)));
  return {ReadOutcome::frames, count};
}

} // namespace ada
