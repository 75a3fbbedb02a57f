// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/evidence.h"

#include <algorithm>
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

namespace ada::health {

namespace {

/// First of a row of equal values that noise cannot leave; nothing where the stated noise is so
/// small that equal values are ordinary.
std::optional<StuckChannel> frozen(const Capture &capture, const char *name,
                                   const std::vector<double> &v) {
  const CaptureMetadata &meta = capture.meta;
  if (!meta.noise_rms_v || !meta.adc_bits || !meta.adc_reference_v ||
      *meta.noise_rms_v < kFrozenNoiseSteps * *meta.adc_reference_v / std::exp2(*meta.adc_bits))
    return std::nullopt;
  std::size_t row = 1;
  for (std::size_t i = 1; i < v.size(); ++i) {
    row = v[i] == v[i - 1] ? row + 1 : 1;
    if (row == kFrozenSamples)
      return StuckChannel{name, i + 1 - row, row};
  }
  return std::nullopt;
}

/// `own` against `other`, which moves.
std::optional<StuckChannel> stuck(const char *name, const std::vector<double> &own,
                                  const std::vector<double> &other) {
  const double own_travel = travel(own), other_travel = travel(other);
  if (own_travel < kStuckRatio * other_travel)
    return StuckChannel{name, 0, own.size()};
  if (const auto found = stuck_stretches(own, own_travel, other, other_travel))
    return StuckChannel{name, found->first, found->samples};
  return std::nullopt;
}

/// Of two findings the one with more samples: the other channel may only have stood at a peak.
std::optional<StuckChannel> worse(std::optional<StuckChannel> a, std::optional<StuckChannel> b) {
  return !b || (a && a->samples >= b->samples) ? a : b;
}

bool pair_turns(const Capture &capture) {
  return std::max(travel(capture.vsin_v), travel(capture.vcos_v)) >=
         kStillFraction * capture.meta.supply_v;
}

/// The ellipse of the capture itself, or why there is none.
void find_ellipse(Evidence &e) {
  if (!e.turns) {
    e.no_ellipse = "the magnet does not turn";
    return;
  }
  try {
    e.ellipse = fit_ellipse(e.capture.vsin_v, e.capture.vcos_v);
  } catch (const Error &error) {
    if (error.status() != ADA4571_ERROR_UNUSABLE_DATA)
      throw;
    e.no_ellipse = error.what();
    return;
  }
  e.no_ellipse = why_no_circle(*e.ellipse);
  e.no_circle = !e.no_ellipse.empty();
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
    e.yardstick = model_of(estimate_pair(e.capture, CalibrationMethod::fit), e.capture, "check");
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

} // namespace

std::optional<StuckChannel> find_stuck(const Capture &capture) {
  const auto row =
      worse(frozen(capture, "VSIN", capture.vsin_v), frozen(capture, "VCOS", capture.vcos_v));
  if (row || !pair_turns(capture))
    return row;
  return worse(stuck("VSIN", capture.vsin_v, capture.vcos_v),
               stuck("VCOS", capture.vcos_v, capture.vsin_v));
}

Evidence gather(const Capture &capture, const Model *model) {
  Evidence e{.capture = capture};
  e.turns = pair_turns(capture);
  find_ellipse(e);
  choose_yardstick(e, model);
  e.angles.resize(capture.size());
  FrameConverter(e.yardstick).capture(capture, e.angles);
  e.stuck = find_stuck(capture);
  e.spikes = pair_spikes(capture, e.ellipse);
  return e;
}

} // namespace ada::health
