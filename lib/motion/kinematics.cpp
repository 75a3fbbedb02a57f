// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion/kinematics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/angle.h"
#include "base/robust.h"
#include "motion/spline.h"

namespace ada {

namespace {

/// Sums over the samples before a place, about an origin.
struct SlopeSums {
  double x = 0, y = 0, xx = 0, xy = 0;
  SlopeSums with(double u, double v) const { return {x + u, y + v, xx + u * u, xy + u * v}; }
  SlopeSums operator-(const SlopeSums &o) const { return {x - o.x, y - o.y, xx - o.xx, xy - o.xy}; }
};

/// Slopes of straight lines over +-half samples. Sums run over a few windows only, each run about
/// an origin of its own: over all of a long record they would lose the digits of a slope. At the
/// ends of the record a window lies to one side, and a line over it has the slope of its middle:
/// from there the slope goes on as it changes over the next full windows.
std::vector<double> local_slopes(std::span<const double> x, std::span<const double> y,
                                 std::size_t half) {
  const std::size_t n = x.size(), run = half + 1;
  std::vector<double> slope(n, 0.0);
  std::vector<SlopeSums> before;
  const auto at_end = [&](std::size_t i) { return i < half || i + half >= n; };
  const bool bends = half > 0 && n > 4 * half;
  std::vector<double> off(bends ? n : 0); // from the middle of the window
  for (std::size_t first = 0; first < n; first += run) {
    const std::size_t end = std::min(n, first + run), begin = first > half ? first - half : 0;
    const std::size_t last = std::min(n, end + half), origin = (first + end) / 2;
    before.assign(1, {});
    for (std::size_t k = begin; k < last; ++k)
      before.push_back(before.back().with(x[k] - x[origin], y[k] - y[origin]));
    for (std::size_t i = first; i < end; ++i) {
      const std::size_t from = i > half ? i - half : 0, to = std::min(n, i + half + 1);
      const SlopeSums s = before[to - begin] - before[from - begin];
      const double count = static_cast<double>(to - from);
      const double d = count * s.xx - s.x * s.x;
      slope[i] = d > 0.0 ? (count * s.xy - s.x * s.y) / d : (i > 0 ? slope[i - 1] : 0.0);
      if (bends && at_end(i))
        off[i] = x[i] - x[origin] - s.x / count;
    }
  }
  if (bends) {
    const auto bend = [&](std::size_t from, std::size_t to) {
      return x[to] > x[from] ? (slope[to] - slope[from]) / (x[to] - x[from]) : 0.0;
    };
    const double first = bend(half, 2 * half), last = bend(n - 1 - 2 * half, n - 1 - half);
    for (std::size_t i = 0; i < half; ++i) {
      slope[i] += first * off[i];
      slope[n - 1 - i] += last * off[n - 1 - i];
    }
  }
  return slope;
}

/// Knots at every three quarters of a turn (at every turn the images of a slow wander fall on the
/// lowest orders, at every half the spline could follow order 1), at every fifth of one where
/// `dense` says so, wherever the speed has changed by more than any ripple does, and at rest at
/// least every twentieth of the record; for turns that went by between two samples at even times
/// between them, and no more than set both sides free of each other. Unusable stretches get several
/// knots, so that what lies on both sides of them does not have to fit together.
/// `slow_turns`: in a twentieth of the record a shaft that makes less is followed that often.
std::vector<double> knots_by_travel(std::span<const double> time, std::span<const double> angle,
                                    std::span<const char> usable, std::span<const char> dense,
                                    double slow_turns) {
  std::vector<double> knots{time.front()};
  double travel = 0.0;
  const double longest = (time.back() - time.front()) / 20.0;
  constexpr double kMoreThanRipple = 0.25, kLeastOfTop = 0.01;
  const std::vector<double> speed = local_slopes(time, angle, 10 + time.size() / 2000);
  double top = 0.0, last = speed.front();
  for (double w : speed)
    top = std::max(top, std::abs(w));
  const auto bends = [&](std::size_t i) {
    const double faster = std::max(std::abs(speed[i]), std::abs(last));
    return std::abs(speed[i] - last) > std::max(kMoreThanRipple * faster, kLeastOfTop * top);
  };
  constexpr int kInside = 5;
  std::size_t inside = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (const double passed = std::abs(angle[i] - angle[i - 1]) / kTwoPi; passed >= 1.0) {
      const double parts = std::min(std::floor(passed), static_cast<double>(kInside));
      for (double k = 0.5; k < parts; k += 1.0)
        knots.push_back(time[i - 1] + (time[i] - time[i - 1]) * k / parts);
      last = speed[i];
      travel = 0.0;
      inside = 0;
      continue;
    }
    if (!usable[i]) {
      std::size_t end = i;
      while (end < time.size() && !usable[end])
        ++end;
      if (end - i <= 3 * kInside) { // single bad samples interrupt nothing
        travel += std::abs(angle[end - 1] - angle[i - 1]);
        i = end - 1;
        continue;
      }
      if (travel < 0.5 * kTwoPi && knots.size() > 1)
        knots.pop_back(); // a short piece before the gap would be loose
      for (int k = 0; k < kInside; ++k) {
        const std::size_t at = i + (end - 1 - i) * static_cast<std::size_t>(k) / (kInside - 1);
        if (time[at] > knots.back())
          knots.push_back(time[at]);
      }
      travel = 0.0;
      inside = 0;
      i = end - 1;
      continue;
    }
    travel += std::abs(angle[i] - angle[i - 1]);
    ++inside;
    const bool far = travel >= (dense[i] ? 0.2 : 0.75) * kTwoPi;
    const bool late = time[i] - knots.back() > longest && travel < slow_turns * kTwoPi;
    if ((far || late || bends(i)) && inside >= 8 && time[i] > knots.back()) {
      knots.push_back(time[i]);
      last = speed[i];
      travel = 0.0;
      inside = 0;
    }
  }
  if (knots.size() > 1 && time.back() - knots.back() < knots.back() - knots[knots.size() - 2])
    knots.pop_back(); // the last piece takes what is left
  knots.push_back(time.back());
  return knots;
}

/// Orders of a ripple that falls with the speed: those at which one is looked for.
constexpr int kFallingOrders = 12;

/// One fit of spline and harmonics; fills motion, cos, sin and gives the residual of each sample.
std::vector<double> split_by(std::vector<double> knots, std::span<const double> time,
                             std::span<const double> angle, std::span<const char> usable,
                             int orders, SmoothMotion &out, const std::vector<double> &falls) {
  CubicSpline spline(knots);
  out.knots = std::move(knots);
  const int falling = falls.empty() ? 0 : std::min(orders, kFallingOrders);
  const auto harmonics = [&](std::size_t i, double *t) {
    const double c1 = std::cos(angle[i]), s1 = std::sin(angle[i]);
    double c = 1.0, s = 0.0;
    for (int k = 0; k < orders; ++k) {
      const double next = c * c1 - s * s1;
      s = s * c1 + c * s1;
      c = next;
      t[2 * k] = c;
      t[2 * k + 1] = s;
      if (k < falling) {
        t[2 * (orders + k)] = falls[i] * c;
        t[2 * (orders + k) + 1] = falls[i] * s;
      }
    }
  };
  spline.fit(time, angle, usable, static_cast<std::size_t>(2 * (orders + falling)), harmonics);
  const std::vector<double> &terms = spline.term_coefficients();
  out.cos.clear();
  out.sin.clear();
  for (std::size_t k = 0; k < 2 * static_cast<std::size_t>(orders); k += 2) {
    out.cos.push_back(terms[k]);
    out.sin.push_back(terms[k + 1]);
  }
  const std::size_t n = time.size();
  Kinematics &m = out.motion;
  m.alpha.resize(n);
  m.omega.resize(n);
  m.accel.resize(n);
  m.direction.resize(n);
  std::vector<double> residual(n), t(terms.size());
  signed char sense = 1;
  for (std::size_t i = 0; i < n; ++i) {
    m.alpha[i] = spline.value(time[i]);
    m.omega[i] = spline.slope(time[i]);
    m.accel[i] = static_cast<float>(spline.curvature(time[i]));
    if (m.omega[i] != 0.0)
      sense = m.omega[i] < 0.0 ? -1 : 1;
    m.direction[i] = sense;
    harmonics(i, t.data());
    double periodic = 0.0;
    for (std::size_t k = 0; k < t.size(); ++k)
      periodic += terms[k] * t[k];
    residual[i] = angle[i] - m.alpha[i] - periodic;
  }
  return residual;
}

/// The same by the plainest motion that does: one cubic over the whole record, as of a steady spin
/// or an even run-up, or few knots, where more of them take no more of the residual than they do of
/// noise. Knots follow a ripple of order 1 in part, the more the closer they stand, and what both
/// can do neither is known to do.
std::vector<double> split(std::span<const double> time, std::span<const double> angle,
                          std::span<const char> usable, std::span<const char> dense, int orders,
                          SmoothMotion &out, const std::vector<double> &falls) {
  constexpr double kChance = 4.0;              // standard deviations of what knots take of noise
  constexpr double kSlow = 0.5, kAtRest = 0.1; // turns in a twentieth of the record
  std::vector<double> knots = knots_by_travel(time, angle, usable, dense, kSlow);
  const auto squares = [&](const std::vector<double> &residual) {
    double sum = 0.0;
    for (std::size_t i = 0; i < residual.size(); ++i)
      sum += usable[i] ? residual[i] * residual[i] : 0.0;
    return sum;
  };
  const auto most = static_cast<double>(knots.size());
  std::vector<double> fewer = knots_by_travel(time, angle, usable, dense, kAtRest);
  const bool are_fewer = fewer.size() < knots.size();
  std::vector<double> residual =
      split_by(std::move(knots), time, angle, usable, orders, out, falls);
  const double least = squares(residual);
  const auto used = static_cast<double>(std::count(usable.begin(), usable.end(), char{1}));
  const auto does_as_well = [&](std::vector<double> plainer) {
    const double more = most - static_cast<double>(plainer.size());
    const double freedom =
        std::max(1.0, used - more - 4.0 - 2.0 * (orders + (falls.empty() ? 0 : kFallingOrders)));
    const double by_chance = (more + kChance * std::sqrt(2.0 * more)) / freedom;
    SmoothMotion plain;
    plain.spikes = out.spikes; // no fit makes those, nor unmakes them
    std::vector<double> left =
        split_by(std::move(plainer), time, angle, usable, orders, plain, falls);
    if (squares(left) > least * (1.0 + by_chance))
      return false;
    out = std::move(plain);
    residual = std::move(left);
    return true;
  };
  if (!does_as_well({time.front(), time.back()}) && are_fewer)
    does_as_well(std::move(fewer));
  return residual;
}

/// Widens every unusable stretch by `travel` on both sides; single bad samples stay single.
void widen_gaps(std::span<const double> angle, double travel, std::span<char> usable) {
  const std::vector<char> before(usable.begin(), usable.end());
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i])
      continue;
    std::size_t end = i;
    while (end < before.size() && !before[end])
      ++end;
    if (end - i > 15) {
      std::size_t a = i, b = end - 1;
      for (double t = 0.0; a > 0 && t < travel; --a)
        t += std::abs(angle[a] - angle[a - 1]);
      for (double t = 0.0; b + 1 < before.size() && t < travel; ++b)
        t += std::abs(angle[b + 1] - angle[b]);
      std::fill(usable.begin() + static_cast<std::ptrdiff_t>(a),
                usable.begin() + static_cast<std::ptrdiff_t>(b + 1), char{0});
    }
    i = end;
  }
}

