// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/events/screening.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "base/angle.h"
#include "base/error.h"
#include "base/fourier.h"
#include "base/pick.h"
#include "base/robust.h"
#include "base/solve.h"
#include "calibration/ellipse_fit.h"
#include "diagnosis/conditions/observations.h"
#include "diagnosis/conditions/over_supply.h"
#include "diagnosis/conditions/travel.h"
#include "diagnosis/conditions/wild_rows.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/white_noise.h"
#include "motion/followed_gaps.h"

namespace ada {

namespace {

/// The pair as angle and radius, each channel scaled to its range.
struct Polar {
  std::vector<double> angle;
  double radius_spread; ///< relative, but for spikes
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
  out.radius_spread = spread_but_for_rare(radius);
  return out;
}

/// From the electrical angle within a period to the unwrapped mechanical one. Where a channel reads
/// what it never can, the pair says nothing of the angle, and could lead the unwrapping into
/// another period: that of the sample before stays.
void unwrap_believed(Screened &look) {
  const Capture &c = look.capture;
  const Reach sin = fence(c.vsin_v), cos = fence(c.vcos_v);
  for (std::size_t i = 1; i < c.size(); ++i)
    if (!sin.holds(c.vsin_v[i]) || !cos.holds(c.vcos_v[i]))
      look.angle[i] = look.angle[i - 1];
  unwrap(look.angle, kTwoPi);
  follow_through_gaps(c, kTwoPi, look.angle);
  for (double &a : look.angle)
    a /= c.meta.periods_per_turn;
}

/// Unwrapped mechanical angle from the pair, good to about a degree. Where a recorded supply moves
/// the outputs, their ratio to it is what turns with the shaft.
void rough_angle(Screened &look) {
  const Capture &c = look.capture;
  Polar best = polar(c.vsin_v, c.vcos_v, look.usable);
  if (auto ratio = over_supply(c)) {
    Polar ratiometric = polar(ratio->sin_v, ratio->cos_v, look.usable);
    if (ratiometric.radius_spread < kFollowsSupply * best.radius_spread) {
      best = std::move(ratiometric);
      look.steady_sin_v = std::move(ratio->sin_v);
      look.steady_cos_v = std::move(ratio->cos_v);
    }
  }
  look.centre_sin_v = range_of(c.vsin_v, look.usable).middle;
  look.centre_cos_v = range_of(c.vcos_v, look.usable).middle;
  look.angle = std::move(best.angle);
  unwrap_believed(look);
}

std::vector<std::uint32_t> usable_rows(const Screened &look) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < look.usable.size(); ++i)
    if (look.usable[i])
      out.push_back(i);
  return out;
}

/// The curve that the pair draws, where one is seen: an ellipse, or on a short arc a circle.
std::optional<EllipseParameters> curve_of(const Screened &look) {
  const std::vector<std::uint32_t> rows = usable_rows(look);
  const std::vector<double> vsin = pick(look.turning_sin_v(), rows),
                            vcos = pick(look.turning_cos_v(), rows);
  try {
    return fit_ellipse(vsin, vcos).value;
  } catch (const Error &) {
  }
  try {
    const EllipseFit circle = fit_ellipse(vsin, vcos, {.circle = true});
    if (circle.coverage_deg < 360.0 * criteria::kLeastCoverage)
      return circle.value;
  } catch (const Error &) {
  }
  return std::nullopt;
}

/// The same by the curve that the pair draws: in a part of a turn the middle of a range is no
/// centre. Left as it is where no curve is seen.
void angle_of_curve(Screened &look, const std::optional<EllipseParameters> &e) {
  const Capture &c = look.capture;
  if (!e || !(e->amplitude_v > 0.0) || std::abs(e->k) > 1.5)
    return;
  look.centre_sin_v = e->centre_sin_v;
  look.centre_cos_v = e->centre_cos_v;
  if (c.has_reference())
    return;
  const EllipseInverse inverse = invert(*e);
  for (std::size_t i = 0; i < c.size(); ++i)
    look.angle[i] = std::atan2(inverse.sine(look.turning_sin_v()[i], look.turning_cos_v()[i]),
                               inverse.cosine(look.turning_sin_v()[i], look.turning_cos_v()[i]));
  unwrap_believed(look);
}

