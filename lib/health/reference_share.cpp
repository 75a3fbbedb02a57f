// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/reference_share.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "base/angle.h"
#include "base/pick.h"
#include "base/robust.h"
#include "base/solve.h"
#include "health/criteria.h"

namespace ada {

namespace {

using Rows = std::vector<std::uint32_t>;

bool is_read(const Capture &c, std::size_t i) {
  return std::isfinite(c.vsin_v[i]) && std::isfinite(c.vcos_v[i]) &&
         std::isfinite(c.reference_deg[i]);
}

/// Each of so many at most, from one end to the other.
template <class T> std::vector<T> some_of(const std::vector<T> &all, std::size_t most) {
  std::vector<T> out;
  for (std::size_t k = 0; k < all.size(); k += 1 + (all.size() - 1) / most)
    out.push_back(all[k]);
  return out;
}

/// From the least to the most of some rows but for a few that may be wild. Where the shaft rests
/// for nearly all of the record a hundredth of the rows, which the bulk leaves out, is all that
/// moved.
Reach all_but_a_few(const Rows &rows, const std::vector<double> &column_v) {
  std::vector<double> v = pick(column_v, rows);
  const auto wild = static_cast<std::ptrdiff_t>(std::min(health::kFewFaulty, v.size() / 4));
  std::nth_element(v.begin(), v.begin() + wild, v.end());
  const double low_v = v[static_cast<std::size_t>(wild)];
  std::nth_element(v.begin(), v.end() - 1 - wild, v.end());
  return {low_v, *(v.end() - 1 - wild)};
}

/// With as much as half of it to either side: what lies farther is no noise, and no reading.
Reach with_noise(const Reach &r) {
  return {r.low - 0.5 * r.width(), r.high + 0.5 * r.width()};
}

/// Stretches of one record each, in which the pair goes twice round, or all of a shorter record. Of
/// rows between which it hardly moved one stands for all: noise is no way, and a rest one visit.
std::vector<Rows> stretches(const Capture &c) {
  Rows all;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (is_read(c, i))
      all.push_back(static_cast<std::uint32_t>(i));
  std::vector<Rows> out;
  if (all.size() < health::kFewestOfShare)
    return out;
  const Reach sine = all_but_a_few(all, c.vsin_v), cosine = all_but_a_few(all, c.vcos_v);
  const Reach of_sine = with_noise(sine), of_cosine = with_noise(cosine);
  const double radius_v = 0.5 * std::max(sine.width(), cosine.width());
  std::vector<std::size_t> begins = c.starts;
  begins.insert(begins.end(), c.gaps.begin(), c.gaps.end());
  std::sort(begins.begin(), begins.end());
  const double enough_v = health::kRoundsOfShare * kTwoPi * radius_v;
  auto next = begins.begin();
  double way_v = 0.0;
  bool of_record = false; // the stretch before is of the same record
  const auto end_record = [&] {
    if (!of_record || way_v >= enough_v)
      return;
    Rows &before = out[out.size() - 2];
    before.insert(before.end(), out.back().begin(), out.back().end());
    out.pop_back();
  };
  for (const std::uint32_t i : all) {
    if (!of_sine.holds(c.vsin_v[i]) || !of_cosine.holds(c.vcos_v[i]))
      continue;
    bool other_record = out.empty();
    for (; next != begins.end() && *next <= i; ++next)
      other_record = true;
    const std::uint32_t last = out.empty() ? i : out.back().back();
    const double moved_v = std::hypot(c.vsin_v[i] - c.vsin_v[last], c.vcos_v[i] - c.vcos_v[last]);
    if (!other_record && moved_v < health::kMoveOfShare * radius_v)
      continue;
    if (other_record || (way_v >= enough_v && out.back().size() >= health::kFewestOfShare)) {
      if (other_record && !out.empty())
        end_record();
      of_record = !other_record;
      out.emplace_back();
      way_v = 0.0;
    } else {
      way_v += moved_v;
    }
    out.back().push_back(i);
  }
  end_record();
  return out;
}

/// Squares about the mean of each channel, and those that the angle leaves of them, each by its
/// degrees of freedom.
struct Squares {
  double all = 0.0, left = 0.0;
};

Squares squares(const Capture &c, const Rows &rows, double periods) {
  constexpr Eigen::Index kUnknowns = 3;
  const auto n = static_cast<Eigen::Index>(rows.size());
  Squares out;
  if (n < static_cast<Eigen::Index>(health::kFewestOfShare))
    return out;
  Eigen::MatrixXd of(n, kUnknowns), pair(n, 2);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::uint32_t i = rows[static_cast<std::size_t>(k)];
    const double angle = periods * kRadPerDeg * c.reference_deg[i];
    of.row(k) << 1.0, std::cos(angle), std::sin(angle);
    pair.row(k) << c.vsin_v[i], c.vcos_v[i];
  }
  pair.rowwise() -= pair.colwise().mean().eval();
  const Eigen::MatrixXd left = pair - of * solved(of.transpose() * of, of.transpose() * pair);
  const auto rows_n = static_cast<double>(n);
  out.all = rows_n * pair.squaredNorm() / (rows_n - 1.0);
  out.left = rows_n * left.squaredNorm() / (rows_n - static_cast<double>(kUnknowns));
  return out;
}

double share(const Capture &c, const std::vector<Rows> &of, double periods) {
  Squares sum;
  for (const Rows &stretch : some_of(of, health::kStretchesOfShare)) {
    const Squares one = squares(c, some_of(stretch, health::kRowsOfShare), periods);
    sum.all += one.all;
    sum.left += one.left;
  }
  return sum.all > 0.0 ? 1.0 - sum.left / sum.all : std::numeric_limits<double>::quiet_NaN();
}

/// Whether the reference keeps to one direction while the pair goes round.
bool stands_still(const Capture &c) {
  double x = 0.0, y = 0.0, n = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (is_read(c, i)) {
      x += std::cos(kRadPerDeg * c.reference_deg[i]);
      y += std::sin(kRadPerDeg * c.reference_deg[i]);
      n += 1.0;
    }
  return n > 0.0 && 1.0 - std::hypot(x, y) / n < health::kTurnedScatter;
}

} // namespace