/// Whether a run of samples departs from the smooth motion only by what repeats every turn:
/// then it is the signal that changed there, by a step of an offset say, and no rough motion. The
/// turns about a short run are looked at as well.
bool repeats_every_turn(std::span<const double> angle, const std::vector<double> &residual,
                        std::span<const char> usable, std::size_t from, std::size_t to,
                        double limit) {
  constexpr double kFewestTurns = 3.0;
  constexpr int kOrders = 4;
  constexpr Eigen::Index kColumns = 2 + 2 * kOrders;
  double travel = 0.0;
  for (std::size_t i = from + 1; i < to; ++i)
    travel += std::abs(angle[i] - angle[i - 1]);
  std::size_t first = from, last = to;
  while (travel < kFewestTurns * kTwoPi && (first > 0 || last < angle.size())) {
    if (first > 0) {
      --first;
      travel += std::abs(angle[first + 1] - angle[first]);
    }
    if (last < angle.size()) {
      ++last;
      travel += std::abs(angle[last - 1] - angle[last - 2]);
    }
  }
  if (travel < kFewestTurns * kTwoPi)
    return false;
  using Row = Eigen::Matrix<double, kColumns, 1>;
  const double length = static_cast<double>(last - first);
  const auto row = [&](std::size_t i) {
    Row x;
    x[0] = 1.0;
    x[1] = static_cast<double>(i - first) / length - 0.5;
    for (int k = 1; k <= kOrders; ++k) {
      x[2 * k] = std::cos(k * angle[i]);
      x[2 * k + 1] = std::sin(k * angle[i]);
    }
    return x;
  };
  Eigen::Matrix<double, kColumns, kColumns> normal = decltype(normal)::Identity() * 1e-9;
  Row right = Row::Zero();
  double count = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    if (!usable[i])
      continue;
    const Row x = row(i);
    normal += x * x.transpose();
    right += x * residual[i];
    count += 1.0;
  }
  if (count < 4.0 * kColumns)
    return false;
  const Row ripple = normal.ldlt().solve(right);
  double left = 0.0;
  count = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    if (!usable[i])
      continue;
    const double rest = residual[i] - ripple.dot(row(i));
    left += rest * rest;
    count += 1.0;
  }
  return left < limit * limit * count;
}