/// The ellipse of some of the rows, where they lie on one.
std::optional<EllipseParameters> ellipse_of_some(const Screened &look) {
  // Of the amplitude, rms: what leaves more has no centre to a fifth of that.
  constexpr double kLeaves = 0.2;
  const std::vector<std::uint32_t> some = thin(usable_rows(look), criteria::kForCircle);
  try {
    const EllipseFit fit =
        fit_ellipse(pick(look.turning_sin_v(), some), pick(look.turning_cos_v(), some));
    if (fit.residual_rms_v < kLeaves * fit.value.amplitude_v)
      return fit.value;
  } catch (const Error &) {
  }
  return std::nullopt;
}

/// Whether no circle gives the angle of an ellipse: channels that are d off a quarter of a period
/// turn the circle's angle to and fro by d / 2, and what a smooth motion makes of that is off by
/// the square of it.
bool is_far_from_circle(const EllipseParameters &e) {
  constexpr double kFar = 0.2; // rad: d^2 / 8 is a third of an electrical degree
  return std::abs(e.delta_rad) > kFar;
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
  const Reach believed = fence(v);
  for (std::size_t i = 0; i < v.size(); i += stride)
    if (usable[i] && believed.holds(v[i])) {
      row(i);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(x);
      right += v[i] * x;
    }
  normal.diagonal().array() += 1e-9;
  const Eigen::VectorXd c = solved_lower(normal, right);
  std::vector<FourierPair> less; // of two channels, of which there is one here
  for (int k = 1; k <= kOrders; ++k)
    less.push_back({-c[2 * k - 1], -c[2 * k], 0.0, 0.0});
  std::vector<double> out(v.size());
  constexpr std::size_t kBlock = 1024;
  std::array<double, kBlock> nothing{};
  for (std::size_t i = 0; i < v.size(); i += kBlock) {
    const std::size_t count = std::min(kBlock, v.size() - i);
    for (std::size_t k = i; k < i + count; ++k)
      out[k] = v[k] - c[0];
    add_fourier_pair(angle.data() + i, count, less, out.data() + i, nothing.data());
  }
  return out;
}

/// A value between its four nearest neighbours, by the cubic through them in time.
double between(std::span<const double> time, const std::vector<double> &v, std::size_t i) {
  const std::array<std::size_t, 4> at{i - 2, i - 1, i + 1, i + 2};
  double sum = 0.0;
  for (std::size_t a : at) {
    double weight = 1.0;
    for (std::size_t b : at)
      if (a != b)
        weight *= (time[i] - time[b]) / (time[a] - time[b]);
    sum += weight * v[a];
  }
  return sum;
}

/// Residual of a channel against its four nearest neighbours: a spike stands out without any model
/// of the angle. Where the clock is uneven it stands out by its rows and by its times: one of the
/// two is what a fast shaft does between readings. Where a spike hits a neighbour the wrong sample
/// may seem to stand out; the larger one wins.
std::vector<double> against_neighbours(std::span<const double> time, const std::vector<double> &v) {
  std::vector<double> out(v.size(), 0.0);
  for (std::size_t i = 2; i + 2 < v.size(); ++i) {
    out[i] = v[i] - (4.0 * (v[i - 1] + v[i + 1]) - v[i - 2] - v[i + 2]) / 6.0;
    const double by_time = v[i] - between(time, v, i);
    if (std::abs(by_time) < std::abs(out[i])) // false where times do not increase
      out[i] = by_time;
  }
  std::vector<double> peaks = out;
  for (std::size_t i = 2; i + 2 < v.size(); ++i)
    for (std::size_t k : {i - 2, i - 1, i + 1, i + 2})
      if (std::abs(out[k]) > std::abs(out[i]))
        peaks[i] = 0.0;
  return peaks;
}

/// Turns between the two ends of the motion: a shaft that swings travels many and sees few.
double turns_seen(const std::vector<double> &angle) {
  const auto [low, high] = std::minmax_element(angle.begin(), angle.end());
  return (*high - *low) / kTwoPi;
}

