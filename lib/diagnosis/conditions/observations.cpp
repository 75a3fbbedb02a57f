// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/observations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <tuple>

#include "base/angle.h"
#include "base/pick.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Least range of VTEMP, V: 0.6 degrees Celsius of the ADA4571 at 5 V, 5 of a diode's 2 mV per
/// degree.
constexpr double kLeastTemperatureV = 0.01;
/// In a range of less than 2 degrees it is to be ten times the noise, where that of one temperature
/// is four times. In a larger one rows may come in any order of the temperatures.
constexpr double kLeastOfItsNoise = 10.0, kAnyOrderV = 0.03;

} // namespace

Conditions Observations::conditions() const {
  const auto data = [](const auto &v) { return v.empty() ? nullptr : v.data(); };
  return {.n = size(),
          .time = data(time),
          .alpha = data(alpha),
          .omega = data(omega),
          .accel = data(accel),
          .direction = data(direction),
          .travel = data(travel),
          .moved = data(moved),
          .temp = data(temp),
          .temp_rate = data(temp_rate),
          .supply = data(supply),
          .supply_rate = data(supply_rate),
          .supply_bend = data(supply_bend),
          .vtemp_scan = vtemp_scanned ? data(temp) : nullptr,
          .frame_period_s = frame_period_s,
          .speed_reach_s = speed_reach_s,
          .mid_shift_v = mid_shift_v};
}

namespace {

std::array<double, 2> unit(double s, double c) {
  const double inverse = 1.0 / std::max(std::sqrt(s * s + c * c), 1e-12); // volts: no overflow
  return {s * inverse, c * inverse};
}

} // namespace

Observations::Place Observations::place(double sin_v, double cos_v) const {
  // The form of the figure gives a^2 on an ellipse with the half axes a and b, and the root of its
  // determinant a / b.
  const auto &[ss, sc, cc] = figure;
  const double ratio = std::sqrt(std::max(ss * cc - sc * sc, 1e-12));
  const double s = sin_v - centre_sin_v, c = cos_v - centre_cos_v;
  const double out_s = ss * s + sc * c, out_c = sc * s + cc * c;
  const double a = std::sqrt(std::max(s * out_s + c * out_c, 1e-12));
  return {{s, c}, {out_c / ratio, -out_s / ratio}, a, a / ratio};
}

double Observations::to_nearest(const Place &pair) const {
  if (!noise_alone)
    return 0.0;
  const auto &[s, c] = pair.vector;
  const auto &[along_s, along_c] = pair.along;
  // Newton's step; the second derivative of the figure is minus its vector.
  const double length2 = s * s + c * c, speed2 = along_s * along_s + along_c * along_c;
  const double off = 1.0 - figure_v / pair.long_axis_v; // of the pair
  return off * (s * along_s + c * along_c) /
         std::max(speed2 + off * (length2 - speed2), 0.5 * speed2);
}

std::array<double, 2> Observations::nearest(double sin_v, double cos_v) const {
  if (!noise_alone)
    return {sin_v - centre_sin_v, cos_v - centre_cos_v};
  const Place pair = place(sin_v, cos_v);
  const double step = to_nearest(pair), along = std::sin(step), on = std::cos(step);
  return {pair.vector[0] * on + pair.along[0] * along, pair.vector[1] * on + pair.along[1] * along};
}

std::array<double, 2> Observations::outward(double sin_v, double cos_v) const {
  const double s = sin_v - centre_sin_v, c = cos_v - centre_cos_v;
  return unit(figure[0] * s + figure[1] * c, figure[1] * s + figure[2] * c);
}

std::array<double, 2> Observations::direction_at(std::size_t i, double model_sin,
                                                 double model_cos) const {
  if (disturbed == Direction::motion) {
    const auto [near_s, near_c] = nearest(vsin[i], vcos[i]);
    double at_s = centre_sin_v + near_s, at_c = centre_cos_v + near_c;
    if (!travel
             .empty()) { // from where a reference says to where it is leads the chord of the curve
      at_s = 0.5 * (at_s + model_sin);
      at_c = 0.5 * (at_c + model_cos);
    }
    const auto [s, c] = outward(at_s, at_c);
    return {c, -s};
  }
  return disturbed == Direction::radius ? unit(model_sin - centre_sin_v, model_cos - centre_cos_v)
                                        : unit(model_sin, model_cos);
}

Observations::Whitener Observations::whitener_at(std::size_t i, double model_sin,
                                                 double model_cos) const {
  if (weight_along == 1.0)
    return {0.0, 0.0, 1.0};
  const auto [us, uc] = direction_at(i, model_sin, model_cos);
  return {us, uc, weight_along};
}

