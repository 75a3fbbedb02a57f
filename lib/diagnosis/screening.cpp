// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/screening.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>

#include "base/angle.h"
#include "base/robust.h"

namespace ada {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Middle and half range of a channel, by quantiles so that spikes do not count.
struct Range {
  double middle, half;
};

Range range_of(const std::vector<double> &v, const std::vector<char> &usable) {
  std::vector<double> good;
  for (std::size_t i = 0; i < v.size(); ++i)
    if (usable[i])
      good.push_back(v[i]);
  if (good.empty())
    return {0.0, 1.0};
  const double low = quantile(good, 0.005), high = quantile(good, 0.995);
  return {0.5 * (low + high), std::max(0.5 * (high - low), 1e-9)};
}

/// The pair as angle and radius, each channel scaled to its range.
struct Polar {
  std::vector<double> angle;
  double radius_spread; ///< relative, robust
};

Polar polar(const std::vector<double> &vsin, const std::vector<double> &vcos,
            const std::vector<char> &usable) {
  const Range sin = range_of(vsin, usable), cos = range_of(vcos, usable);
  Polar out;
  std::vector<double> radius;
  for (std::size_t i = 0; i < vsin.size(); ++i) {
    const double s = (vsin[i] - sin.middle) / sin.half, c = (vcos[i] - cos.middle) / cos.half;
    out.angle.push_back(std::atan2(s, c));
    if (usable[i])
      radius.push_back(std::hypot(s, c));
  }
  out.radius_spread = radius.empty() ? 0.0 : robust_spread(radius);
  return out;
}

/// Unwrapped mechanical angle from the pair, good to about a degree. Where a recorded supply moves
/// the outputs, their ratio to it is what turns with the shaft.
void rough_angle(Screened &look) {
  const Capture &c = look.capture;
  Polar best = polar(c.vsin_v, c.vcos_v, look.usable);
  if (c.has_vdd()) {
    double mean = 0.0;
    for (double v : c.vdd_v)
      mean += v / static_cast<double>(c.size());
    std::vector<double> vsin(c.size()), vcos(c.size());
    for (std::size_t i = 0; i < c.size(); ++i) {
      const double ratio = c.vdd_v[i] > 0.5 * mean ? mean / c.vdd_v[i] : 1.0;
      vsin[i] = c.vsin_v[i] * ratio;
      vcos[i] = c.vcos_v[i] * ratio;
    }
    Polar ratiometric = polar(vsin, vcos, look.usable);
    if (ratiometric.radius_spread < 0.9 * best.radius_spread)
      best = std::move(ratiometric);
  }
  look.angle = std::move(best.angle);
  unwrap(look.angle, kTwoPi);
  for (double &a : look.angle)
    a /= c.meta.periods_per_turn;
}

/// Sample-to-sample noise from differences, in which slow signals vanish: the higher their order
/// the better, while white noise is the same in all. The least of three orders.
double white_noise(const Screened &look) {
  double least = kInfinite;
  for (const std::vector<double> &weights :
       {std::vector<double>{1, -3, 3, -1}, std::vector<double>{1, -5, 10, -10, 5, -1},
        std::vector<double>{1, -7, 21, -35, 35, -21, 7, -1}}) {
    const std::size_t reach = weights.size() - 1;
    double norm2 = 0.0;
    for (double w : weights)
      norm2 += w * w;
    std::vector<double> d;
    for (const auto *v : {&look.capture.vsin_v, &look.capture.vcos_v})
      for (std::size_t i = reach; i < v->size(); ++i) {
        if (!look.usable[i] || !look.usable[i - reach])
          continue;
        double sum = 0.0;
        for (std::size_t k = 0; k <= reach; ++k)
          sum += weights[k] * (*v)[i - k];
        d.push_back(std::abs(sum));
      }
    if (!d.empty())
      least = std::min(least, 1.4826 * quantile(std::move(d), 0.5) / std::sqrt(norm2));
  }
  return least < kInfinite ? least : 0.0;
}

std::vector<double> reference_angle(const Capture &c) {
  std::vector<double> a(c.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] = c.reference_deg[i] * kRadPerDeg;
  unwrap(a, kTwoPi);
  return a;
}

/// A jump of the angle over time: straight lines over `side` samples before and after meet there
/// with a gap.
struct Jump {
  std::size_t at;   ///< first sample after
  double gap;       ///< rad, mechanical
  double per_frame; ///< rad that the shaft turns from sample to sample
  double error;
};

/// Samples of half a turn at this rotation from sample to sample.
std::size_t reach_of(double per_frame, std::size_t side) {
  const double half_turn = per_frame != 0.0 ? 0.5 * kTwoPi / std::abs(per_frame) : 1e9;
  return static_cast<std::size_t>(std::clamp(half_turn, 3.0 * static_cast<double>(side), 1e5));
}

/// Whether the speed is about the same a little before and after a place: where it is not, a curved
/// motion looks like a gap between two straight lines.
bool steady(const std::vector<double> &speeds, std::size_t at, std::size_t reach) {
  const double here = speeds[at];
  const double before = speeds[at > reach ? at - reach : 0];
  const double after = speeds[std::min(at + reach, speeds.size() - 1)];
  return std::abs(before - here) < 0.15 * std::abs(here) &&
         std::abs(after - here) < 0.15 * std::abs(here);
}

std::vector<Jump> find_jumps(const Screened &look, const std::vector<double> &angle,
                             std::size_t side, double floor_rad) {
  const std::vector<double> &t = look.capture.time_s;
  const std::size_t n = angle.size();
  std::vector<Jump> all;
  if (n < 4 * side)
    return all;
  const double frame = median_step(t);
  std::vector<double> gaps(n, 0.0), speeds(n, 0.0), bends(n, 0.0), size;
  for (std::size_t i = side; i + side <= n; ++i) {
    const double middle = 0.5 * (t[i] + t[i - 1]);
    double value[2], slope[2], fewest = static_cast<double>(side);
    for (int s = 0; s < 2; ++s) {
      const std::size_t from = s == 0 ? i - side : i;
      double su = 0, sv = 0, suu = 0, suv = 0;
      double m = 0.0;
      for (std::size_t k = from; k < from + side; ++k) {
        if (!look.usable[k])
          continue;
        m += 1.0;
        const double u = t[k] - middle, v = angle[k] - angle[i];
        su += u;
        sv += v;
        suu += u * u;
        suv += u * v;
      }
      fewest = std::min(fewest, m);
      m = std::max(m, 1.0);
      const double d = m * suu - su * su;
      slope[s] = d > 0.0 ? (m * suv - su * sv) / d : 0.0;
      value[s] = (sv - slope[s] * su) / m;
    }
    speeds[i] = 0.5 * (slope[0] + slope[1]);
    // The edge of a jump may pass for a spike; a stretch without samples says nothing.
    if (fewest < 0.75 * static_cast<double>(side))
      continue;
    // A kink, such as a sudden reversal, is a change of speed and no jump.
    if (std::abs(slope[1] - slope[0]) > 0.3 * std::abs(slope[0] + slope[1]) * 0.5)
      continue;
    gaps[i] = value[1] - value[0];
    bends[i] = std::abs(slope[1] - slope[0]) * static_cast<double>(side) * frame;
    size.push_back(std::abs(gaps[i]));
  }
  if (size.empty())
    return all;
  const double sigma = std::max(1.4826 * quantile(std::move(size), 0.5), floor_rad);
  for (std::size_t i = side; i + side <= n; ++i) {
    // A gap far larger than a kink between the two lines could leave is a jump at any speed.
    const bool clear = std::abs(gaps[i]) > 2.0 * bends[i] + 50.0 * sigma ||
                       steady(speeds, i, reach_of(speeds[i] * frame, side));
    if (std::abs(gaps[i]) < 8.0 * sigma || !clear)
      continue;
    const auto from = gaps.begin() + static_cast<std::ptrdiff_t>(i - side);
    const auto to = gaps.begin() + static_cast<std::ptrdiff_t>(std::min(n, i + side + 1));
    const auto largest =
        std::max_element(from, to, [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (largest - gaps.begin() == static_cast<std::ptrdiff_t>(i))
      all.push_back({i, gaps[i], speeds[i] * frame, sigma});
  }
  return all;
}

/// Samples lost at a jump, or 0 when it is no whole number of them in the sense of the rotation.
/// The angle is known up to whole periods only: a loss that turns the shaft by most of one looks
/// like a jump back. Without a reference a small one may be a slip and stays what it seems.
double samples_lost(const Screened &look, const Jump &jump) {
  constexpr double kWidestSlip = 5.0 * kRadPerDeg;
  constexpr double kMostWraps = 3.0;
  const Capture &c = look.capture;
  if (jump.per_frame == 0.0)
    return 0.0;
  const double period = kTwoPi / (c.has_reference() ? 1.0 : c.meta.periods_per_turn);
  const double error = std::abs(jump.error / jump.per_frame);
  const double seen = jump.gap / jump.per_frame;
  if (std::abs(seen) < 2.5 ||
      (seen < 0.0 && !c.has_reference() && std::abs(jump.gap) < kWidestSlip))
    return 0.0;
  // Further periods only where a reference leaves nothing else that could jump.
  const double most = c.has_reference() ? kMostWraps : (seen < 0.0 ? 1.0 : 0.0);
  for (double wraps = seen < 0.0 ? 1.0 : 0.0; wraps <= most; wraps += 1.0) {
    const double lost = seen + wraps * period / std::abs(jump.per_frame);
    if (lost < 2.5 || lost < 6.0 * error)
      continue;
    // Within its error a whole number; where the error is above a quarter this proves nothing.
    if (std::abs(lost - std::round(lost)) < std::max(4.0 * error, 0.15))
      return lost;
  }
  return 0.0;
}

/// Mean of angle - speed * time over the whole turn that ends (`back`) or begins at sample `from`;
/// `end` becomes its other end. What repeats with the turn drops out of it.
std::optional<double> turn_mean(const Screened &look, const std::vector<double> &angle,
                                std::size_t from, bool back, double speed, std::size_t &end) {
  const std::vector<double> &t = look.capture.time_s;
  double sum = 0.0, count = 0.0;
  for (std::size_t k = from; back ? k-- > 0 : k < angle.size(); k += !back) {
    if (std::abs(angle[k] - angle[back ? from - 1 : from]) >= kTwoPi) {
      end = back ? k + 1 : k;
      return count > 0.0 ? std::optional(sum / count) : std::nullopt;
    }
    if (look.usable[k]) {
      sum += angle[k] - angle[from] - speed * (t[k] - t[from]);
      count += 1.0;
    }
  }
  return std::nullopt;
}

/// Whether the means of two whole turns before and two after, in which everything that repeats with
/// the turn cancels, know nothing of a jump. False where there are not as many turns.
bool turns_deny(const Screened &look, const std::vector<double> &angle, const Jump &jump) {
  const double speed = jump.per_frame / median_step(look.capture.time_s);
  std::size_t before = 0, after = 0, end = 0;
  const auto m1 = turn_mean(look, angle, jump.at, true, speed, before);
  const auto p1 = turn_mean(look, angle, jump.at, false, speed, after);
  if (!m1 || !p1)
    return false;
  auto m2 = turn_mean(look, angle, before, true, speed, end);
  auto p2 = turn_mean(look, angle, after, false, speed, end);
  if (!m2 || !p2)
    return false;
  const std::vector<double> &t = look.capture.time_s;
  *m2 += angle[before] - angle[jump.at] - speed * (t[before] - t[jump.at]);
  *p2 += angle[after] - angle[jump.at] - speed * (t[after] - t[jump.at]);
  const double first = *m1 - *m2, second = *p2 - *p1; // the error of a straight line shows in both
  const double gap = *p1 - *m1 - 0.5 * (first + second);
  return std::abs(gap - jump.gap) > 0.4 * std::abs(jump.gap) + std::abs(second - first);
}

std::vector<Jump> jumps_of(const Screened &look) {
  if (!look.capture.has_reference())
    return find_jumps(look, look.angle, 12, 1e-5);
  return find_jumps(look, reference_angle(look.capture), 6, 4e-6);
}

/// Leaves out what lies about a jump, its edges that passed for spikes included.
void mark(Screened &look, std::size_t centre, std::size_t half) {
  const std::size_t from = centre > half ? centre - half : 0;
  std::erase_if(look.spikes, [&](std::uint32_t i) { return i >= from && i < centre + half; });
  for (std::size_t i = from; i < std::min(look.usable.size(), centre + half); ++i)
    look.usable[i] = 0;
}

/// Residual of a channel against harmonics of the angle: what a first look can take for granted.
std::vector<double> against_harmonics(const std::vector<double> &v,
                                      const std::vector<double> &angle,
                                      const std::vector<char> &usable) {
  constexpr int kOrders = 16; // of the mechanical turn
  const int columns = 1 + 2 * kOrders;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(columns), x(columns);
  const auto row = [&](std::size_t i) {
    x[0] = 1.0;
    for (int k = 1; k <= kOrders; ++k) {
      x[2 * k - 1] = std::cos(k * angle[i]);
      x[2 * k] = std::sin(k * angle[i]);
    }
  };
  const std::size_t stride = std::max<std::size_t>(1, v.size() / 20000);
  for (std::size_t i = 0; i < v.size(); i += stride)
    if (usable[i]) {
      row(i);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(x);
      right += v[i] * x;
    }
  normal.diagonal().array() += 1e-9;
  const Eigen::VectorXd c = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  std::vector<double> out(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    row(i);
    out[i] = v[i] - c.dot(x);
  }
  return out;
}

/// Residual of a channel against its four nearest neighbours: a spike stands out without any model
/// of the angle. Where a spike hits a neighbour the wrong sample may seem to stand out; the larger
/// one wins.
std::vector<double> against_neighbours(const std::vector<double> &v) {
  std::vector<double> out(v.size(), 0.0);
  for (std::size_t i = 2; i + 2 < v.size(); ++i)
    out[i] = v[i] - (4.0 * (v[i - 1] + v[i + 1]) - v[i - 2] - v[i + 2]) / 6.0;
  std::vector<double> peaks = out;
  for (std::size_t i = 2; i + 2 < v.size(); ++i)
    for (std::size_t k : {i - 2, i - 1, i + 1, i + 2})
      if (std::abs(out[k]) > std::abs(out[i]))
        peaks[i] = 0.0;
  return peaks;
}

} // namespace

bool screen_stuck(Screened &look, const Effect &effect) {
  const Capture &c = look.capture;
  const std::size_t n = c.size();
  const std::size_t tail = std::max<std::size_t>(50, n / 50);
  const std::vector<double> *channels[2] = {&c.vsin_v, &c.vcos_v};
  double spread[2];
  for (int k = 0; k < 2; ++k)
    spread[k] = robust_spread({channels[k]->data() + (n - tail), tail});
  for (int k = 0; k < 2; ++k) {
    const double whole = range_of(*channels[1 - k], look.usable).half;
    if (spread[k] > 0.01 * whole || spread[1 - k] < 0.1 * whole)
      continue;
    const double held =
        quantile({channels[k]->end() - static_cast<std::ptrdiff_t>(tail), channels[k]->end()}, 0.5);
    const double band = std::max(8.0 * spread[k], 1e-4 * whole);
    std::size_t first = n;
    while (first > 0 && std::abs((*channels[k])[first - 1] - held) <= band)
      --first;
    if (n - first < tail)
      continue;
    std::fill(look.usable.begin() + static_cast<std::ptrdiff_t>(first), look.usable.end(), char{0});
    const double step = median_step(c.time_s);
    look.findings.push_back(
        {&effect, {static_cast<double>(k), c.time_s[std::min(first, n - 1)]}, {0.0, step}, {}, {}});
    return true;
  }
  return false;
}

bool screen_orientation(Screened &look, const Effect &effect) {
  const Capture &c = look.capture;
  if (!c.has_reference())
    return false;
  std::complex<double> along, against;
  double count = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (!look.usable[i])
      continue;
    const double psi = c.meta.periods_per_turn * look.angle[i];
    const double alpha = c.meta.periods_per_turn * c.reference_deg[i] * kRadPerDeg;
    along += std::polar(1.0, psi - alpha);
    against += std::polar(1.0, psi + alpha);
    count += 1.0;
  }
  if (count == 0.0 || std::abs(against) < 0.5 * count || std::abs(against) < std::abs(along))
    return false;
  look.findings.push_back({&effect, {}, {}, {"channel-inverted"}, {}});
  return true;
}

bool screen_losses(Screened &look, const Effect &effect) {
  double events = 0.0, samples = 0.0;
  for (const Jump &jump : jumps_of(look)) {
    const double lost = samples_lost(look, jump);
    if (lost == 0.0 || (!look.capture.has_reference() && turns_deny(look, look.angle, jump)))
      continue;
    events += 1.0;
    samples += std::round(lost);
    look.jumps.push_back(jump.at);
    look.jump_rad.push_back(jump.gap);
    look.jump_lost.push_back(static_cast<std::size_t>(std::lround(lost)));
    mark(look, jump.at, 10);
  }
  if (events == 0.0)
    return false;
  std::vector<std::string> alternatives;
  if (!look.capture.has_reference() && events == 1.0)
    alternatives.push_back("angle-slip");
  look.findings.push_back({&effect, {events, samples}, {0.0, std::sqrt(events)}, alternatives, {}});
  return true;
}

bool screen_slip(Screened &look, const Effect &effect) {
  if (look.capture.has_reference())
    return false;
  const Jump *largest = nullptr;
  const auto jumps = jumps_of(look);
  for (const Jump &jump : jumps)
    if (samples_lost(look, jump) == 0.0 &&
        (!largest || std::abs(jump.gap) > std::abs(largest->gap)))
      largest = &jump;
  // A kink of a rough motion is no jump, nor is what comes again with the angle: one slip stands
  // clear of everything else.
  if (!largest || std::abs(largest->gap) < 12.0 * largest->error)
    return false;
  for (const Jump &jump : jumps)
    if (&jump != largest && std::abs(jump.gap) > 0.5 * std::abs(largest->gap))
      return false;
  // A slip turns everything after it; a step of an offset only some angles, to either side.
  if (turns_deny(look, look.angle, *largest))
    return false;
  look.jumps.push_back(largest->at);
  look.jump_rad.push_back(largest->gap);
  look.jump_lost.push_back(0);
  mark(look, largest->at, 10);
  look.findings.push_back({&effect,
                           {look.capture.time_s[largest->at], largest->gap * kDegPerRad},
                           {median_step(look.capture.time_s), largest->error * kDegPerRad},
                           {"sample-loss"},
                           {}});
  return true;
}

bool screen_spikes(Screened &look, const Effect &effect) {
  const Capture &c = look.capture;
  const std::vector<double> angle = c.has_reference() ? reference_angle(c) : std::vector<double>();
  std::vector<char> hit(c.size(), 0);
  double sum = 0.0, values = 0.0, samples = 0.0;
  for (const auto *v : {&c.vsin_v, &c.vcos_v}) {
    const auto beside = against_neighbours(*v);
    const auto residual = c.has_reference() ? against_harmonics(*v, angle, look.usable) : beside;
    std::vector<std::size_t> places, standing;
    find_spikes(residual, 8.0, look.white_noise_v, places);
    find_spikes(beside, 6.0, 1.4 * look.white_noise_v, standing);
    std::erase_if(places, [&](std::size_t i) {
      return !std::binary_search(standing.begin(), standing.end(), i);
    });
    for (std::size_t i : places) {
      if (!look.usable[i])
        continue;
      hit[i] = 1;
      sum += residual[i] * residual[i];
      values += 1.0;
    }
  }
  for (std::size_t i = 0; i < hit.size(); ++i)
    if (hit[i]) {
      look.usable[i] = 0;
      look.spikes.push_back(static_cast<std::uint32_t>(i));
      samples += 1.0;
    }
  if (samples < 8.0) // a few may be the edges of something else
    return false;
  const double n = static_cast<double>(c.size());
  look.findings.push_back({&effect,
                           {samples / n, std::sqrt(sum / values)},
                           {std::sqrt(samples) / n, std::sqrt(sum / values / (2.0 * values))},
                           {},
                           {}});
  return true;
}

Screened screen(const Capture &capture) {
  Screened look{capture, std::vector<char>(capture.size(), 1), {}, {}, {}, {}, {}, {}, 0.0};
  for (std::size_t i = 0; i < capture.size(); ++i)
    look.usable[i] = std::isfinite(capture.vsin_v[i]) && std::isfinite(capture.vcos_v[i]);
  // A dead channel would spoil every other look, spikes those for jumps: they go first.
  const auto look_for = [&](std::string_view id) { find_effect(id)->screen(look); };
  look_for("stuck-channel");
  rough_angle(look);
  look.white_noise_v = white_noise(look);
  look_for("impulse-noise");
  for (const Effect *effect : catalogue())
    if (effect->info().id != "stuck-channel" && effect->info().id != "impulse-noise")
      effect->screen(look);
  look.white_noise_v = white_noise(look);
  return look;
}

SmoothMotion smooth_motion_with_losses(Screened &look, int orders) {
  std::vector<double> angle = look.angle;
  for (std::size_t k = 0; k < look.jumps.size(); ++k)
    for (std::size_t i = look.jumps[k]; i < angle.size(); ++i)
      angle[i] -= look.jump_rad[k];
  SmoothMotion smooth = smooth_motion(look.capture.time_s, angle, look.usable, orders);
  look.spikes.insert(look.spikes.end(), smooth.spikes.begin(), smooth.spikes.end());
  std::sort(look.spikes.begin(), look.spikes.end());
  for (std::size_t k = 0; k < look.jumps.size(); ++k)
    for (std::size_t i = look.jumps[k]; i < angle.size(); ++i)
      smooth.motion.alpha[i] += look.jump_rad[k];
  return smooth;
}

} // namespace ada
