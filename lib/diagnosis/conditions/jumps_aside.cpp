// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/jumps_aside.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>

#include "base/angle.h"
#include "base/error.h"
#include "base/pick.h"
#include "base/robust.h"
#include "base/sense.h"
#include "conversion/ellipse.h"
#include "diagnosis/conditions/own_jumps.h"
#include "diagnosis/conditions/pair_alone.h"
#include "diagnosis/criteria.h"
#include "motion/kinematics.h"

namespace ada {

namespace {

std::optional<EllipseInverse> own_inverse(const Observations &data) {
  std::vector<std::uint32_t> some(data.size());
  std::iota(some.begin(), some.end(), 0u);
  some = thin(some, criteria::kForCircle);
  const auto fit =
      own_ellipse(as_doubles(pick(data.vsin, some)), as_doubles(pick(data.vcos, some)));
  try {
    return fit ? std::optional(invert(fit->value)) : std::nullopt;
  } catch (const Error &) { // it is flat
    return std::nullopt;
  }
}

} // namespace

std::vector<JumpAside> jumps_aside(const Observations &data, int periods) {
  const std::size_t n = data.size();
  const auto own = own_inverse(data);
  if (!own)
    return {};
  std::vector<double> aside(n);
  for (std::size_t i = 0; i < n; ++i)
    aside[i] =
        std::atan2(own->sine(data.vsin[i], data.vcos[i]), own->cosine(data.vsin[i], data.vcos[i]));
  const double sense = common_sense(
      n - 1, [&](std::size_t i) { return wrap_centred(aside[i + 1] - aside[i], kTwoPi); },
      [&](std::size_t i) { return data.alpha[i + 1] - data.alpha[i]; });
  for (std::size_t i = 0; i < n; ++i)
    aside[i] = sense * aside[i] - periods * data.alpha[i];
  unwrap(aside, kTwoPi);
  for (double &of : aside)
    of /= periods;
  // By their numbers: what the two are apart by does not go on while rows are missing, as those
  // about a jump may be.
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  const OwnJumps jumps = own_jumps(numbers, aside, std::vector<double>(n, 0.0));
  if (jumps.rows.empty() || jumps.rows.size() > criteria::kMostJumpsAside)
    return {};
  const auto middle = [&](std::size_t from, std::size_t to) {
    return quantile(std::vector<double>(aside.begin() + static_cast<std::ptrdiff_t>(from),
                                        aside.begin() + static_cast<std::ptrdiff_t>(to)),
                    0.5);
  };
  // Where the shaft turns back a play or a hysteresis is taken up, and neither jumps.
  constexpr std::size_t kReach = 32; // rows, an estimate
  const auto turns_back = [&](std::size_t at) {
    return (data.alpha[at - 1] - data.alpha[at - std::min(at, kReach)]) *
               (data.alpha[std::min(n - 1, at + kReach)] - data.alpha[at]) <
           0.0;
  };
  if (std::ranges::any_of(jumps.rows, turns_back))
    return {};
  std::vector<JumpAside> out;
  for (std::size_t k = 0; k < jumps.rows.size(); ++k) {
    const std::size_t at = jumps.rows[k], from = k > 0 ? jumps.rows[k - 1] : 0,
                      to = k + 1 < jumps.rows.size() ? jumps.rows[k + 1] : n;
    out.push_back({0.5 * (data.time[at - 1] + data.time[at]), middle(at, to) - middle(from, at)});
  }
  return out;
}

} // namespace ada