/// What no single capture tells from an effect.
std::vector<std::string> rivals_of(const Effect &effect) {
  std::vector<std::string> out;
  for (const Separation &s : effect.info().separations)
    out.emplace_back(s.rival);
  return out;
}

/// Radius of the pair, V of VCOS, less what repeats with the angle.
std::vector<double> radius_left(const Screened &look, const Range &cos) {
  const Capture &c = look.capture;
  const Range sin = range_of(c.vsin_v, look.usable);
  std::vector<double> radius;
  for (std::size_t i = 0; i < c.size(); ++i)
    radius.push_back(cos.half * std::hypot((c.vsin_v[i] - sin.middle) / sin.half,
                                           (c.vcos_v[i] - cos.middle) / cos.half));
  return against_harmonics(radius, look.angle, look.usable);
}

} // namespace

std::vector<double> reference_angle(const Capture &c) {
  std::vector<double> a(c.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] = c.reference_deg[i] * kRadPerDeg;
  unwrap(a, kTwoPi);
  return a;
}

double share_of_circle(std::span<const double> angle, int periods) {
  constexpr std::size_t kSectors = 36;
  std::array<bool, kSectors> seen{};
  for (double a : angle)
    seen[std::min(kSectors - 1,
                  static_cast<std::size_t>(wrap(periods * a, kTwoPi) / kTwoPi * kSectors))] = true;
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / kSectors;
}

double Screened::turns() const {
  return travel_of(angle) / kTwoPi;
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
  look.findings.push_back({&effect, {}, {}, rivals_of(effect), {}});
  return true;
}

/// Places where the radius of the pair stands out: without a reference, and with few samples a
/// period, a channel alone moves too far from sample to sample for a spike to show.
std::vector<std::size_t> radius_spikes(const Screened &look) {
  constexpr double kStandsOut = 8.0;
  std::vector<std::size_t> places;
  find_spikes(radius_left(look, range_of(look.capture.vcos_v, look.usable)), kStandsOut,
              look.white_noise_v, places);
  return places;
}

/// Whether a shaft that turns on as it does before and after a place would be where it is beyond
/// it. In a quick move a sample may depart from its neighbours too, and those lie apart by as much.
bool is_passed_by(const Screened &look, std::size_t at, double departs_rad) {
  constexpr std::size_t kNear = 3, kFar = 7; // rows: beyond what a filter leaves of a spike
  constexpr double kHalf = 0.5;
  const std::vector<double> &angle = look.angle, &time = look.capture.time_s;
  if (at < kFar || at + kFar >= angle.size() || !(time[at - kNear] > time[at - kFar]) ||
      !(time[at + kFar] > time[at + kNear])) // an end says nothing, nor do rows of one time
    return true;
  const auto turned = [&](std::size_t from, std::size_t to) {
    return look.capture.meta.periods_per_turn * (angle[to] - angle[from]);
  };
  const auto speed = [&](std::size_t from, std::size_t to) {
    return turned(from, to) / (time[to] - time[from]);
  };
  const std::size_t from = at - kNear, to = at + kNear;
  const double due =
      0.5 * (speed(at - kFar, from) + speed(to, at + kFar)) * (time[to] - time[from]);
  // One that reaches beyond the centre may have taken the angle round.
  constexpr double kBeyondCentre = 0.9; // of the radius
  const double off = turned(from, to) - due, departs = std::abs(departs_rad);
  return std::abs(departs > kBeyondCentre ? wrap_centred(off, kTwoPi) : off) < kHalf * departs;
}