namespace {

/// Hands each column to `act`, and which member it is.
template <class Data, class Act> void for_each_column(Data &data, Act act) {
  act(data.time, &Observations::time);
  act(data.vsin, &Observations::vsin);
  act(data.vcos, &Observations::vcos);
  act(data.alpha, &Observations::alpha);
  act(data.omega, &Observations::omega);
  act(data.accel, &Observations::accel);
  act(data.direction, &Observations::direction);
  act(data.travel, &Observations::travel);
  act(data.moved, &Observations::moved);
  act(data.temp, &Observations::temp);
  act(data.temp_rate, &Observations::temp_rate);
  act(data.supply, &Observations::supply);
  act(data.supply_rate, &Observations::supply_rate);
  act(data.supply_bend, &Observations::supply_bend);
}

} // namespace

Observations Observations::select(const std::vector<std::uint32_t> &indices) const {
  Observations out;
  out.frame_period_s = frame_period_s;
  out.speed_reach_s = speed_reach_s;
  out.vtemp_scanned = vtemp_scanned;
  out.vtemp_on_vcos = vtemp_on_vcos;
  out.vtemp_on_vcos_error = vtemp_on_vcos_error;
  out.disturbed = disturbed;
  out.weight_along = weight_along;
  out.own_offsets = own_offsets;
  out.mid_shift_v = mid_shift_v;
  out.centre_sin_v = centre_sin_v;
  out.centre_cos_v = centre_cos_v;
  out.figure = figure;
  out.figure_v = figure_v;
  out.noise_alone = noise_alone;
  for_each_column(out, [&](auto &column, auto which) { column = pick(this->*which, indices); });
  return out;
}

void Observations::keep(const std::vector<std::uint32_t> &indices) {
  if (indices.size() == size())
    return;
  for_each_column(*this, [&](auto &column, auto) { column = pick(column, indices); });
}

double reference_step_rad(const std::vector<ScreenFinding> &screened) {
  double step = 0.0;
  for (const ScreenFinding &f : screened)
    step = std::max(step, f.effect->reference_step_rad(f.values));
  return step;
}

void describe_temperature(const Capture &capture, Scene &scene) {
  if (!capture.has_vtemp()) {
    scene.why_no_temperature = "no VTEMP channel";
    return;
  }
  const std::vector<float> &temp = scene.all.temp;
  scene.vtemp_mean_v = std::accumulate(capture.vtemp_v.begin(), capture.vtemp_v.end(), 0.0) /
                       static_cast<double>(capture.size());
  const double range_v = quantile(temp, 0.98) - quantile(temp, 0.02);
  const auto noise_v = [&] { return noise_between(std::vector<double>(temp.begin(), temp.end())); };
  if (range_v < kLeastTemperatureV ||
      (range_v < kAnyOrderV && range_v < kLeastOfItsNoise * noise_v()))
    scene.why_no_temperature = "one temperature only";
  scene.all.vtemp_scanned = true;
}

namespace {

/// Steps of the record by which the shaft is taken to have gone on as fast as at their end.
constexpr double kMostSteps = 10.0;

/// The longest stretch of a record without a pause, s: one of a twentieth of all the time that was
/// recorded, at the least.
double longest_stretch_s(const Observations &all) {
  constexpr double kPause = 0.05;
  const auto step = [&](std::size_t i) { return std::abs(all.time[i] - all.time[i - 1]); };
  double recorded = 0.0, here = 0.0, longest = 0.0;
  for (std::size_t i = 1; i < all.size(); ++i)
    recorded += std::min(step(i), kMostSteps * all.frame_period_s);
  for (std::size_t i = 1; i < all.size(); ++i) {
    here = step(i) > kPause * recorded ? 0.0 : here + step(i);
    longest = std::max(longest, here);
  }
  return longest;
}

/// Mean speed over one electrical period from each sample on, rad/s, along the stretches between
/// two reversals; none where no stretch holds a period.
std::vector<double> speed_of_periods(const Observations &all, int periods) {
  const double period = kTwoPi / periods;
  std::vector<double> out;
  for (std::size_t from = 0, to = 0; from < all.size(); from = to) {
    const double sense = all.omega[from] < 0.0 ? -1.0 : 1.0;
    for (to = from + 1; to < all.size() && sense * all.omega[to] >= 0.0;)
      ++to;
    for (std::size_t i = from, j = from; i < to; ++i) {
      while (j < to && sense * (all.alpha[j] - all.alpha[i]) < period)
        ++j;
      if (j == to)
        break;
      if (const double took = all.time[j] - all.time[i]; took > 0.0)
        out.push_back(sense * (all.alpha[j] - all.alpha[i]) / took);
    }
  }
  return out;
}

} // namespace

