// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The magnet turns on the shaft at one moment: its angle jumps by `step_deg` and stays there.

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"time_s", "s", 1.0, -kInf, kInf, Role::chosen},
    ParameterInfo{"step_deg", "deg", 1.0, -180.0, 180.0, Role::fitted, 0.01}};

constexpr std::array<Separation, 1> kSeparations{
    {{"sample-loss", "record a hardware sample counter, or the reference beside the sensor"}}};

constexpr EffectInfo kInfo{.id = "angle-slip",
                           .cause = "The magnet turned on the shaft at one moment, so the angle is "
                                    "off by a constant from then on.",
                           .stage = Stage::motion,
                           .parameters = kParameters,
                           .correctable = false,
                           .separations = kSeparations,
                           // At the only reversal of a capture the two look alike.
                           .yields_to = "hysteresis",
                           .axis = "time",
                           .pattern = Pattern::turn,
                           .character = Character::event,
                           .repeats = true};

/// Rad: how far rows at one place may lie apart where the shaft rests at places and goes from one
/// to the next between two rows; 0 where it goes on. Of rows at rest the farthest is that by the
/// noise of the reference.
double of_rest(std::span<const double> alpha) {
  constexpr double kNoise = 6.0, kWay = 20.0; // standard deviations
  const double noise = noise_between(alpha);
  std::vector<double> steps;
  for (std::size_t i = 1; i < alpha.size(); ++i)
    steps.push_back(std::abs(alpha[i] - alpha[i - 1]));
  const bool goes = std::ranges::max(steps) > kWay * noise;
  return goes && quantile(std::move(steps), 0.5) < kNoise * noise ? kNoise * noise : 0.0;
}

/// Whether the shaft turned one way up to a step of the angle and the other way from it on: the
/// step lies where it turned back, or as far behind as a loop or a play of its size is taken up
/// over.
bool is_at_only_reversal(double time_s, double step_rad, std::span<const double> time,
                         std::span<const double> alpha) {
  constexpr double kOneWay = 0.95;              // of the way from one end to the other
  constexpr double kAhead = 0.1, kBehind = 1.5; // steps
  const auto at =
      static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), time_s) - time.begin());
  if (at < 2 || at + 2 > alpha.size())
    return false;
  const auto way = [](std::span<const double> part) {
    const auto [low, high] = std::minmax_element(part.begin(), part.end());
    const double net = part.back() - part.front();
    return std::abs(net) > kOneWay * (*high - *low) ? net : 0.0;
  };
  const double there = way(alpha.first(at)), back = way(alpha.subspan(at));
  const double step = std::abs(step_rad);
  if (there * back >= 0.0 || std::min(std::abs(there), std::abs(back)) < 2.0 * kBehind * step)
    return false;
  const auto [low, high] = std::minmax_element(alpha.begin(), alpha.end());
  const auto turn = there > 0.0 ? high : low;
  const bool ahead = static_cast<std::size_t>(turn - alpha.begin()) >= at;
  return std::abs(alpha[ahead ? at : at - 1] - *turn) <
         (ahead ? kAhead : kBehind) * step + of_rest(alpha);
}

class AngleSlip final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    for (std::size_t i = 0; i < w.n; ++i)
      if (w.at.time[i] >= v[0])
        w.alpha[i] += v[1] * kRadPerDeg;
  }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    std::vector<std::vector<double>> out;
    for (const StepGuess &step : find_steps(r, StepIn::angle))
      out.push_back({step.time_s, step.first * kDegPerRad});
    return out;
  }
  /// At the only reversal of a record a slip looks like the loop of a hysteresis, and like a play
  /// between shaft and reference, which is wide the other way and which nothing here knows.
  bool refuted_by_motion(Values v, std::span<const double> time,
                         std::span<const double> alpha) const override {
    return is_at_only_reversal(v[0], v[1] * kRadPerDeg, time, alpha);
  }
  std::string invisible(const Residual &r) const override {
    return r.has_reference ? "" : "without a reference it is looked for on the first look";
  }
  bool screen(Screened &look) const override { return screen_slip(look, *this); }
};

} // namespace

const Effect &angle_slip() {
  static const AngleSlip effect;
  return effect;
}

} // namespace ada