double share_by_reference(const Capture &capture, double periods) {
  return share(capture, stretches(capture), periods);
}

std::string why_of_no_shaft(const Capture &capture) {
  if (!capture.has_reference())
    return {};
  const int stated = capture.meta.periods_per_turn;
  if (stated > health::kMostPeriodsTried)
    return {};
  const std::vector<Rows> of = stretches(capture);
  const double told = share(capture, of, stated);
  if (!(told < health::kMostlyOfThisShaft))
    return {};
  // Of less than two rounds a part goes with anything that is smooth: what it is has to be plain.
  const double enough = told < health::kOfThisShaft ? health::kCertainlyOfThisShaft
                                                    : 1.0 - health::kTenth * (1.0 - told);
  constexpr struct {
    double degrees;
    const char *name;
  } kUnits[] = {{kDegPerRad, "radians"}, {360.0, "turns"}, {0.9, "gradians"}};
  int periods = 0;
  const char *unit = nullptr; // 57 periods are nearly radians
  double best = enough;
  for (int k = 1; k <= health::kMostPeriodsTried; ++k)
    if (const double one = share(capture, of, k); one > best) {
      best = one;
      periods = k;
    }
  for (const auto &u : kUnits)
    if (const double one = share(capture, of, stated * u.degrees); one > best) {
      best = one;
      unit = u.name;
    }
  if (unit)
    return fmt::format("the reference goes with the pair if its numbers are {}; it is to be in "
                       "degrees",
                       unit);
  if (periods != 0)
    return fmt::format(
        "the pair makes {} {} a turn of the reference, where the capture states {}: "
        "its periods_per_turn is wrong, or the reference counts other turns than the "
        "shaft's",
        periods, periods == 1 ? "period" : "periods", stated);
  if (told >= health::kOfThisShaft)
    return {};
  return stands_still(capture)
             ? "the pair turns, but the reference stands still"
             : "the pair turns, but the reference does not go with it: it belongs "
               "to another shaft or another time, or does not count degrees";
}

} // namespace ada