/// Of its travel, the most that a stretch in which the shaft turns back leads from its beginning.
constexpr double kTurnsBack = 0.9;

/// Where a shaft turns back it dwells, and many samples show there what the spline has smoothed too
/// much, each within its noise. Root of the mean power of means over eighths of a stretch, in units
/// of what noise of equal power a sample gives them.
double slow_part(std::span<const double> residual, std::span<const char> usable) {
  constexpr std::size_t kParts = 8;
  double power = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = part * residual.size() / kParts; i < (part + 1) * residual.size() / kParts;
         ++i)
      if (usable[i]) {
        sum += residual[i];
        count += 1.0;
      }
    power += sum * sum / std::max(count, 1.0);
  }
  return std::sqrt(power / kParts);
}

/// A quarter of a turn or more of the motion.
struct Stretch {
  std::size_t from, to;
  double rms, slow;
  double angle; ///< at its beginning, rad
  bool turns_back;
};

/// Far above the rest: the smooth part is the better part, yet the greater part is never thrown
/// away.
double far_above(const std::vector<Stretch> &stretches, double Stretch::*what, double factor) {
  std::vector<double> v;
  for (const Stretch &s : stretches)
    v.push_back(s.*what);
  std::sort(v.begin(), v.end());
  return factor * std::max(2.5 * v[v.size() / 4], 1.5 * v[v.size() * 3 / 4]);
}