double fastest_over_periods(const Scene &scene) {
  constexpr double kAll = 0.98; // but what a wild reading makes
  const double period = kTwoPi / scene.periods;
  const auto &[time, alpha] = std::tie(scene.all.time, scene.all.alpha);
  std::vector<double> whole;
  for (std::size_t i = 0, j = 0; i < alpha.size(); ++i) {
    while (j < alpha.size() && std::abs(alpha[j] - alpha[i]) < period)
      ++j;
    if (j == alpha.size())
      break;
    if (const double took = time[j] - time[i]; took > 0.0)
      whole.push_back(period / took);
  }
  return whole.empty() ? scene.fastest_omega : quantile(std::move(whole), kAll);
}

void describe_motion(Scene &scene) {
  const Observations &all = scene.all;
  scene.stretch_s = longest_stretch_s(all);
  struct Way {
    double time = 0.0, travel = 0.0;
  } forward, backward;
  std::vector<double> speed;
  const bool at_rest = std::ranges::all_of(all.omega, [](auto w) { return w == 0.0f; });
  for (std::size_t i = 0; i < all.size(); ++i) {
    speed.push_back(std::abs(all.omega[i]));
    // What went on in a pause of the record nobody saw.
    double dt =
        i > 0 ? std::min(std::abs(all.time[i] - all.time[i - 1]), kMostSteps * all.frame_period_s)
              : 0.0;
    double step = dt * all.omega[i];
    if (at_rest && i > 0) { // it turns from one place to the next, and each way counts alike
      dt = 1.0;
      step = std::copysign(std::abs(all.alpha[i] - all.alpha[i - 1]), all.direction[i]);
    }
    if (step == 0.0)
      continue;
    Way &way = step > 0.0 ? forward : backward;
    way.time += dt;
    way.travel += std::abs(step);
  }
  scene.turns = (forward.travel + backward.travel) / kTwoPi;
  if (all.size() > 0) {
    const auto [low, high] = std::minmax_element(all.alpha.begin(), all.alpha.end());
    scene.seen_turns = std::clamp((*high - *low) / kTwoPi, 1e-6, 1.0);
  }
  // What a way back tells from the angle it is seen at must be seen at many: an eighth of a turn,
  // or twice at each there is. The shaft's own smooth motion needs a turn to tell one from the
  // other.
  const double least =
      scene.has_reference ? kTwoPi * std::min(0.125, 2.0 * scene.seen_turns) : kTwoPi;
  scene.both_directions =
      std::min(forward.time, backward.time) > 0.05 * (forward.time + backward.time) &&
      std::min(forward.travel, backward.travel) > least;
  scene.fastest_omega = quantile(speed, 0.98);
  // Whatever bends the pair's radius within a period bends its angle as well, and so its speed: of
  // an angle that is the pair's own only the speeds of whole periods are the shaft's.
  if (scene.radius_only)
    if (std::vector<double> whole = speed_of_periods(all, scene.periods); !whole.empty())
      speed = std::move(whole);
  // Where no angle is passed twice the speed is a function of the angle, and of a reference that
  // errs by some degrees one that its error makes: those make no speed half of another.
  constexpr double kSlower = 0.8, kFarSlower = 0.5;
  const bool again = scene.rounds(1.0) >= criteria::kFewestTurnsToRepeat;
  scene.several_speeds =
      quantile(speed, 0.05) <
      (scene.has_reference && !again ? kFarSlower : kSlower) * quantile(speed, 0.98);
}

void judge_radius_only(Scene &scene) {
  scene.radius_only = true;
  scene.all.disturbed = Direction::motion;
  scene.all.weight_along = kWeightOfOwnAngle;
  describe_motion(scene);
}

std::vector<std::uint32_t> thin(const std::vector<std::uint32_t> &indices, std::size_t most,
                                std::size_t run) {
  if (indices.size() <= most)
    return indices;
  const std::size_t runs = std::max<std::size_t>(1, most / run);
  const std::size_t length = most / runs;
  const std::size_t share = indices.size() / runs;
  std::vector<std::uint32_t> out;
  // Uneven places: evenly spaced runs would see a tone at several frequencies alike.
  std::minstd_rand place(1);
  for (std::size_t r = 0; r < runs; ++r) {
    const std::size_t from = r * share + place() % (share - length + 1);
    for (std::size_t k = from; k < std::min(from + length, indices.size()); ++k)
      out.push_back(indices[k]);
  }
  return out;
}

} // namespace ada
