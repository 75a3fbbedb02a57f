// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/live.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include "common/file_roles.h"
#include "common/print.h"

namespace cli {

namespace {

constexpr std::size_t kBlockFrames = 4096;
constexpr int kPollMs = 200;
constexpr int kRetryMs = 1000;

/// The device or its server may come back from that.
bool is_absence(ada4571_status status) {
  return status == ADA4571_ERROR_DISCONNECTED || status == ADA4571_ERROR_NOT_FOUND ||
         status == ADA4571_ERROR_BUSY || status == ADA4571_ERROR_IO;
}

Model ideal_model(const Source &source) {
  const auto info = source_info(source);
  auto baseline = initialised(ada4571_baseline_init);
  baseline.amplitude_v *= info.supply_v / baseline.supply_v;
  baseline.supply_v = info.supply_v;
  baseline.periods_per_turn = info.periods_per_turn;
  return make<Model>(ada4571_model_new, &baseline);
}

/// What the stored configuration or the driver has.
Model stored_model(const Source &source) {
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

ada4571_baseline baseline_of(const Model &model) {
  auto baseline = initialised(ada4571_baseline_init);
  check(ada4571_model_get_baseline(model.get(), &baseline));
  return baseline;
}

} // namespace

LiveReader::LiveReader(const Source &source, bool reconnect, std::chrono::seconds patience)
    : source_(source), reconnect_(reconnect), patience_(patience),
      stop_([&source] { ada4571_source_cancel(source.get()); }) {}

void LiveReader::greet_return(double first_s) {
  const double away_s = std::chrono::duration<double>(Clock::now() - last_).count();
  shift_s_ = any_ ? last_s_ + away_s - first_s : 0.0;
  const auto missed =
      static_cast<std::uint64_t>(std::max(0.0, away_s * source_info(source_).sample_rate_hz - 1));
  ++before_.returns;
  before_.missed += missed;
  note("back after {:.1f} s: about {} samples missed\n", away_s, missed);
}

bool LiveReader::hand_over(const Came &came, const Hand &hand) {
  if (came.count > 0) {
    if (away_)
      greet_return(came.first_s);
    last_ = Clock::now();
    last_s_ = came.last_s + shift_s_;
    any_ = true;
  }
  const bool wanted = hand(came.count);
  if (came.count > 0)
    away_ = false;
  return wanted;
}

void LiveReader::end_connection() {
  before_ = losses();
  counted_ = true;
}

bool LiveReader::wait_for_return(const std::string &why, const Hand &hand) {
  end_connection();
  if (!away_)
    note("lost: {}; trying again every second\n", why);
  away_ = true;
  for (;;) {
    for (int i = 0; i < kRetryMs / kPollMs; ++i) {
      if (StopSignal::requested() || !hand(0))
        return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(kPollMs));
    }
    const ada4571_status status = ada4571_source_start(source_.get());
    counted_ = status != ADA4571_OK;
    if (status == ADA4571_OK)
      return true;
    // A device that was just plugged in belongs to root until udev has seen it.
    if (!is_absence(status) && status != ADA4571_ERROR_PERMISSION)
      check(status);
  }
}

void LiveReader::run(const std::function<bool(std::span<const ada4571_frame>)> &take) {
  std::vector<ada4571_frame> frames(kBlockFrames);
  const auto read = [&](Came &came, ada4571_read_outcome &outcome) {
    const ada4571_status status = ada4571_source_read(source_.get(), frames.data(), frames.size(),
                                                      kPollMs, &came.count, &outcome);
    if (came.count > 0) {
      came.first_s = frames.front().time_s;
      came.last_s = frames[came.count - 1].time_s;
    }
    return status;
  };
  loop(read, [&](std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      frames[i].time_s += shift_s_;
    return take({frames.data(), count});
  });
}

void LiveReader::run_blocks(const std::function<bool(const DeviceBlock &)> &take) {
  auto block = initialised(ada4571_block_init);
  const auto read = [&](Came &came, ada4571_read_outcome &outcome) {
    const ada4571_status status =
        ada4571_source_read_block(source_.get(), SIZE_MAX, kPollMs, &block, &outcome);
    if (status == ADA4571_OK)
      came = {block.count, block.first_time_s, block.last_time_s};
    return status;
  };
  loop(read, [&](std::size_t count) {
    return take({count, block.first_time_s + shift_s_, block.last_time_s + shift_s_, shift_s_});
  });
}

void LiveReader::loop(const Read &read, const Hand &hand) {
  check(ada4571_source_start(source_.get()));
  counted_ = false;
  last_ = Clock::now();
  Clock::time_point heard = last_; // or a new connection made
  while (!StopSignal::requested()) {
    Came came;
    ada4571_read_outcome outcome = ADA4571_READ_END;
    const ada4571_status status = read(came, outcome);
    const bool silent = status == ADA4571_OK && came.count == 0 && Clock::now() - heard > patience_;
    // Where no sample ever came, waiting will not bring one.
    if (reconnect_ && (is_absence(status) || (silent && any_))) {
      if (!wait_for_return(silent ? "no sample came for 10 s" : ada4571_last_error(), hand))
        break;
      heard = Clock::now();
      continue;
    }
    check(status);
    ended_ = outcome == ADA4571_READ_END;
    if (ended_ || outcome == ADA4571_READ_CANCELLED)
      break;
    if (silent)
      throw Failure(kUnusable, any_ ? "no more samples came for 10 s: has the trigger stopped, or "
                                      "does the server play a recording with a gap?"
                                    : "no sample came for 10 s: is the trigger set and running "
                                      "(--trigger), and the sample rate not zero (--rate)?");
    if (came.count > 0)
      heard = Clock::now();
    if (!hand_over(came, hand))
      break;
  }
  end_connection();
  check(ada4571_source_stop(source_.get()));
}

Losses LiveReader::losses() const {
  Losses all = before_;
  if (counted_)
    return all;
  auto statistics = initialised(ada4571_source_statistics_init);
  check(ada4571_source_get_statistics(source_.get(), &statistics));
  all.frames += statistics.frames;
  all.bad_times += statistics.bad_times;
  all.samples += statistics.lost;
  all.places += statistics.gaps;
  return all;
}

void LiveReader::report() const {
  const Losses all = losses();
  // A capture that was named ends as a file does. Of a device nobody expects it.
  if (ended_ && source_info(source_).buffer_frames > 0)
    note("the samples are over: the server plays a recording, or a simulation of limited "
         "duration\n");
  if (all.bad_times > 0)
    note("{} of {} samples came with timestamps that make no sense (standing still, going back, or "
         "leaping ahead): their times are from the sample rate\n",
         all.bad_times, all.frames);
  if (all.samples > 0)
    note("{} samples were lost in {} places: lower the rate, or free the machine\n", all.samples,
         all.places);
  if (all.returns > 0)
    note("{} times away, about {} samples missed meanwhile\n", all.returns, all.missed);
}

std::chrono::seconds patience(const SourceOptions &source) {
  return source.replays() ? std::chrono::hours(24 * 365) : std::chrono::seconds(10);
}

void add_reconnect_option(CLI::App &verb, bool &reconnect) {
  auto *wait =
      verb.add_flag("--reconnect", reconnect,
                    std::string("when the device or server is lost, wait until it is back") +
                        (reconnect ? " (default)" : ""));
  verb.add_flag_callback(
          "--no-reconnect", [&reconnect] { reconnect = false; },
          std::string("end with status 1 instead") + (reconnect ? "" : " (default)"))
      ->excludes(wait);
}

void add_live_options(CLI::App &verb, SourceOptions &source, std::string &calibration) {
  add_source_options(verb, source, "the calibration's, or ");
  add_replay_options(verb, source.capture, source.speed);
  verb.add_option("--calibration", calibration,
                  "calibration or model file (default: what -s or the driver has)")
      ->type_name("FILE");
}

Live open_live(const SourceOptions &options, const std::string &calibration) {
  if (calibration.empty()) {
    Source source = open_source(options);
    Model model = stored_model(source);
    return {std::move(source), std::move(model)};
  }
  const Model model = load_model(calibration);
  const auto baseline = baseline_of(model);
  SourceOptions said = options;
  if (!(said.supply_v > 0))
    said.supply_v = baseline.supply_v;
  if (said.periods_per_turn == 0)
    said.periods_per_turn = baseline.periods_per_turn;
  Source source = open_source(said);
  Model here = make<Model>(ada4571_model_for_source, model.get(),
                           static_cast<const ada4571_source *>(source.get()));
  return {std::move(source), std::move(here)};
}

double angle_range_deg(const Model &model) {
  return 360.0 / baseline_of(model).periods_per_turn;
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