/// Whether most stretches at the angle of one are as slow as it: what repeats with the angle is the
/// sensor's, not the motion's.
bool slow_at_this_angle(const std::vector<Stretch> &stretches, std::size_t one, double limit) {
  constexpr std::size_t kBeside = 2; // neighbours share the same moment
  double there = 0.0, slow = 0.0;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    if (k + kBeside >= one && k <= one + kBeside)
      continue;
    if (std::abs(wrap_centred(stretches[k].angle - stretches[one].angle, kTwoPi)) < kTwoPi / 8.0) {
      there += 1.0;
      slow += stretches[k].slow > limit ? 1.0 : 0.0;
    }
  }
  return slow > 0.5 * there;
}

/// Marks stretches whose residual stands far above that of the rest (`factor` 1: as far as must
/// be), with a turn on either side.
bool mask_rough(std::span<const double> angle, const std::vector<double> &residual, double factor,
                double side, std::span<char> usable) {
  std::vector<Stretch> stretches;
  std::size_t from = 0;
  double travel = 0.0, sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < angle.size(); ++i) {
    if (i > 0)
      travel += std::abs(angle[i] - angle[i - 1]);
    if (usable[i]) {
      sum += residual[i] * residual[i];
      count += 1.0;
    }
    if (travel < 0.25 * kTwoPi && i + 1 < angle.size())
      continue;
    if (count >= 4.0)
      stretches.push_back({from, i + 1, std::sqrt(sum / count),
                           slow_part(std::span(residual).subspan(from, i + 1 - from),
                                     usable.subspan(from, i + 1 - from)),
                           angle[from], std::abs(angle[i] - angle[from]) < kTurnsBack * travel});
    from = i + 1;
    travel = sum = count = 0.0;
  }
  if (stretches.size() < 12)
    return false;
  const double limit = far_above(stretches, &Stretch::rms, factor);
  // Runs of rough stretches, across short ones that are not.
  constexpr std::size_t kAcross = 4;
  std::vector<char> spared(stretches.size(), 0);
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    if (stretches[k].rms <= limit)
      continue;
    std::size_t last = k;
    for (std::size_t j = k + 1; j < stretches.size() && j <= last + kAcross; ++j)
      if (stretches[j].rms > limit)
        last = j;
    if (repeats_every_turn(angle, residual, usable, stretches[k].from, stretches[last].to, limit))
      std::fill(spared.begin() + static_cast<std::ptrdiff_t>(k),
                spared.begin() + static_cast<std::ptrdiff_t>(last + 1), char{1});
    k = last;
  }
  const double slow_limit = far_above(stretches, &Stretch::slow, factor);
  for (std::size_t k = 0; k < stretches.size(); ++k)
    if (stretches[k].rms <= limit)
      spared[k] = !stretches[k].turns_back || stretches[k].slow <= slow_limit ||
                  slow_at_this_angle(stretches, k, slow_limit);
  bool any = false;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    const Stretch &s = stretches[k];
    if (spared[k])
      continue;
    any = true;
    std::size_t a = s.from, b = s.to - 1;
    for (double t = 0.0; a > 0 && t < side; --a)
      t += std::abs(angle[a] - angle[a - 1]);
    for (double t = 0.0; b + 1 < angle.size() && t < side; ++b)
      t += std::abs(angle[b + 1] - angle[b]);
    std::fill(usable.begin() + static_cast<std::ptrdiff_t>(a),
              usable.begin() + static_cast<std::ptrdiff_t>(b + 1), char{0});
  }
  return any;
}

