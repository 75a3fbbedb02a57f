// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/own_jumps.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

OwnJumps own_jumps(std::span<const double> time, std::span<const double> angle) {
  constexpr std::size_t kReach = 8; // readings on either side that tell what is usual
  constexpr double kSteps = 4.0;    // of the usual size: no shaft changes its speed so at once
  constexpr double kEven = 1.5;     // of the usual time between readings
  OwnJumps out;
  if (time.size() < 4 * kReach)
    return out;
  const double usual_s = median_step(time);
  for (std::size_t i = kReach + 1; i + kReach < angle.size(); ++i) {
    if (!(time[i] - time[i - 1] <= kEven * usual_s))
      continue;
    std::vector<double> around, apart;
    for (std::size_t k = i - kReach; k <= i + kReach; ++k)
      if (k != i)
        around.push_back(angle[k] - angle[k - 1]);
    const double usual = quantile(around, 0.5);
    for (const double step : around)
      apart.push_back(std::abs(step - usual));
    const double jump = angle[i] - angle[i - 1] - usual;
    if (!(std::abs(jump) >
          criteria::kJump * quantile(std::move(apart), 0.75) + kSteps * std::abs(usual)))
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
    out.largest_rad = std::max(out.largest_rad, std::abs(jump));
    out.squares_rad2 += jump * jump;
  }
  return out;
}

} // namespace ada