bool screen_spikes(Screened &look, const Effect &effect) {
  const Capture &c = look.capture;
  const std::vector<double> angle = c.has_reference() ? reference_angle(c) : std::vector<double>();
  std::vector<char> hit(c.size(), 0);
  double sum = 0.0, values = 0.0, samples = 0.0;
  for (const auto *v : {&c.vsin_v, &c.vcos_v}) {
    const auto beside = against_neighbours(c.time_s, *v);
    const auto residual = c.has_reference() ? against_harmonics(*v, angle, look.usable) : beside;
    std::vector<std::size_t> places, standing;
    find_spikes(residual, 8.0, look.white_noise_v, places);
    find_spikes(beside, 6.0, 1.4 * look.white_noise_v, standing);
    std::erase_if(places, [&](std::size_t i) {
      return !std::binary_search(standing.begin(), standing.end(), i);
    });
    const double half = range_of(*v, look.usable).half;
    for (std::size_t i : places) {
      if (!look.usable[i] || (!c.has_reference() && !is_passed_by(look, i, residual[i] / half)))
        continue;
      hit[i] = 1;
      sum += residual[i] * residual[i];
      values += 1.0;
    }
  }
  if (!c.has_reference())
    for (std::size_t i : radius_spikes(look))
      hit[i] = look.usable[i];
  else if (values == 0.0)
    for (std::size_t i : wild_rows(c, look.usable, angle))
      hit[i] = 1;
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
                           {samples / n, std::sqrt(sum / std::max(values, 1.0))},
                           {std::sqrt(samples) / n, std::sqrt(sum / 2.0) / std::max(values, 1.0)},
                           {},
                           {}});
  return true;
}

double radius_left_rad(const Screened &look) {
  const Range cos = range_of(look.capture.vcos_v, look.usable);
  return robust_spread(radius_left(look, cos)) / cos.half;
}

Screened first_look(const Capture &capture, std::vector<char> usable) {
  Screened look{.capture = capture, .usable = std::move(usable)};
  // A dead channel would spoil every other look, spikes those for jumps: they go first.
  the_effect_that_spoils(Spoils::channel).screen(look);
  the_effect_that_spoils(Spoils::peaks).screen(look);
  rough_angle(look);
  look.white_noise_v = white_noise(look);
  const bool part = look.turns() < criteria::kFewestUnits ||
                    share_of_circle(look.angle, capture.meta.periods_per_turn) < 1.0;
  std::optional<EllipseParameters> ellipse;
  if (!part && !capture.has_reference() && (ellipse = ellipse_of_some(look))) {
    look.centre_sin_v = ellipse->centre_sin_v;
    look.centre_cos_v = ellipse->centre_cos_v;
  }
  if (part)
    angle_of_curve(look, curve_of(look));
  else if (ellipse && is_far_from_circle(*ellipse))
    angle_of_curve(look, ellipse);
  // Within a turn the angle itself is a function of the angle: a ripple that repeats with it could
  // take in the whole motion.
  look.smooth =
      capture.has_reference() || (look.turns() >= criteria::kFewestUnits &&
                                  turns_seen(look.angle) >= criteria::kFewestTurnsToRepeat);
  the_effect_that_spoils(Spoils::readings).screen(look);
  return look;
}

void look_at_record(Screened &look) {
  for (const Effect *effect : look.smooth ? catalogue() : std::span<const Effect *const>())
    if (const Spoils of = effect->info().spoils;
        of != Spoils::channel && of != Spoils::peaks && of != Spoils::readings)
      effect->screen(look);
  look.white_noise_v = white_noise(look);
}

std::vector<double> time_with_losses(const Screened &look) {
  const double frame_period_s = median_step(look.capture.time_s);
  std::vector<double> time = look.capture.time_s;
  for (std::size_t k = 0; k < look.jumps.size(); ++k)
    for (std::size_t i = look.jumps[k]; i < time.size(); ++i)
      time[i] += static_cast<double>(look.jump_lost[k]) * frame_period_s;
  return time;
}

SmoothMotion smooth_motion_with_losses(Screened &look, int orders) {
  std::vector<double> angle = look.angle;
  const auto add_slips = [&](std::vector<double> &to, double times) {
    for (std::size_t k = 0; k < look.jumps.size(); ++k)
      for (std::size_t i = look.jumps[k]; look.jump_lost[k] == 0 && i < to.size(); ++i)
        to[i] += times * look.jump_rad[k];
  };
  add_slips(angle, -1.0);
  SmoothMotion smooth = smooth_motion(time_with_losses(look), angle, look.usable, orders);
  look.spikes.insert(look.spikes.end(), smooth.spikes.begin(), smooth.spikes.end());
  std::sort(look.spikes.begin(), look.spikes.end());
  add_slips(smooth.motion.alpha, 1.0);
  return smooth;
}

} // namespace ada