/// Spread of what is left of a motion over a tenth of a turn and more, noise taken off: the hand of
/// who turns it, and neither the teeth of a gear nor a tone.
double slow_spread(std::span<const double> angle, std::span<const double> residual,
                   std::span<const char> usable, double white) {
  constexpr double kCell = 0.1 * kTwoPi, kFewest = 3.0;
  std::vector<double> means;
  double sum = 0.0, count = 0.0, travel = 0.0, noise2 = 0.0;
  for (std::size_t i = 1; i < residual.size(); ++i) {
    travel += std::abs(angle[i] - angle[i - 1]);
    if (usable[i]) {
      sum += residual[i];
      count += 1.0;
    }
    if (travel < kCell)
      continue;
    if (count >= kFewest) {
      means.push_back(sum / count);
      noise2 += white * white / count;
    }
    sum = count = travel = 0.0;
  }
  if (means.empty())
    return 0.0;
  const double spread = robust_spread(means);
  return std::sqrt(std::max(0.0, spread * spread - noise2 / static_cast<double>(means.size())));
}

/// Takes single samples out that stand far out of the residual: they would pass for rough motion.
/// Where a shaft rests for most of the time it is the moves that stand out, and they stay.
bool take_out_spikes(const std::vector<double> &residual, std::span<char> usable,
                     std::vector<std::uint32_t> &spikes) {
  constexpr double kFar = 8.0;  // standard deviations
  constexpr double kMost = 0.1; // of the samples; with more of them they are no exception
  std::vector<double> values;
  std::vector<std::uint32_t> places;
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (usable[i]) {
      values.push_back(residual[i]);
      places.push_back(static_cast<std::uint32_t>(i));
    }
  const std::vector<std::size_t> found = standing_out(values, kFar, 0.0);
  if (static_cast<double>(found.size()) > kMost * static_cast<double>(values.size()))
    return false;
  for (std::size_t k : found) {
    usable[places[k]] = 0;
    spikes.push_back(places[k]);
  }
  return !found.empty();
}

} // namespace

