// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/live.h"

#include <chrono>
#include <string>

#include "common/print.h"
#include "common/source_options.h"
#include "common/stop.h"

namespace cli {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kBlockFrames = 4096;
constexpr int kPollMs = 200;
constexpr std::chrono::seconds kPatience{10};

Model ideal_model(const Source &source) {
  const auto info = source_info(source);
  auto baseline = initialised(ada4571_baseline_init);
  baseline.amplitude_v *= info.supply_v / baseline.supply_v;
  baseline.supply_v = info.supply_v;
  baseline.periods_per_turn = info.periods_per_turn;
  return make<Model>(ada4571_model_new, &baseline);
}

} // namespace

void read_blocks(const Source &source,
                 const std::function<bool(std::span<const ada4571_frame>)> &take) {
  const StopSignal stop([&source] { ada4571_source_cancel(source.get()); });
  read_until_stopped(source, take);
}

void read_until_stopped(const Source &source,
                        const std::function<bool(std::span<const ada4571_frame>)> &take) {
  check(ada4571_source_start(source.get()));
  std::vector<ada4571_frame> frames(kBlockFrames);
  Clock::time_point last = Clock::now();
  bool wanted = true;
  while (wanted && !StopSignal::requested()) {
    std::size_t count = 0;
    ada4571_read_outcome outcome = ADA4571_READ_END;
    check(
        ada4571_source_read(source.get(), frames.data(), frames.size(), kPollMs, &count, &outcome));
    if (outcome == ADA4571_READ_END || outcome == ADA4571_READ_CANCELLED)
      break;
    if (count > 0)
      last = Clock::now();
    else if (Clock::now() - last > kPatience)
      throw Failure(kUnusable, "no sample came for 10 s: is the trigger set and running "
                               "(--trigger), and the sample rate not zero (--rate)?");
    wanted = take({frames.data(), count});
  }
  check(ada4571_source_stop(source.get()));
}

Model live_model(const Source &source, const std::string &path) {
  if (!path.empty())
    return make<Model>(ada4571_model_load, path.c_str());
  ada4571_model *model = nullptr;
  const ada4571_status status = ada4571_source_read_calibration(source.get(), &model);
  if (status == ADA4571_OK)
    return Model(model);
  if (status != ADA4571_ERROR_NOT_FOUND && status != ADA4571_ERROR_UNSUPPORTED)
    check(status);
  note("no calibration: angles may be off by some degrees "
       "(record, calibrate, then give --calibration FILE)\n");
  return ideal_model(source);
}

double angle_range_deg(const Model &model) {
  auto baseline = initialised(ada4571_baseline_init);
  check(ada4571_model_get_baseline(model.get(), &baseline));
  return 360.0 / baseline.periods_per_turn;
}

void mention_remainder(const Model &model) {
  auto remainder = initialised(ada4571_remainder_init);
  check(ada4571_model_get_remainder(model.get(), &remainder));
  if (remainder.present)
    note("unnamed: the model also takes out what repeats with the angle and no effect "
         "explains, {:.3g} mV rms, up to order {} of {}\n",
         1e3 * remainder.rms_v, remainder.highest_order,
         remainder.electrical ? "the electrical period" : "the turn");
}

LiveAngles::LiveAngles(const Model &model, bool dynamic)
    : range_deg_(angle_range_deg(model)), angles_(kBlockFrames) {
  if (dynamic)
    tracker_ = make<Tracker>(ada4571_tracker_new, model.get(),
                             static_cast<const ada4571_tracker_options *>(nullptr));
  else
    converter_ = make<Converter>(ada4571_converter_new, model.get());
}

std::span<const ada4571_angle> LiveAngles::convert(std::span<const ada4571_frame> frames) {
  if (angles_.size() < frames.size())
    angles_.resize(frames.size());
  check(tracker_
            ? ada4571_tracker_frames(tracker_.get(), frames.data(), frames.size(), angles_.data())
            : ada4571_converter_frames(converter_.get(), frames.data(), frames.size(),
                                       angles_.data()));
  return {angles_.data(), frames.size()};
}

} // namespace cli
