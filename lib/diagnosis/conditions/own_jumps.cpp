// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/own_jumps.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/conditions/over_supply.h"
#include "diagnosis/criteria.h"
#include "motion/kinematics.h"

namespace ada {

OwnJumps own_jumps(std::span<const double> time, std::span<const double> angle,
                   std::span<const double> of_counts, std::span<const char> spared) {
  constexpr std::size_t kReach = 8; // readings on either side that tell what is usual
  constexpr double kSteps = 4.0;    // of the usual size: no shaft changes its speed so at once
  constexpr double kCounts = 2.0;   // a reading near the edge of one count falls on either side
  constexpr double kEven = 1.5;     // of the usual time between readings
  constexpr double kEvenly = 0.25;  // of the usual step: no hand that jerks turns so about it
  OwnJumps out;
  if (time.size() < 4 * kReach)
    return out;
  const double usual_s = median_step(time);
  std::size_t last = 0; // a reading that repeats the one before it may be of that moment
  for (std::size_t i = 1; i + kReach < angle.size(); ++i) {
    if (i > 1 && angle[i - 1] != angle[i - 2])
      last = i - 1;
    if (i <= kReach)
      continue;
    if (!(time[i] - time[last] <= kEven * usual_s) || (!spared.empty() && spared[i]))
      continue;
    std::vector<double> around, apart;
    for (std::size_t k = i - kReach; k <= i + kReach; ++k)
      if (k != i)
        around.push_back(angle[k] - angle[k - 1]);
    const double usual = quantile(around, 0.5);
    for (const double step : around)
      apart.push_back(std::abs(step - usual));
    const double jump = angle[i] - angle[i - 1] - usual;
    const double uneven = quantile(std::move(apart), 0.75);
    if (!(std::abs(jump) > criteria::kJump * uneven + kSteps * std::abs(usual) +
                               kCounts * std::max(of_counts[i], of_counts[i - 1])))
      continue;
    // A single reading that is off jumps and comes back.
    const auto stays = [&](std::size_t from, std::size_t to) {
      return std::abs(angle[to] - angle[from] - 2.0 * usual) > 0.5 * std::abs(jump);
    };
    if (!stays(i - 1, i + 1) || !stays(i - 2, i))
      continue;
    if (out.forward + out.backward == 0)
      out.first_s = time[i];
    (jump * usual > 0.0 ? out.forward : out.backward) += 1;
    out.even += uneven < kEvenly * std::abs(usual) ? 1 : 0;
    out.largest_rad = std::max(out.largest_rad, std::abs(jump));
    out.squares_rad2 += jump * jump;
    out.rows.push_back(static_cast<std::uint32_t>(i));
  }
  return out;
}

std::vector<double> turned_by_counts(const std::vector<double> &vsin_v,
                                     const std::vector<double> &vcos_v, double centre_sin_v,
                                     double centre_cos_v, int periods_per_turn) {
  const double count_v = std::hypot(converter_step(vsin_v), converter_step(vcos_v));
  const double most = std::numbers::pi / periods_per_turn; // at the centre itself
  std::vector<double> out(vsin_v.size(), most);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (const double length_v = std::hypot(vsin_v[i] - centre_sin_v, vcos_v[i] - centre_cos_v);
        length_v > 0.0)
      out[i] = std::min(most, count_v / (length_v * periods_per_turn));
  return out;
}

OwnJumps own_jumps(const Capture &capture, std::span<const std::uint32_t> rows, double centre_sin_v,
                   double centre_cos_v, bool at_one_supply) {
  const std::optional<PairOfChannels> steady = at_one_supply ? over_supply(capture) : std::nullopt;
  const std::vector<double> &vsin = steady ? steady->sin_v : capture.vsin_v,
                            &vcos = steady ? steady->cos_v : capture.vcos_v;
  const int periods = capture.meta.periods_per_turn;
  const std::vector<double> turned =
      turned_by_counts(capture.vsin_v, capture.vcos_v, centre_sin_v, centre_cos_v, periods);
  std::vector<double> time, angle, of_counts;
  for (std::uint32_t i : rows) {
    time.push_back(capture.time_s[i]);
    of_counts.push_back(turned[i]);
    angle.push_back(std::atan2(vsin[i] - centre_sin_v, vcos[i] - centre_cos_v));
  }
  unwrap(angle, kTwoPi);
  for (double &a : angle)
    a /= periods;
  OwnJumps out = own_jumps(time, angle, of_counts);
  out.number_by(rows);
  return out;
}

} // namespace ada