void unwrap(std::vector<double> &angle, double period) {
  double offset = 0.0;
  for (std::size_t i = 1; i < angle.size(); ++i) {
    const double step = angle[i] + offset - angle[i - 1];
    offset -= period * std::round(step / period);
    angle[i] += offset;
  }
}

namespace {

/// Of white noise the second difference has six times the power, the third twenty times; of a
/// travel either has hardly any.
double noise_of(std::span<const double> alpha, std::size_t order) {
  std::vector<double> bends;
  for (std::size_t i = order; i < alpha.size(); ++i) {
    const double back = alpha[i - 1] - alpha[i - 2];
    const double bend = order == 2 ? alpha[i] - alpha[i - 1] - back
                                   : alpha[i] - alpha[i - 3] - 3.0 * back;
    if (std::isfinite(bend))
      bends.push_back(bend);
  }
  return robust_spread(bends) / std::sqrt(order == 2 ? 6.0 : 20.0);
}

/// Travel that no noise of the angle makes, rad.
double beyond_noise(std::span<const double> alpha) {
  return kBackBeyondNoise * noise_of(alpha, 2);
}

} // namespace

std::size_t first_motion(std::span<const double> alpha) {
  const double far = beyond_noise(alpha);
  const auto away = [&](double a) { return std::abs(a - alpha.front()) > far; };
  return static_cast<std::size_t>(std::find_if(alpha.begin(), alpha.end(), away) - alpha.begin());
}

std::vector<signed char> senses_of(std::span<const double> alpha) {
  // A tremor as small as the shaft's acceleration makes from row to row is no way back. Where it
  // turned is told by the noise alone, in which a lever that swings has no acceleration.
  const double back = beyond_noise(alpha);
  const double rests = 0.5 * kBackBeyondNoise * std::min(noise_of(alpha, 2), noise_of(alpha, 3));
  std::vector<signed char> out(alpha.size(), 1);
  signed char sense = 1;
  double furthest = -std::numeric_limits<double>::infinity();
  std::size_t left = 0; // after the last sample that may still be at rest at the furthest
  bool begun = false;
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    double at = sense * alpha[i];
    if (at < furthest - back) {
      sense = static_cast<signed char>(-sense);
      std::fill(out.begin() + static_cast<std::ptrdiff_t>(begun ? left : 0),
                out.begin() + static_cast<std::ptrdiff_t>(i), sense);
      begun = true;
      furthest = at = sense * alpha[i];
    }
    begun = begun || at > sense * alpha.front() + back;
    furthest = std::max(furthest, at);
    if (at >= furthest - rests) // of an exact angle the two may be one number
      left = i + 1;
    out[i] = sense;
  }
  return out;
}

