// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "base/angle.h"
#include "base/frame.h"
#include "base/robust.h"
#include "base/text.h"
#include "health/checks.h"
#include "health/criteria.h"
#include "health/even_rows.h"
#include "motion/own_vector.h"
#include "recording/capture_file.h"

namespace ada::health {

namespace {

HealthCheck gaps_fault(double measured, double limit, std::string unit, std::string explanation) {
  return verdict("gaps", false, measured, limit, std::move(unit), std::move(explanation));
}

/// Samples that share their time: all, so many that the times are rounded, or some.
HealthCheck standing_time(const Evidence &e) {
  const Recording &c = e.what.recording;
  const TimeSteps &s = e.tally.steps;
  const auto standing = static_cast<double>(s.standing), all = static_cast<double>(c.size());
  const double moments = all - standing;
  std::string why;
  if (s.standing + 1 == c.size())
    why = fmt::format("all samples have the same time, {}", moment(c, 0));
  else if (standing > moments)
    why = fmt::format("time is given in steps of {:.3g} s, with about {:.0f} samples to each: too "
                      "coarse to show missing samples, or any speed",
                      e.usual_step_s, all / moments);
  else
    why = fmt::format("time does not grow from sample to sample: {} times, first at {}", s.standing,
                      moment(c, s.first_standing));
  return gaps_fault(standing, 0, "steps", why);
}

/// Stretches between gaps where the pair rests in each and moves from one to the next, as of a
/// table that is read where it stops; `lost`: gaps over which it did not move. No stops: it does
/// not rest.
struct Rests {
  std::size_t stops = 0, lost = 0;
};

Rests rests_between_gaps(const Evidence &e) {
  constexpr std::size_t kFewest = 5;
  constexpr double kAtRest = 0.2; // of the way between two stops
  constexpr double kNearlyAll = 0.9;
  constexpr double kPause = 1.5; // usual steps, as of a gap
  if (e.what.is_long || e.tally.steps.gaps + 1 < kFewest)
    return {};
  const Capture &c = e.capture;
  std::vector<double> moved, within;
  double last_sin = 0, last_cos = 0;
  for (std::size_t from = 0, to = 0; from < c.size(); from = to) {
    double sin = 0, cos = 0, off2 = 0;
    for (to = from;
         to < c.size() && (to == from || c.time_s[to] - c.time_s[to - 1] < kPause * e.usual_step_s);
         ++to) {
      sin += c.vsin_v[to];
      cos += c.vcos_v[to];
    }
    const double n = static_cast<double>(to - from);
    sin /= n;
    cos /= n;
    for (std::size_t i = from; i < to; ++i)
      off2 += std::pow(c.vsin_v[i] - sin, 2) + std::pow(c.vcos_v[i] - cos, 2);
    within.push_back(std::sqrt(off2 / n));
    if (from > 0)
      moved.push_back(std::hypot(sin - last_sin, cos - last_cos));
    last_sin = sin;
    last_cos = cos;
  }
  const double usual = quantile(moved, 0.5);
  const auto lost = static_cast<std::size_t>(
      std::count_if(moved.begin(), moved.end(), [&](double x) { return x < kAtRest * usual; }));
  std::erase_if(moved, [&](double x) { return x < kAtRest * usual; });
  if (moved.size() + 1 < kFewest ||
      !(quantile(std::move(within), kNearlyAll) < kAtRest * quantile(moved, 1 - kNearlyAll)))
    return {};
  return {moved.size() + 1, lost};
}

/// Rows between two pauses where the pair turns, and over a pause no further than from row to row:
/// the stamps are those of a delivery. 0: it does not turn, or it turns on while no row is read.
double rows_of_a_delivery(const Evidence &e) {
  constexpr double kPause = 1.5; // usual steps, as of a gap
  constexpr double kLong = 4.0;  // usual steps, in which a shaft goes clearly further than in one
  constexpr double kAsFar = 2.0; // ways of a step
  constexpr double kTurns = 0.5; // of the way to and fro leads on: noise makes far less
  constexpr std::size_t kFewest = 5;
  if (e.what.is_long || e.tally.steps.gaps < kFewest)
    return 0.0;
  const Capture &c = e.capture;
  const OwnVector own = own_vector(c);
  const auto took = [&](std::size_t i) { return (c.time_s[i] - c.time_s[i - 1]) / e.usual_step_s; };
  // A pair comes round between two places of the shaft.
  const auto moved = [&](std::size_t i) {
    return c.has_reference()
               ? wrap_centred(c.reference_deg[i] - c.reference_deg[i - 1], 360.0) * kRadPerDeg
               : wrap_centred(own.angle[i] - own.angle[i - 1], kTwoPi);
  };
  std::vector<double> over, within, beside; // beside a pause a shaft that rests there slows down
  double on = 0.0, way = 0.0;
  for (std::size_t i = 1; i < c.size(); ++i) {
    const double move = moved(i);
    if (!std::isfinite(move))
      continue;
    if (took(i) > kLong)
      over.push_back(std::abs(move));
    else if (took(i) < kPause) {
      within.push_back(std::abs(move));
      on += move;
      way += std::abs(move);
      if ((i > 1 && took(i - 1) > kLong) || (i + 1 < c.size() && took(i + 1) > kLong))
        beside.push_back(std::abs(move));
    }
  }
  if (over.size() < kFewest || within.size() < kFewest || beside.size() < kFewest ||
      !(std::abs(on) > kTurns * way) || !(quantile(over, 0.5) < kAsFar * quantile(within, 0.5)) ||
      !(kAsFar * quantile(beside, 0.5) > quantile(within, 0.5)))
    return 0.0;
  return static_cast<double>(c.size()) / static_cast<double>(over.size() + 1);
}

} // namespace

HealthCheck check_gaps(const Evidence &e) {
  const Recording &c = e.what.recording;
  const TimeSteps &s = e.tally.steps;
  if (s.back > 0)
    return gaps_fault(static_cast<double>(s.back), 0, "steps",
                      fmt::format("time goes back or is no number: {} times, first at {}", s.back,
                                  moment(c, s.first_back)));
  if (s.standing > 0)
    return standing_time(e);
  if (e.usual_step_s < kShortestStep)
    return gaps_fault(e.usual_step_s, kShortestStep, "s",
                      fmt::format("time grows by {:.3g} s a sample, less than a recording can tell",
                                  e.usual_step_s));
  if (c.meta().sample_rate_hz && !times_follow_rate(e.capture))
    return gaps_fault(
        e.usual_step_s, kAbsent, "s",
        fmt::format("time grows by {:.3g} s a sample, but sample_rate_hz says {:.3g} s: "
                    "one of them is wrong",
                    e.usual_step_s, 1 / *c.meta().sample_rate_hz));
  if (const Rests rests = rests_between_gaps(e); rests.stops > 0) {
    const std::string read =
        fmt::format("the pair is read where it rests, {} times, up to {:.3g} s apart", rests.stops,
                    s.longest_gap_s);
    return verdict("gaps", rests.lost == 0, static_cast<double>(rests.lost), 0, "gaps",
                   rests.lost == 0 ? read + "; no sample is missing there"
                                   : fmt::format("{}; within a rest samples are missing {} times",
                                                 read, rests.lost));
  }
  if (const double rows = rows_of_a_delivery(e); rows > 0.0)
    return gaps_fault(
        rows, 1, "rows",
        fmt::format("time stamps come in batches of about {:.3g} rows, up to {:.3g} s apart, over "
                    "which the pair turns on from row to row: they say when rows were delivered, "
                    "and show neither missing samples nor any speed",
                    rows, s.longest_gap_s));
  if (s.gaps > 0 && !e.what.is_long)
    if (const auto even = even_rows(e.capture))
      return verdict(
          "gaps", true, even->rms_s, kAbsent, "s",
          fmt::format("no sample is missing: the time stamps come back to an even clock, "
                      "from which they scatter by {:.3g} s rms, and say when a row was "
                      "delivered",
                      even->rms_s));
  const std::vector<RowRange> twice =
      s.gaps == 0 ? repeated_blocks(e.capture) : std::vector<RowRange>{};
  if (!twice.empty())
    return failed_by(
        e, "gaps", twice,
        fmt::format("blocks of rows are those of an earlier moment to the last bit: "
                    "{}, {} rows in all, first at {}: a buffer was delivered twice, or "
                    "read before it was filled",
                    times_text(twice.size()), rows_of(twice),
                    moment_text(e.capture.time_s[twice.front().first])));
  constexpr double kCountable = 9007199254740992.0; // 2^53: beyond, a number of samples is none
  const std::string missing = s.lost < kCountable
                                  ? fmt::format("about {:.0f} samples are missing", s.lost)
                                  : "samples are missing, too many to count";
  return verdict("gaps", s.gaps == 0, static_cast<double>(s.gaps), 0, "gaps",
                 s.gaps == 0
                     ? "no sample is missing"
                     : fmt::format("{}, the longest gap is {:.6g} s where {:.3g} s is usual",
                                   missing, s.longest_gap_s, e.usual_step_s));
}

} // namespace ada::health
