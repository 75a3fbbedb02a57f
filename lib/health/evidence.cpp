// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/evidence.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/angle.h"
#include "base/error.h"
#include "base/robust.h"
#include "calibration/dead_channel.h"
#include "calibration/guards.h"
#include "calibration/single.h"
#include "conversion/frame_converter.h"
#include "health/criteria.h"
#include "health/spikes.h"
#include "recording/spread_sample.h"

namespace ada::health {

namespace {

/// Of two findings the one with more samples: the other channel may only have stood at a peak.
std::optional<StuckChannel> worse(std::optional<StuckChannel> a, std::optional<StuckChannel> b) {
  return !b || (a && a->samples >= b->samples) ? a : b;
}

/// A row of equal values that noise cannot leave; nothing where the stated noise is so small that
/// equal values are ordinary.
std::optional<StuckChannel> frozen(const CaptureMetadata &meta, const char *name,
                                   const Faults &same) {
  const auto step = stated_step(meta);
  if (!step || !meta.noise_rms_v || *meta.noise_rms_v < kFrozenNoiseSteps * *step)
    return std::nullopt;
  if (same.longest + 1 < kFrozenSamples)
    return std::nullopt;
  return StuckChannel{name, same.longest_first - 1, same.longest + 1, true};
}

/// Of the rows of both channels: what they share, else the longer one.
std::optional<StuckChannel> frozen(const CaptureMetadata &meta, const Tally &tally) {
  const auto sin = frozen(meta, "VSIN", tally.same_sin.faults());
  const auto cos = frozen(meta, "VCOS", tally.same_cos.faults());
  if (sin && cos) {
    const std::size_t first = std::max(sin->first, cos->first);
    const std::size_t end = std::min(sin->first + sin->samples, cos->first + cos->samples);
    if (end >= first + kFrozenSamples)
      return StuckChannel{"VSIN and VCOS", first, end - first, true};
  }
  return worse(sin, cos);
}

/// `own` against `other`, which moves.
std::optional<StuckChannel> stuck(const char *name, const std::vector<double> &own,
                                  double own_travel, const std::vector<double> &other,
                                  double other_travel) {
  if (own_travel < kStuckRatio * other_travel)
    return StuckChannel{name, 0, own.size()};
  if (const auto found = stuck_stretches(own, own_travel, other, other_travel))
    return StuckChannel{name, found->first, found->samples};
  return std::nullopt;
}

bool pair_turns(const Capture &capture) {
  return std::max(travel(capture.vsin_v), travel(capture.vcos_v)) >=
         kStillFraction * capture.meta.supply_v;
}

/// Whether the pair only stands at a few places and jumps between them: seen from the middle of
/// both channels it is found in no more directions than an ellipse has free parameters. The ellipse
/// itself cannot tell: where a channel stands for most of the time, the best one may be a huge
/// circle along that line, which sees it in one direction. A direction that holds one sample in a
/// thousand or fewer may be spikes.
bool stands_at_few_places(const Capture &c, std::size_t few) {
  constexpr std::size_t kCells = static_cast<std::size_t>(360 / kDirectionDeg), kSpikes = 1000;
  const Reach sin = bulk(c.vsin_v), cos = bulk(c.vcos_v);
  if (!(sin.width() > 0 && cos.width() > 0))
    return false;
  std::array<std::size_t, kCells> held{};
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double y = (c.vsin_v[i] - sin.low) / sin.width() - 0.5;
    const double x = (c.vcos_v[i] - cos.low) / cos.width() - 0.5;
    if (const double turn = wrap(std::atan2(y, x) / kTwoPi, 1.0); std::isfinite(turn))
      ++held[std::min(static_cast<std::size_t>(turn * kCells), kCells - 1)];
  }
  const std::size_t most = std::max<std::size_t>(c.size() / kSpikes, 3);
  return static_cast<std::size_t>(
             std::ranges::count_if(held, [&](std::size_t n) { return n > most; })) <= few;
}

/// The ellipse of the capture itself, or why there is none.
void find_ellipse(Evidence &e) {
  if (!e.turns) {
    e.no_ellipse = "the magnet does not turn";
    return;
  }
  try {
    e.ellipse = fit_ellipse(e.what);
  } catch (const Error &error) {
    if (error.status() != ADA4571_ERROR_UNUSABLE_DATA)
      throw;
    e.no_ellipse = error.what();
    return;
  }
  e.no_ellipse = why_no_circle(*e.ellipse);
  e.no_circle = !e.no_ellipse.empty();
  e.levels_only = e.no_circle && e.ellipse->directions <= e.ellipse->free_parameters &&
                  stands_at_few_places(e.capture, e.ellipse->free_parameters);
  if (e.no_circle)
    e.ellipse.reset();
}

void choose_yardstick(Evidence &e, const Model *model) {
  if (model != nullptr) {
    e.yardstick = *model;
    e.yardstick_name = "the given calibration";
    e.states_noise = true;
    return;
  }
  try {
    const double most_deg = kYardstickErrorDeg / e.capture.meta.periods_per_turn;
    e.yardstick = model_of(estimate_pair(e.what, CalibrationMethod::fit, most_deg), e.capture.meta,
                           "", "check");
    e.yardstick_name = "the ellipse that fits this capture";
    return;
  } catch (const Error &error) {
    if (error.status() != ADA4571_ERROR_UNUSABLE_DATA)
      throw;
  }
  Model nominal;
  nominal.periods_per_turn = e.capture.meta.periods_per_turn;
  e.yardstick = nominal.at_supply(e.capture.meta.supply_v);
  e.yardstick_name = "a nominal ADA4571 (amplitude 0.29 VDD)";
}

std::optional<StuckChannel> find_stuck(const Evidence &e) {
  const Capture &c = e.capture;
  const auto row = frozen(c.meta, e.tally);
  if (row || !e.turns)
    return row;
  if (e.levels_only)
    return std::nullopt; // a channel stays where it is between two jumps, and then the other one
  const std::vector<double> &sin = e.path_sin(), &cos = e.path_cos();
  const double sin_travel = travel(c.vsin_v), cos_travel = travel(c.vcos_v);
  auto found = worse(stuck("VSIN", sin, sin_travel, cos, cos_travel),
                     stuck("VCOS", cos, cos_travel, sin, sin_travel));
  if (!found || !e.what.is_long)
    return found;
  // Where it begins in the recording, and how many it stands for.
  const double share =
      static_cast<double>(e.what.recording.size()) / static_cast<double>(sin.size());
  found->first = e.path_place(found->first);
  found->samples = static_cast<std::size_t>(share * static_cast<double>(found->samples));
  return found;
}

} // namespace

std::optional<double> stated_step(const CaptureMetadata &meta) {
  if (!meta.adc_bits || !meta.adc_reference_v)
    return std::nullopt;
  return *meta.adc_reference_v / std::exp2(*meta.adc_bits);
}

std::size_t Evidence::path_place(std::size_t of_path) const {
  return what.is_long ? sample_place(what.recording.size(), kPathSamples, 1, of_path) : of_path;
}

Evidence gather(const RecordingToFit &what, const Model *model) {
  const Capture &capture = *what.sample;
  Evidence e{.what = what, .capture = capture};
  e.turns = pair_turns(capture);
  find_ellipse(e);
  choose_yardstick(e, model);
  e.angles.resize(capture.size());
  FrameConverter(e.yardstick).capture(capture, e.angles);
  e.usual_step_s = median_step(capture.time_s);
  const SpikeFinder spikes(capture, what.recording.size(), e.ellipse);
  e.tally = take_tally(what.recording, e.yardstick, spikes, VtempJumps(capture), e.usual_step_s);
  e.stuck = find_stuck(e);
  return e;
}

} // namespace ada::health