std::vector<float> travel_since_reversal(std::span<const double> alpha,
                                         std::span<const signed char> senses) {
  std::vector<float> out(alpha.size(), std::numeric_limits<float>::infinity());
  double from = -std::numeric_limits<double>::infinity(); // where it turned back, in the sense
  double furthest = from;
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    if (i > 0 && senses[i] != senses[i - 1]) {
      from = -furthest;
      furthest = senses[i] * alpha[i];
    }
    furthest = std::max(furthest, senses[i] * alpha[i]);
    out[i] = static_cast<float>(std::max(0.0, senses[i] * alpha[i] - from));
  }
  return out;
}

double slowest_of_range(std::span<const double> omega) {
  // Over twice the speed the two differ by four times: of what the one explains the other leaves a
  // third. A twentieth of the samples may be spikes, gaps and ends.
  constexpr double kRange = 2.0, kFew = 0.05, kFewest = 100.0;
  // A shaft that comes to a tenth of its speed has stopped, or is about to: the ripple is then a
  // part of the motion itself.
  constexpr double kAtRest = 0.1;
  std::vector<double> speed;
  std::size_t forward = 0;
  for (double w : omega) {
    speed.push_back(std::abs(w));
    forward += w > 0.0;
  }
  const double n = static_cast<double>(speed.size());
  const double back = std::min(static_cast<double>(forward), n - static_cast<double>(forward));
  if (n < kFewest || back > 0.0)
    return 0.0;
  const double slow = quantile(speed, kFew), fast = quantile(speed, 1.0 - kFew);
  const double least = quantile(std::move(speed), 0.0);
  return fast > kRange * slow && least > kAtRest * fast ? slow : 0.0;
}

std::size_t window_of_speed(std::span<const double> time, std::span<const double> alpha,
                            std::size_t least) {
  // Of normal ones 0.972 lie within the first, and none beyond the second: where the speed changes
  // at once a few do.
  constexpr double kShare = 0.95, kSigmas = 2.2, kNoneBeyond = 6.0;
  constexpr std::size_t kWindowsOfRecord = 20, kMost = 64;
  constexpr std::size_t kEnough = 100000; // a long record has no memory to spare: from its middle
  if (const std::size_t n = alpha.size(); n > kEnough) {
    time = time.subspan((n - kEnough) / 2, kEnough);
    alpha = alpha.subspan((n - kEnough) / 2, kEnough);
  }
  const double noise = noise_between(alpha), step = median_step(time);
  std::size_t half = least;
  if (!(noise > 0.0) || !(step > 0.0))
    return half;
  // Of a straight line over k samples to either side.
  const auto variance = [&](std::size_t k) {
    const auto n = static_cast<double>(k);
    return 3.0 * noise * noise / (n * (n + 1.0) * (2.0 * n + 1.0) * step * step);
  };
  std::vector<double> speed = local_slopes(time, alpha, half);
  while (2 * half <= kMost && 2 * half * kWindowsOfRecord <= time.size()) {
    std::vector<double> wider = local_slopes(time, alpha, 2 * half);
    std::vector<double> apart; // at the ends a window has fewer samples
    for (std::size_t i = 2 * half; i + 2 * half < speed.size(); ++i)
      apart.push_back(std::abs(wider[i] - speed[i]));
    const double sigma = std::sqrt(variance(half) - variance(2 * half));
    if (*std::max_element(apart.begin(), apart.end()) > kNoneBeyond * sigma ||
        quantile(std::move(apart), kShare) > kSigmas * sigma)
      break;
    half *= 2;
    speed = std::move(wider);
  }
  return half;
}

Kinematics differentiate(std::span<const double> time, std::vector<double> alpha,
                         std::size_t half_window) {
  Kinematics out;
  out.omega = local_slopes(time, alpha, half_window);
  // The straight line over k samples on either side weakens a slow wave as the mean over m of them
  // does, by 1 - (m w)^2 / 6, where m^2 is the mean of j^4 over that of j^2.
  if (const auto k = static_cast<double>(half_window); time.size() > 1 && k > 0)
    out.reach_s = std::sqrt((3 * k * k + 3 * k - 1) / 5) * median_step(time);
  {
    const std::vector<double> accel =
        local_slopes(time, out.omega, std::max<std::size_t>(4 * half_window, 20));
    out.accel.assign(accel.begin(), accel.end());
  }
  out.direction = senses_of(alpha);
  out.travel = travel_since_reversal(alpha, out.direction);
  out.alpha = std::move(alpha);
  return out;
}

