// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/even_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/angle.h"
#include "base/robust.h"
#include "health/criteria.h"
#include "motion/own_vector.h"

namespace ada {

namespace {

/// Step of an even clock, s: between the middle of some stamps at either end, of which one may be
/// late by many steps.
double even_step(const std::vector<double> &time) {
  constexpr std::size_t kAtEnd = 64;
  const std::size_t n = time.size(), some = std::min(kAtEnd, n / 2);
  const double rough = (time.back() - time.front()) / static_cast<double>(n - 1);
  const auto middle = [&](std::size_t first) {
    std::vector<double> off;
    for (std::size_t i = first; i < first + some; ++i)
      off.push_back(time[i] - time[0] - rough * static_cast<double>(i));
    return quantile(std::move(off), 0.5);
  };
  return rough + (middle(n - some) - middle(0)) / static_cast<double>(n - some);
}

/// Stamps against the even clock between the first and the last of them, in steps of that clock.
std::vector<double> off_even(const std::vector<double> &time, double step_s) {
  std::vector<double> out;
  for (std::size_t i = 0; i < time.size(); ++i)
    out.push_back((time[i] - time[0]) / step_s - static_cast<double>(i));
  const double middle = quantile(out, 0.5);
  for (double &off : out)
    off -= middle;
  return out;
}

/// Whether a stamp tells nothing of the next: the speed of a shaft, where rows are clocked by its
/// angle, goes on from row to row.
bool each_for_itself(const std::vector<double> &off_steps) {
  std::vector<double> apart;
  for (std::size_t i = 1; i < off_steps.size(); ++i)
    apart.push_back((off_steps[i] - off_steps[i - 1]) / std::numbers::sqrt2);
  return robust_spread(apart) > health::kStampsApart * robust_spread(off_steps);
}

/// Whether the stamps come back to the same clock again and again: of rows that are missing they
/// would be another clock's from there on.
bool come_back(const std::vector<double> &off_steps) {
  constexpr std::size_t kWindow = 32;
  for (std::size_t first = 0; first < off_steps.size(); first += kWindow) {
    const std::size_t end = std::min(off_steps.size(), first + kWindow);
    if (end - first < kWindow / 2)
      break;
    const std::vector<double> some(off_steps.begin() + static_cast<std::ptrdiff_t>(first),
                                   off_steps.begin() + static_cast<std::ptrdiff_t>(end));
    if (!(std::abs(quantile(some, 0.5)) < health::kSameClock))
      return false;
  }
  return true;
}

/// How far each row lies off the way between its neighbours, in the middle, by the stamps and by
/// the number of the rows.
struct Rough {
  double by_stamp, by_row;
};

Rough roughness(const std::vector<double> &angle, const std::vector<double> &time) {
  std::vector<double> by_stamp, by_row;
  for (std::size_t i = 1; i + 1 < angle.size(); ++i) {
    const double before = wrap_centred(angle[i] - angle[i - 1], kTwoPi),
                 both = before + wrap_centred(angle[i + 1] - angle[i], kTwoPi),
                 part = (time[i] - time[i - 1]) / (time[i + 1] - time[i - 1]);
    if (!(time[i + 1] > time[i - 1]) || !std::isfinite(both))
      continue;
    by_stamp.push_back(std::abs(before - part * both));
    by_row.push_back(std::abs(before - 0.5 * both));
  }
  return {quantile(std::move(by_stamp), 0.5), quantile(std::move(by_row), 0.5)};
}

} // namespace

std::optional<EvenRows> even_rows(const Capture &capture) {
  const std::size_t n = capture.size();
  if (n < health::kFewestOfClock || !capture.starts.empty())
    return std::nullopt;
  const std::vector<double> &time = capture.time_s;
  const double step_s = even_step(time);
  if (!(step_s > 0.0) || !std::ranges::all_of(time, [](double t) { return std::isfinite(t); }))
    return std::nullopt;
  const std::vector<double> off = off_even(time, step_s);
  // A stamp is known to the last digit of its number only.
  const double last_digit_s =
      std::abs(time.back()) * std::numeric_limits<double>::epsilon() * health::kUnevenDigits;
  if (!(robust_spread(off) > std::max(health::kUnevenStamps, last_digit_s / step_s)) ||
      !come_back(off) || !each_for_itself(off))
    return std::nullopt;
  const OwnVector own = own_vector(capture);
  const Rough rough = roughness(own.angle, time);
  if (!(health::kRowsTellBetter * rough.by_row < rough.by_stamp))
    return std::nullopt;
  EvenRows out{capture, 0.0, 0.0};
  out.capture.gaps.clear(); // of the stamps: no row is missing where they come back
  out.capture.turned_rad.clear();
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    out.capture.time_s[i] = time[0] + static_cast<double>(i) * step_s;
    squares += off[i] * off[i];
  }
  out.capture.meta.sample_rate_hz = 1.0 / step_s;
  const double rms_steps = std::sqrt(squares / static_cast<double>(n));
  std::vector<double> way;
  for (std::size_t i = 1; i < n; ++i)
    way.push_back(std::abs(wrap_centred(own.angle[i] - own.angle[i - 1], kTwoPi)));
  out.rms_s = rms_steps * step_s;
  out.rms_v = std::min(1.0, rms_steps * quantile(std::move(way), 0.5)) * own.usual_length_v /
              std::numbers::sqrt2;
  return out;
}

} // namespace ada
