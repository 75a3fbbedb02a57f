// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/level_gap.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// By how much the step to reading i is more than the steps on either side of it lead to.
double beyond_neighbours(const Capture &capture, std::span<const double> x, std::size_t i) {
  const std::vector<double> &t = capture.time_s;
  const auto rate = [&](std::size_t k) { return (x[k] - x[k - 1]) / (t[k] - t[k - 1]); };
  return x[i] - x[i - 1] - 0.5 * (rate(i - 1) + rate(i + 1)) * (t[i] - t[i - 1]);
}

/// The widest range between two readings of the inner nine tenths, and the next one to it.
struct Widest {
  double low = 0.0, high = 0.0, next = 0.0;
};

Widest widest_gap(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  const std::size_t margin = x.size() / 20;
  Widest out;
  for (std::size_t i = margin + 1; i + margin < x.size(); ++i) {
    const double gap = x[i] - x[i - 1];
    if (gap > out.high - out.low) {
      out.next = out.high - out.low;
      out.low = x[i - 1];
      out.high = x[i];
    } else {
      out.next = std::max(out.next, gap);
    }
  }
  return out;
}

std::optional<LevelGap> gap_of(const Capture &capture, bool of_cos) {
  const std::vector<double> &x = of_cos ? capture.vcos_v : capture.vsin_v;
  const std::vector<double> &other = of_cos ? capture.vsin_v : capture.vcos_v;
  const Widest widest = widest_gap(x);
  const double gap = widest.high - widest.low;
  if (!(gap > 0.0) || widest.next > criteria::kNextGap * gap)
    return {};
  std::vector<double> jumps, others, ordinary;
  // From the end of one record to the start of the next a pair may go anywhere.
  const auto of_one_record = [&](std::size_t i) {
    return std::ranges::none_of(capture.starts, [&](std::size_t start) {
      return start + 1 >= i && start <= i + 1 && start != 0;
    });
  };
  for (std::size_t i = 2; i + 1 < x.size(); ++i) {
    const double by = beyond_neighbours(capture, x, i);
    if (!std::isfinite(by))
      continue;
    const bool up = x[i - 1] <= widest.low && x[i] >= widest.high;
    const bool down = x[i - 1] >= widest.high && x[i] <= widest.low;
    if (up || down) {
      if (!of_one_record(i))
        continue;
      jumps.push_back(up ? by : -by);
      others.push_back(std::abs(beyond_neighbours(capture, other, i)));
    } else {
      ordinary.push_back(std::abs(by));
    }
  }
  if (jumps.size() < criteria::kFewestCrossings || ordinary.empty())
    return {};
  const double jump = quantile(jumps, 0.5);
  std::vector<double> off;
  for (const double j : jumps)
    off.push_back(std::abs(j - jump));
  const double usual = quantile(std::move(ordinary), 0.5);
  const double alike = criteria::kNextGap * jump;
  if (jump < 0.5 * gap || jump < criteria::kJump * usual || quantile(std::move(off), 0.5) > alike ||
      quantile(std::move(others), 0.5) > alike)
    return {};
  return LevelGap{of_cos, widest.low, widest.high, jump, jumps.size()};
}

} // namespace

std::optional<LevelGap> level_gap(const Capture &capture) {
  for (const std::vector<double> *x : {&capture.vsin_v, &capture.vcos_v})
    if (!std::all_of(x->begin(), x->end(), [](double v) { return std::isfinite(v); }))
      return {};
  const auto of_sin = gap_of(capture, false), of_cos = gap_of(capture, true);
  return of_cos && (!of_sin || of_cos->jump_v > of_sin->jump_v) ? of_cos : of_sin;
}

} // namespace ada