SmoothMotion smooth_motion(std::span<const double> time, std::span<const double> angle,
                           std::span<char> usable, int orders) {
  SmoothMotion out;
  std::vector<char> dense(usable.size(), 0);
  std::vector<double> falls;
  std::vector<double> residual = split(time, angle, usable, dense, orders, out, falls);
  if (const double slowest = slowest_of_range(out.motion.omega); slowest > 0.0) {
    for (double w : out.motion.omega)
      falls.push_back(ripple_at(w, slowest));
    residual = split(time, angle, usable, dense, orders, out, falls);
  }
  const auto without_spikes = [&] {
    for (int pass = 0; pass < 3 && take_out_spikes(residual, usable, out.spikes); ++pass)
      residual = split(time, angle, usable, dense, orders, out, falls);
  };
  without_spikes();
  // First the spline may bend more where the speed changes within a turn or so; the periodic part
  // is known from everywhere else.
  std::vector<char> smooth(usable.begin(), usable.end());
  if (mask_rough(angle, residual, 1.0, kTwoPi, smooth)) {
    for (std::size_t i = 0; i < dense.size(); ++i)
      dense[i] = usable[i] && !smooth[i];
    residual = split(time, angle, usable, dense, orders, out, falls);
    without_spikes();
  }
  // What is rough nearly everywhere is no exception that could be left out: neither most of the
  // samples may go nor, of a shaft that moves and rests by turns, most of the way.
  constexpr double kFewest = 0.4;
  const auto left = [](std::span<const char> mask) {
    return static_cast<double>(
        std::count_if(mask.begin(), mask.end(), [](char c) { return c != 0; }));
  };
  const double noise = beyond_noise(angle); // which makes much way at rest
  const auto way = [&](std::span<const char> mask) {
    double sum = 0.0, last = angle[0];
    for (std::size_t i = 1; i < mask.size(); ++i)
      if (!mask[i] || !mask[i - 1])
        last = angle[i];
      else if (std::abs(angle[i] - last) > noise) {
        sum += std::abs(angle[i] - last);
        last = angle[i];
      }
    return sum;
  };
  const double fewest = kFewest * left(usable), shortest = kFewest * way(usable);
  const auto adopt = [&](const std::vector<char> &mask) {
    if (left(mask) < fewest || way(mask) < shortest)
      return false;
    std::copy(mask.begin(), mask.end(), usable.begin());
    return true;
  };
  const auto leave_out_rough = [&] {
    for (double factor : {1.0, 2.0, 4.0}) {
      std::vector<char> mask(usable.begin(), usable.end());
      if (!mask_rough(angle, residual, factor, 0.25 * kTwoPi, mask))
        return false;
      if (adopt(mask))
        return true;
    }
    return false;
  };
  bool rough = false;
  for (int pass = 0; pass < 5 && leave_out_rough(); ++pass) {
    residual = split(time, angle, usable, dense, orders, out, falls);
    rough = true;
  }
  if (rough) { // the spline is loose at its ends: half a turn beside each gap is not judged
    std::vector<char> mask(usable.begin(), usable.end());
    widen_gaps(angle, 0.5 * kTwoPi, mask);
    adopt(mask);
  }
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (usable[i]) {
      sum += residual[i] * residual[i];
      count += 1.0;
    }
  out.residual_rms_rad = count > 0.0 ? std::sqrt(sum / count) : 0.0;
  out.slow_rad = slow_spread(angle, residual, usable, noise_between(residual, usable));
  return out;
}

} // namespace ada
